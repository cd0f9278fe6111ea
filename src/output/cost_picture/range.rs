//! Which values the colours span, and what lies outside.
//!
//! One interrupt makes a pixel a thousand times dearer than its neighbours; colours from the
//! smallest to the largest value would then show one bright dot on black. So the range runs
//! between the 0.5 % and the 99.5 % quantile and takes in the extremes only where they are near.
//!
//! The quantiles come from a histogram over the upper half of the floats' bits, which sort like
//! the positive floats themselves: one pass, no copy of the values, no dependence on their order,
//! and bins of less than 1 %, finer than a colour can show.

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// The values that the colours span, and a census of those outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Drawn in the first colour; positive.
    pub low: f64,
    /// Drawn in the last colour; at least 1 % above `low`.
    pub high: f64,
    /// Smallest value that can be drawn; below `low` where `n_below` is not zero.
    pub min: f32,
    /// Largest value that can be drawn; above `high` where `n_above` is not zero.
    pub max: f32,
    /// Pixels below `low`.
    pub n_below: u64,
    /// Pixels above `high`.
    pub n_above: u64,
    /// Pixels that a logarithmic scale cannot show: zero, negative, subnormal, infinite or NaN.
    pub n_undrawable: u64,
}

impl Range {
    /// The range for `values`, in any order; 1 to 2 where none can be drawn.
    pub fn of<'a>(values: impl IntoIterator<Item = &'a f32>) -> Self {
        let census = Census::of(values);
        let Census {
            min,
            max,
            n_undrawable,
            ..
        } = census;
        let (low, high) = at_least_one_percent(census.robust_ends());
        // An end that cuts values off is moved to the edge of its bin, so that the counts are exact.
        let low = if low > min.into() {
            lower_edge(bin(low as f32))
        } else {
            low
        };
        let high = if high < max.into() {
            upper_edge(bin(high as f32))
        } else {
            high
        };
        Self {
            low,
            high,
            min,
            max,
            n_below: census.n_in(0..bin(min.max(low as f32))),
            n_above: census.n_in(bin(max.min(high as f32)) + 1..N_BINS),
            n_undrawable,
        }
    }

    /// Where `value` lies between `low` (0) and `high` (1) on the logarithmic scale; beyond both
    /// for values outside. Grows with `value`, a positive number.
    pub fn position(&self, value: f64) -> f64 {
        (value.log2() - self.low.log2()) / (self.high.log2() - self.low.log2())
    }
}

/// Whether a logarithmic scale can show `value`.
pub fn is_drawable(value: f32) -> bool {
    (f32::MIN_POSITIVE..f32::INFINITY).contains(&value)
}

/// Positive floats by their upper 16 bits.
const N_BINS: usize = 1 << 15;

fn bin(positive: f32) -> usize {
    (positive.to_bits() >> 16) as usize
}

/// Smallest float in `bin`.
fn lower_edge(bin: usize) -> f64 {
    f32::from_bits((bin as u32) << 16).into()
}

/// Largest float in `bin`.
fn upper_edge(bin: usize) -> f64 {
    f32::from_bits((bin as u32) << 16 | 0xffff).into()
}

/// How the drawable values are distributed.
struct Census {
    n_by_bin: Vec<u64>,
    n: u64,
    n_undrawable: u64,
    /// 1 where there is no value.
    min: f32,
    /// 1 where there is no value.
    max: f32,
}

