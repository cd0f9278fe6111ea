//! The ratio of two samples with its confidence interval.
//!
//! J. L. Hodges, E. L. Lehmann: Estimates of location based on rank tests,
//! Annals of Mathematical Statistics 34 (1963): the median of the differences of
//! all pairs. Here the values are durations with multiplicative noise, so that
//! the pairs give differences of logarithms: ratios.

use serde::ser::{Serialize, SerializeStruct, Serializer};

use super::rank_sum::RankSums;

/// Minimum probability that the interval of [`Ratio`] covers the true ratio.
pub const CONFIDENCE: f64 = 0.95;

/// The factor from sample `a` to sample `b`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ratio {
    /// The Hodges-Lehmann estimate: the median of b / a over all pairs.
    pub estimate: f64,
    /// The confidence interval, of level [`CONFIDENCE`], by inversion of the Mann-Whitney test;
    /// `None` if the samples are too small: 4 values each are enough.
    pub interval: Option<[f64; 2]>,
}

impl Ratio {
    /// Estimates the ratio of two samples of positive numbers; `None` if one is empty.
    pub fn estimate(a: &[f64], b: &[f64]) -> Option<Self> {
        let pairs = a.iter().flat_map(|a| b.iter().map(move |b| b / a));
        let mut ratios: Vec<f64> = pairs.collect();
        ratios.sort_by(f64::total_cmp);
        let n = ratios.len();
        let [below, above] = [*ratios.get(n.checked_sub(1)? / 2)?, *ratios.get(n / 2)?];
        let cut = n_cut(a.len(), b.len());
        Some(Self {
            // The geometric mean of the two middle ratios.
            estimate: (below * (above / below).sqrt()).clamp(below, above),
            interval: cut.map(|cut| [ratios[cut - 1], ratios[n - cut]]),
        })
    }
}

impl Serialize for Ratio {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        let mut fields = s.serialize_struct("Ratio", 2)?;
        fields.serialize_field("estimate", &self.estimate)?;
        fields.serialize_field("interval", &self.interval)?;
        fields.end()
    }
}

/// Returns the position, from 1, of the pair at the end of the interval, counted from either end of
/// the sorted ratios: the number of values of the U statistic that are significant on one side.
/// `None` if none is.
fn n_cut(n_a: usize, n_b: usize) -> Option<usize> {
    let rank_sums = RankSums::untied(n_a, n_b);
    let least_sum = n_b * (n_b + 1) / 2;
    let is_significant = |u: &usize| {
        let doubled_sum = 2 * (least_sum + u);
        2.0 * rank_sums.at_most(doubled_sum) <= 1.0 - CONFIDENCE
    };
    (0..n_a * n_b / 2)
        .take_while(is_significant)
        .last()
        .map(|u| u + 1)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::mann_whitney_p;
    use super::*;

    proptest! {
        /// The test rejects exactly the ratios outside the interval.
        #[test]
        fn the_interval_is_that_of_the_test(
            a in prop::collection::vec(1.0..3.0, 4..9),
            b in prop::collection::vec(1.0..3.0, 4..9),
            tried in 0.2..5.0,
        ) {
            let [low, high] = Ratio::estimate(&a, &b).unwrap().interval.unwrap();
            let scaled: Vec<f64> = a.iter().map(|a| a * tried).collect();
            let is_rejected = mann_whitney_p(&scaled, &b) <= 1.0 - CONFIDENCE;
            prop_assert_eq!(is_rejected, tried < low || tried > high);
        }

        #[test]
        fn the_estimate_lies_within_the_interval(
            a in prop::collection::vec(0.1..9.0, 4..12),
            b in prop::collection::vec(0.1..9.0, 4..12),
        ) {
            let ratio = Ratio::estimate(&a, &b).unwrap();
            let [low, high] = ratio.interval.unwrap();
            prop_assert!((low..=high).contains(&ratio.estimate), "{ratio:?}");
        }

        #[test]
        fn a_factor_is_found(
            a in prop::collection::vec(1.0..3.0, 1..9),
            factor in 0.1..10.0_f64,
        ) {
            let b: Vec<f64> = a.iter().map(|a| a * factor).collect();
            let ratio = Ratio::estimate(&a, &b).unwrap();
            prop_assert!((ratio.estimate / factor - 1.0).abs() < 1e-12, "{ratio:?}");
        }
    }

    #[test]
    fn few_values_give_no_interval() {
        let has_interval = |n_a, n_b| n_cut(n_a, n_b).is_some();
        assert!(has_interval(4, 4) && has_interval(3, 5) && has_interval(2, 8));
        assert!(!has_interval(3, 4) && !has_interval(2, 7) && !has_interval(1, 38));
        assert_eq!(Ratio::estimate(&[], &[1.0]), None);
        assert_eq!(
            Ratio::estimate(&[2.0], &[3.0]),
            Some(Ratio {
                estimate: 1.5,
                interval: None
            })
        );
    }
}
