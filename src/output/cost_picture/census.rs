//! How values are distributed, by bins.
//!
//! The quantiles come from a histogram over the upper half of the floats' bits, which sort like
//! the positive floats themselves: one pass, no copy of the values, no dependence on their order,
//! and bins of less than 1 %, finer than a colour can show.

/// Whether a logarithmic scale can show `value`.
pub fn is_drawable(value: f32) -> bool {
    (f32::MIN_POSITIVE..f32::INFINITY).contains(&value)
}

/// Bins of positive floats by their upper 16 bits.
pub const N_BINS: usize = 1 << 15;

/// The bin of a positive float.
pub fn bin(positive: f32) -> usize {
    (positive.to_bits() >> 16) as usize
}

/// Smallest float in `bin`.
pub fn lower_edge(bin: usize) -> f64 {
    f32::from_bits((bin as u32) << 16).into()
}

/// Largest float in `bin`.
pub fn upper_edge(bin: usize) -> f64 {
    f32::from_bits((bin as u32) << 16 | 0xffff).into()
}

/// How the drawable values are distributed.
pub struct Census {
    n_by_bin: Vec<u64>,
    /// Values that can be drawn.
    pub n: u64,
    /// All others.
    pub n_undrawable: u64,
    /// The least value; 1 where there is none.
    pub min: f32,
    /// The greatest value; 1 where there is none.
    pub max: f32,
}

impl Census {
    /// Counts the values.
    pub fn of<'a>(values: impl IntoIterator<Item = &'a f32>) -> Self {
        let mut n_by_bin = vec![0; N_BINS];
        let (mut min, mut max, mut n) = (f32::INFINITY, 0.0_f32, 0);
        let mut n_undrawable = 0;
        for &value in values {
            if is_drawable(value) {
                n_by_bin[bin(value)] += 1;
                (min, max, n) = (min.min(value), max.max(value), n + 1);
            } else {
                n_undrawable += 1;
            }
        }
        if n == 0 {
            (min, max) = (1.0, 1.0);
        }
        Self {
            n_by_bin,
            n,
            n_undrawable,
            min,
            max,
        }
    }

    /// How many values are in these bins.
    pub fn n_in(&self, bins: std::ops::Range<usize>) -> u64 {
        self.n_by_bin
            .get(bins)
            .map_or(0, |counts| counts.iter().sum())
    }

    /// The 0.5 % and 99.5 % quantiles, each replaced by the extreme value on its side where that
    /// is within a factor of two, or adds at most a third to the logarithmic range.
    pub fn robust_ends(&self) -> (f64, f64) {
        let (min, max) = (f64::from(self.min), f64::from(self.max));
        // Below a hundred pixels a single one is no outlier but a part of the picture.
        let n_tail = if self.n < 100 {
            0
        } else {
            (self.n / 200).max(1)
        };
        let low = lower_edge(self.bin_past(n_tail, 0..N_BINS)).max(min);
        let high = upper_edge(self.bin_past(n_tail, (0..N_BINS).rev())).min(max);
        let reach = (high / low).cbrt().max(2.0);
        (
            if low / min <= reach { min } else { low },
            if max / high <= reach { max } else { high },
        )
    }

    /// The 99 % quantile, or the greatest value where that is within a factor of two or few are.
    pub fn size_of_most(&self) -> f64 {
        let max = f64::from(self.max);
        let n_tail = if self.n < 100 { 0 } else { self.n / 100 };
        let most = upper_edge(self.bin_past(n_tail, (0..N_BINS).rev()));
        if max <= 2.0 * most { max } else { most }
    }

    /// The first of `bins` with which more than `n_tail` values are passed.
    fn bin_past(&self, n_tail: u64, mut bins: impl Iterator<Item = usize>) -> usize {
        let mut n_passed = 0;
        bins.find(|&bin| {
            n_passed += self.n_by_bin[bin];
            n_passed > n_tail
        })
        .unwrap_or(bin(1.0))
    }
}
