//! Order statistics of more floats than fit into memory.

/// The lower bits of a float that its bin ignores: bins are at most .05 % wide, and whole numbers
/// up to 4096 have one bin each.
const N_OMITTED: u32 = 12;
/// Number of bins of positive floats.
const N_BINS: usize = 1 << (u32::BITS - 1 - N_OMITTED);

/// A histogram of non-negative floats. A bin is the upper bits of a float, which sort like the
/// floats themselves.
#[derive(Debug, Clone)]
pub struct FineHistogram {
    n_by_bin: Vec<u64>,
    /// Number of values.
    pub n: u64,
}

/// Returns the least float in the bin of a non-negative float.
pub fn lower_edge(value: f32) -> f32 {
    f32::from_bits(value.to_bits() >> N_OMITTED << N_OMITTED)
}

impl Default for FineHistogram {
    fn default() -> Self {
        Self {
            n_by_bin: vec![0; N_BINS],
            n: 0,
        }
    }
}

impl FineHistogram {
    /// Memory in bytes.
    pub const BYTES: u64 = (N_BINS * size_of::<u64>()) as u64;

    /// Counts values; none of them may be negative or NaN.
    pub fn add(&mut self, values: impl IntoIterator<Item = f32>) {
        for value in values {
            // Without the sign of -0.
            self.n_by_bin[(value.abs().to_bits() >> N_OMITTED) as usize] += 1;
            self.n += 1;
        }
    }

    /// Returns the [`lower_edge`] of the value that would have this index after sorting; `None` if
    /// out of range.
    pub fn at(&self, index: u64) -> Option<f32> {
        let mut n_passed = 0;
        let bin = self.n_by_bin.iter().position(|n| {
            n_passed += n;
            n_passed > index
        });
        bin.map(|bin| f32::from_bits((bin as u32) << N_OMITTED))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn whole_numbers_up_to_4096_are_exact() {
        for n in 0..=4096_u16 {
            assert_eq!(lower_edge(n.into()), f32::from(n));
        }
    }

    proptest! {
        /// The reference: all values sorted.
        #[test]
        fn quantiles_are_those_of_sorting(
            values in prop::collection::vec(
                prop_oneof![0.0..1e9_f32, 1.0..1.01_f32, Just(0.0), Just(7.0)],
                1..60,
            ),
        ) {
            let mut histogram = FineHistogram::default();
            let (first, others) = values.split_at(values.len() / 2);
            histogram.add(first.iter().copied());
            histogram.add(others.iter().copied());
            let mut sorted = values.clone();
            sorted.sort_by(f32::total_cmp);
            for (index, &value) in sorted.iter().enumerate() {
                let found = histogram.at(index as u64).unwrap();
                prop_assert_eq!(found, lower_edge(value));
                prop_assert!(found <= value && value <= found * 1.0005);
            }
            prop_assert_eq!(histogram.at(values.len() as u64), None);
        }
    }
}
