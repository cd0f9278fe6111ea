//! Sampling of discrete distributions.

use crate::simd::{DeviceTable, LookupTable, Real};

/// Samples indices with probabilities proportional to their weights, in constant time.
///
/// Walker, "An Efficient Method for Generating Discrete Random Variables with General
/// Distributions", ACM TOMS 3(3), 1977, built as by Vose, 1991.
#[derive(Debug, Clone, PartialEq)]
pub struct AliasTable {
    /// For each bin: the share of its own index, and the index that gets the rest.
    bins: Vec<[f32; 2]>,
    probabilities: Vec<[f32; 1]>,
}

/// Maximum number of bins: above it, indices are not exact as `f32`.
pub const MAX_BINS: usize = 1 << 24;

impl AliasTable {
    /// Creates a table of these weights, at most [`MAX_BINS`]; `None` unless their sum is greater
    /// than 0 and finite.
    pub fn new(weights: &[f64]) -> Option<Self> {
        let sum: f64 = weights.iter().sum();
        if !(sum > 0.0 && sum.is_finite()) || weights.len() > MAX_BINS {
            return None;
        }
        let probability = |weight: &f64| weight / sum;
        // The weight left to assign to each index, in units of a bin.
        let mut left: Vec<f64> = weights
            .iter()
            .map(|weight| probability(weight) * weights.len() as f64)
            .collect();
        let mut bins: Vec<[f32; 2]> = (0..weights.len()).map(|i| [1.0, i as f32]).collect();
        let (mut small, mut large): (Vec<usize>, Vec<usize>) =
            (0..weights.len()).partition(|&i| left[i] < 1.0);
        // Fill the rest of each small bin from a large one.
        while let (Some(&to), Some(from)) = (large.last(), small.pop()) {
            bins[from] = [left[from] as f32, to as f32];
            left[to] -= 1.0 - left[from];
            if left[to] < 1.0 {
                large.pop();
                small.push(to);
            }
        }
        Some(Self {
            bins,
            probabilities: weights
                .iter()
                .map(|weight| [probability(weight) as f32])
                .collect(),
        })
    }

    /// Samples one index, or one per lane, with a number in [0, 1), whose 24 bits a second one
    /// continues: they select a bin and decide in it, which takes more bits the more bins there are.
    #[inline(always)]
    pub fn choose<R: Real>(&self, numbers: [R; 2]) -> R {
        if let [_] = self.bins[..] {
            return numbers[0].splat(0.0);
        }
        let [index] = R::look_up(self, numbers);
        index
    }

    /// Returns the probability of one index, or one per lane.
    #[inline(always)]
    pub fn probability<R: Real>(&self, index: R) -> R {
        let [probability] = R::look_up(&self.probabilities[..], [index]);
        probability
    }
}

/// Looks up an index by two numbers in [0, 1); see [`AliasTable::choose`].
impl LookupTable<2, 1> for AliasTable {
    #[inline(always)]
    fn values_at(&self, [number, further]: [f32; 2]) -> [f32; 1] {
        let number = f64::from(number) + f64::from(further) / f64::from(1 << 24);
        let scaled = number * self.bins.len() as f64;
        let bin = scaled as usize;
        let [own_share, other] = self.bins[bin];
        let is_own = scaled - (bin as f64) < f64::from(own_share);
        [if is_own { bin as f32 } else { other }]
    }

    /// The bins as rows.
    fn on_device(&self) -> Result<DeviceTable, &'static str> {
        let rows = self.bins.on_device()?;
        Ok(DeviceTable {
            function: "alias_table",
            ..rows
        })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn shares_of_choices_are_the_weights(
            weights in prop::collection::vec(prop_oneof![Just(0.0), 0.01_f64..10.0], 1..40)
        ) {
            let sum: f64 = weights.iter().sum();
            let Some(table) = AliasTable::new(&weights) else {
                prop_assert!(sum == 0.0);
                return Ok(());
            };
            let n = 1 << 16;
            let mut counts = vec![0; weights.len()];
            for i in 0..n {
                counts[table.choose([i as f32 / n as f32, 0.5]) as usize] += 1;
            }
            for (i, (count, weight)) in counts.into_iter().zip(&weights).enumerate() {
                let expected = weight / sum;
                let found = f64::from(count) / f64::from(n);
                prop_assert!((found - expected).abs() < 2e-3, "{}: {} {}", i, found, expected);
                let probability = f64::from(table.probability(i as f32));
                prop_assert!((probability - expected).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn weights_without_a_sum_are_refused() {
        assert_eq!(AliasTable::new(&[]), None);
        assert_eq!(AliasTable::new(&[0.0, 0.0]), None);
        assert_eq!(AliasTable::new(&[1.0, f64::INFINITY]), None);
        let one = AliasTable::new(&[3.0]).unwrap();
        assert_eq!(
            [0.0, 0.999_f32].map(|number| one.choose([number, 0.0])),
            [0.0, 0.0]
        );
    }

    /// Half of the weight is that of one index, the other half that of very many.
    #[test]
    fn shares_are_exact_among_a_million() {
        let n = 1 << 20;
        let mut weights = vec![1.0; n];
        weights[n / 3] = (n - 1) as f64;
        let table = AliasTable::new(&weights).unwrap();
        let n_samples = 1 << 18;
        // The R2 sequence of Roberts (2018) has no pattern in common with the bins.
        let spread = |i: u32, step: f64| (f64::from(i) * step % 1.0) as f32;
        let large = (0..n_samples).filter(|&i| {
            let numbers =
                [0.754_877_666_246_693, 0.569_840_290_998_053].map(|step| spread(i, step));
            let numbers = numbers.map(|number| (number * 16_777_216.0).floor() / 16_777_216.0);
            table.choose(numbers) as usize == n / 3
        });
        let found = large.count() as f64 / f64::from(n_samples);
        assert!((found - 0.5).abs() < 1e-3, "{found}");
        // The last index is reached, too, with the greatest numbers.
        let last = 1.0 - f32::EPSILON / 2.0;
        assert!((table.choose([last, last]) as usize) < n);
    }
}
