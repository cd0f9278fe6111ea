//! A histogram of values with its quantiles.
//!
//! Bins are the upper 16 bits of a float, which sort like positive floats. It needs one pass and no
//! copy of the values, does not depend on their order, and its bins are narrower than 1 %, less
//! than one color step.

/// Returns true if a logarithmic scale can show `value`.
pub fn is_drawable(value: f32) -> bool {
    (f32::MIN_POSITIVE..f32::INFINITY).contains(&value)
}

/// Number of bins of positive floats: one per value of their upper 16 bits.
pub const N_BINS: usize = 1 << 15;

/// Returns the bin of a positive float.
pub fn bin(positive: f32) -> usize {
    (positive.to_bits() >> 16) as usize
}

/// Returns the smallest float in `bin`.
pub fn lower_edge(bin: usize) -> f64 {
    f32::from_bits((bin as u32) << 16).into()
}

/// Returns the largest float in `bin`.
pub fn upper_edge(bin: usize) -> f64 {
    f32::from_bits((bin as u32) << 16 | 0xffff).into()
}

/// A histogram of the drawable values.
#[derive(Debug, Clone)]
pub struct Histogram {
    n_by_bin: Vec<u64>,
    /// Number of drawable values.
    pub n: u64,
    /// Number of values that cannot be drawn.
    pub n_undrawable: u64,
    /// The least value; 1 if there is none.
    pub min: f32,
    /// The greatest value; 1 if there is none.
    pub max: f32,
}

/// An empty histogram.
impl Default for Histogram {
    fn default() -> Self {
        Self {
            n_by_bin: vec![0; N_BINS],
            n: 0,
            n_undrawable: 0,
            min: 1.0,
            max: 1.0,
        }
    }
}

impl Histogram {
    /// Counts the values of a new histogram.
    pub fn count<'a>(values: impl IntoIterator<Item = &'a f32>) -> Self {
        let mut this = Self::default();
        this.add(values);
        this
    }

    /// Counts more values.
    pub fn add<'a>(&mut self, values: impl IntoIterator<Item = &'a f32>) {
        let (mut min, mut max, mut n) = match self.n {
            0 => (f32::INFINITY, 0.0_f32, 0),
            n => (self.min, self.max, n),
        };
        for &value in values {
            if is_drawable(value) {
                self.n_by_bin[bin(value)] += 1;
                (min, max, n) = (min.min(value), max.max(value), n + 1);
            } else {
                self.n_undrawable += 1;
            }
        }
        if n > 0 {
            (self.min, self.max, self.n) = (min, max, n);
        }
    }

    /// Returns the number of values in a range of bins.
    pub fn n_in(&self, bins: std::ops::Range<usize>) -> u64 {
        self.n_by_bin
            .get(bins)
            .map_or(0, |counts| counts.iter().sum())
    }

    /// Returns the 0.5 % and 99.5 % quantiles. Either is replaced by the extreme value on its side
    /// if this is within a factor of two, or extends the logarithmic range by at most a third.
    pub fn robust_ends(&self) -> (f64, f64) {
        let (min, max) = (f64::from(self.min), f64::from(self.max));
        // Among fewer than a hundred pixels none counts as an outlier.
        let n_tail = if self.n < 100 {
            0
        } else {
            (self.n / 200).max(1)
        };
        let low = lower_edge(self.bin_past(n_tail, 0..N_BINS)).max(min);
        let high = upper_edge(self.bin_past(n_tail, (0..N_BINS).rev())).min(max);
        let max_ratio = (high / low).cbrt().max(2.0);
        (
            if low / min <= max_ratio { min } else { low },
            if max / high <= max_ratio { max } else { high },
        )
    }

    /// Returns the 99 % quantile, or the greatest value if it is within a factor of two or there
    /// are fewer than a hundred values.
    pub fn robust_max(&self) -> f64 {
        let max = f64::from(self.max);
        let n_tail = if self.n < 100 { 0 } else { self.n / 100 };
        let most = upper_edge(self.bin_past(n_tail, (0..N_BINS).rev()));
        if max <= 2.0 * most { max } else { most }
    }

    /// Returns the first of `bins` at which the cumulative count exceeds `n_tail`.
    fn bin_past(&self, n_tail: u64, mut bins: impl Iterator<Item = usize>) -> usize {
        let mut n_passed = 0;
        bins.find(|&bin| {
            n_passed += self.n_by_bin[bin];
            n_passed > n_tail
        })
        .unwrap_or(bin(1.0))
    }
}
