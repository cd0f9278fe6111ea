//! A histogram of floats, for the order statistics of more values than fit into memory.

use std::iter;

/// The lower bits of a float that its bin ignores: bins are at most .05 % wide, and whole numbers
/// up to 4096 have one bin each.
const N_OMITTED: u32 = 12;

/// The bits of a float below its exponent.
const N_MANTISSA: u32 = f32::MANTISSA_DIGITS - 1;

/// Bins of the floats with the same exponent.
const PAGE_BINS: usize = 1 << (N_MANTISSA - N_OMITTED);

/// Exponents of finite floats.
const N_PAGES: usize = f32::INFINITY.to_bits() as usize >> N_MANTISSA;

/// A histogram of finite floats that are not negative. A bin is the upper bits of a float, which
/// sort like the floats themselves. Histograms of parts add up to the whole's, in any order.
#[derive(Debug, Clone)]
pub struct Histogram {
    /// The bins by exponent; an empty page where no value has that exponent.
    pages: Vec<Vec<u64>>,
    /// Number of values in the bins.
    pub n: u64,
    /// Number of other values: negative, infinite or NaN.
    pub n_other: u64,
    /// The least value that is at least [`f32::MIN_POSITIVE`]; infinite if there is none.
    pub least_normal: f32,
    /// The greatest value.
    pub greatest: f32,
}

impl Default for Histogram {
    fn default() -> Self {
        Self {
            pages: vec![Vec::new(); N_PAGES],
            n: 0,
            n_other: 0,
            least_normal: f32::INFINITY,
            greatest: 0.0,
        }
    }
}

impl Histogram {
    /// Counts values.
    pub fn count(values: impl IntoIterator<Item = f32>) -> Self {
        let mut this = Self::default();
        this.add(values);
        this
    }

    /// Counts more values.
    pub fn add(&mut self, values: impl IntoIterator<Item = f32>) {
        // In registers during the loop; floats that are not negative sort like their bits.
        let (mut n, mut n_other) = (0, 0);
        let [mut least, mut greatest] = [self.least_normal, self.greatest].map(f32::to_bits);
        for value in values {
            // Without the sign of -0.
            let bits = if value == 0.0 { 0.0 } else { value }.to_bits();
            if bits >= f32::INFINITY.to_bits() {
                n_other += 1;
                continue;
            }
            let page = &mut self.pages[(bits >> N_MANTISSA) as usize];
            if page.is_empty() {
                page.resize(PAGE_BINS, 0);
            }
            page[(bits >> N_OMITTED) as usize % PAGE_BINS] += 1;
            n += 1;
            greatest = greatest.max(bits);
            if bits >= f32::MIN_POSITIVE.to_bits() {
                least = least.min(bits);
            }
        }
        self.n += n;
        self.n_other += n_other;
        [self.least_normal, self.greatest] = [least, greatest].map(f32::from_bits);
    }

    /// Adds the values of another histogram.
    pub fn merge(&mut self, other: &Self) {
        for (page, others) in self.pages.iter_mut().zip(&other.pages) {
            page.resize(page.len().max(others.len()), 0);
            iter::zip(page, others).for_each(|(n, other)| *n += other);
        }
        self.n += other.n;
        self.n_other += other.n_other;
        self.least_normal = self.least_normal.min(other.least_normal);
        self.greatest = self.greatest.max(other.greatest);
    }

    /// Returns the bins that hold values, in ascending order: the least float of each, and the
    /// number of values in it.
    pub fn bins(&self) -> impl DoubleEndedIterator<Item = (f32, u64)> {
        let pages = self.pages.iter().enumerate();
        pages.flat_map(|(exponent, page)| {
            let first = (exponent as u32) << N_MANTISSA;
            let used = page.iter().enumerate().filter(|&(_, &n)| n > 0);
            used.map(move |(bin, &n)| (f32::from_bits(first | (bin as u32) << N_OMITTED), n))
        })
    }

    /// Returns the least float in the bin of the value that would have this index after sorting;
    /// `None` if out of range.
    pub fn at(&self, index: u64) -> Option<f32> {
        value_past(index, self.bins())
    }
}

/// Returns the value of the first of the `bins`, values and their numbers, at which the cumulative
/// number exceeds `n`; `None` if there is none.
pub fn value_past(n: u64, mut bins: impl Iterator<Item = (f32, u64)>) -> Option<f32> {
    let mut n_passed = 0;
    let bin = bins.find(|&(_, n_in_bin)| {
        n_passed += n_in_bin;
        n_passed > n
    });
    bin.map(|(value, _)| value)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn whole_numbers_up_to_4096_are_exact() {
        for n in (0..=4096_u16).map(f32::from) {
            assert_eq!(Histogram::count([n]).at(0), Some(n));
        }
    }

    #[test]
    fn values_without_a_bin_are_counted() {
        let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -5.0, -1e-40];
        let histogram = Histogram::count(odd);
        assert_eq!((histogram.n, histogram.n_other), (0, 5));
        let zeros = Histogram::count([-0.0, 0.0, 1e-40]);
        assert_eq!((zeros.n, zeros.n_other), (3, 0));
        assert_eq!((zeros.least_normal, zeros.greatest), (f32::INFINITY, 1e-40));
    }

    proptest! {
        /// The reference: all values sorted.
        #[test]
        fn quantiles_are_those_of_sorting(
            values in prop::collection::vec(
                prop_oneof![0.0..1e9_f32, 1.0..1.01_f32, Just(0.0), Just(7.0), Just(f32::MAX)],
                1..60,
            ),
            n_first in 0..60_usize,
        ) {
            let (first, others) = values.split_at(n_first.min(values.len()));
            let [mut histogram, others] = [first, others].map(|values| {
                Histogram::count(values.iter().copied())
            });
            histogram.merge(&others);
            let mut sorted = values.clone();
            sorted.sort_by(f32::total_cmp);
            for (index, &value) in sorted.iter().enumerate() {
                let found = histogram.at(index as u64).unwrap();
                prop_assert!(found <= value && value <= found * 1.0005);
            }
            prop_assert_eq!(histogram.at(values.len() as u64), None);
            prop_assert_eq!(histogram.greatest, sorted[sorted.len() - 1]);
            let least = sorted.iter().copied().find(|&value| value > 0.0);
            prop_assert_eq!(histogram.least_normal, least.unwrap_or(f32::INFINITY));
        }
    }
}
