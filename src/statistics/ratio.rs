//! By which factor a sample is above another.
//!
//! J. L. Hodges, E. L. Lehmann: Estimates of location based on rank tests,
//! Annals of Mathematical Statistics 34 (1963): the median of what all pairs
//! differ by. Here the values are durations, which noise multiplies: their
//! logarithms are shifted, and the pairs give ratios.

use serde::Serialize;

use super::rank_sum::RankSums;

/// How often the interval of [`Ratio`] holds the true ratio, at least.
pub const CONFIDENCE: f64 = 0.95;

/// The factor from sample `a` to sample `b`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Ratio {
    /// The Hodges-Lehmann estimate: the median of b / a over all pairs.
    pub estimate: f64,
    /// The interval of [`CONFIDENCE`] that belongs to the Mann-Whitney test;
    /// `None` for samples too small to give one: 4 values each are enough.
    pub interval: Option<[f64; 2]>,
}

impl Ratio {
    /// The ratio of two samples of positive numbers; `None` if one is empty.
    pub fn of(a: &[f64], b: &[f64]) -> Option<Self> {
        let pairs = a.iter().flat_map(|a| b.iter().map(move |b| b / a));
        let mut ratios: Vec<f64> = pairs.collect();
        ratios.sort_by(f64::total_cmp);
        let n = ratios.len();
        let [below, above] = [*ratios.get(n.checked_sub(1)? / 2)?, *ratios.get(n / 2)?];
        let cut = n_cut(a.len(), b.len());
        Some(Self {
            // The middle of two on the logarithmic scale.
            estimate: (below * (above / below).sqrt()).clamp(below, above),
            interval: cut.map(|cut| [ratios[cut - 1], ratios[n - cut]]),
        })
    }
}

/// The place, from 1 on, of the pair that ends the interval, counted from
/// either end of the sorted pairs: as many as the U statistic may lie from its
/// end and still be significant. `None` if it never is.
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
        /// Ratios outside the interval are those that the test refuses.
        #[test]
        fn the_interval_belongs_to_the_test(
            a in prop::collection::vec(1.0..3.0, 4..9),
            b in prop::collection::vec(1.0..3.0, 4..9),
            tried in 0.2..5.0,
        ) {
            let [low, high] = Ratio::of(&a, &b).unwrap().interval.unwrap();
            let scaled: Vec<f64> = a.iter().map(|a| a * tried).collect();
            let is_refused = mann_whitney_p(&scaled, &b) <= 1.0 - CONFIDENCE;
            prop_assert_eq!(is_refused, tried < low || tried > high);
        }

        #[test]
        fn the_estimate_lies_within_the_interval(
            a in prop::collection::vec(0.1..9.0, 4..12),
            b in prop::collection::vec(0.1..9.0, 4..12),
        ) {
            let ratio = Ratio::of(&a, &b).unwrap();
            let [low, high] = ratio.interval.unwrap();
            prop_assert!((low..=high).contains(&ratio.estimate), "{ratio:?}");
        }

        #[test]
        fn a_factor_is_found(
            a in prop::collection::vec(1.0..3.0, 1..9),
            factor in 0.1..10.0_f64,
        ) {
            let b: Vec<f64> = a.iter().map(|a| a * factor).collect();
            let ratio = Ratio::of(&a, &b).unwrap();
            prop_assert!((ratio.estimate / factor - 1.0).abs() < 1e-12, "{ratio:?}");
        }
    }

    #[test]
    fn few_values_give_no_interval() {
        let has_interval = |n_a, n_b| n_cut(n_a, n_b).is_some();
        assert!(has_interval(4, 4) && has_interval(3, 5) && has_interval(2, 8));
        assert!(!has_interval(3, 4) && !has_interval(2, 7) && !has_interval(1, 38));
        assert_eq!(Ratio::of(&[], &[1.0]), None);
        assert_eq!(
            Ratio::of(&[2.0], &[3.0]),
            Some(Ratio {
                estimate: 1.5,
                interval: None
            })
        );
    }
}