impl Census {
    fn of<'a>(values: impl IntoIterator<Item = &'a f32>) -> Self {
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

    fn n_in(&self, bins: std::ops::Range<usize>) -> u64 {
        self.n_by_bin
            .get(bins)
            .map_or(0, |counts| counts.iter().sum())
    }

    /// The 0.5 % and 99.5 % quantiles, each replaced by the extreme value on its side where that
    /// is within a factor of two, or adds at most a third to the logarithmic range.
    fn robust_ends(&self) -> (f64, f64) {
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

/// Widens ends closer than 1 %, as those of a constant map, to a factor of two around their
/// middle: what varies less is noise, and needs no colours.
fn at_least_one_percent((low, high): (f64, f64)) -> (f64, f64) {
    if high >= 1.01 * low {
        return (low, high);
    }
    let middle = (low * high).sqrt();
    (middle * FRAC_1_SQRT_2, middle * SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1000 to 10,000 in equal ratios, shuffled by a stride.
    fn a_decade(n: usize) -> Vec<f32> {
        (0..n)
            .map(|i| 1e3 * 10f32.powf((i * 7919 % n) as f32 / (n - 1) as f32))
            .collect()
    }

    #[test]
    fn near_extremes_are_the_ends() {
        let range = Range::of(&a_decade(20_000));
        assert!(
            (range.low - 1e3).abs() < 0.01 && (range.high - 1e4).abs() < 0.1,
            "{range:?}"
        );
        assert_eq!(
            (range.n_below, range.n_above, range.n_undrawable),
            (0, 0, 0)
        );
    }

    #[test]
    fn outliers_are_cut_off_and_counted() {
        let mut values = a_decade(20_000);
        values[7] = 1e7;
        values[70] = 3e7;
        values[700] = 1e-2;
        let range = Range::of(&values);
        assert!(range.low > 990.0 && range.low < 1020.0, "{range:?}");
        assert!(range.high > 9_900.0 && range.high < 10_050.0, "{range:?}");
        assert_eq!((range.min, range.max), (1e-2, 3e7));
        let n_above = values
            .iter()
            .filter(|&&v| f64::from(v) > range.high)
            .count();
        let n_below = values.iter().filter(|&&v| f64::from(v) < range.low).count();
        assert_eq!(
            (range.n_below, range.n_above),
            (n_below as u64, n_above as u64)
        );
        assert!(n_above >= 2 && n_below >= 1);
    }

    #[test]
    fn an_outlier_among_equals_is_cut_off() {
        let mut values = vec![412.0; 300];
        values[5] = 412_000.0;
        let range = Range::of(&values);
        assert!(range.high < 1000.0 && range.n_above == 1, "{range:?}");
    }

    #[test]
    fn few_pixels_are_all_shown() {
        let range = Range::of(&[1.0, 1000.0, 1e6]);
        assert_eq!((range.low, range.high), (1.0, 1e6));
    }

    #[test]
    fn a_constant_map_lies_in_the_middle() {
        for value in [412.0, f32::MIN_POSITIVE, f32::MAX] {
            let range = Range::of(&[value; 9]);
            assert!(
                (range.position(value.into()) - 0.5).abs() < 1e-9,
                "{range:?}"
            );
            assert_eq!((range.n_below, range.n_above), (0, 0));
        }
    }

    #[test]
    fn what_cannot_be_drawn_is_counted_and_has_no_influence() {
        let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -5.0, 1e-40];
        let range = Range::of(&[&odd[..], &[3.0, 30.0]].concat());
        assert_eq!(range.n_undrawable, 6);
        assert_eq!((range.low, range.high), (3.0, 30.0));
        assert_eq!(Range::of(&odd).n_undrawable, 6);
        assert!(Range::of(&[]).high > Range::of(&[]).low);
    }

    #[test]
    fn the_order_of_the_pixels_does_not_matter() {
        let mut values = a_decade(5_000);
        values[17] = 1e9;
        let range = Range::of(&values);
        values.reverse();
        assert_eq!(Range::of(&values), range);
    }

    #[test]
    fn position_grows_with_the_value() {
        let range = Range::of(&[10.0, 1000.0]);
        assert_eq!(
            [10.0, 100.0, 1000.0].map(|v| (range.position(v) * 1e6).round()),
            [0.0, 5e5, 1e6]
        );
        let positions: Vec<f64> = (1..5000).map(|v| range.position(v.into())).collect();
        assert!(positions.is_sorted_by(|a, b| a < b));
    }
}
