//! The range of values that the colors represent, and the values outside of it.
//!
//! An interrupt makes a pixel a thousand times more expensive than its neighbors; colors from the
//! least to the greatest value would then show one bright dot on black. So the range extends from
//! the 0.5 % to the 99.5 % quantile, and includes the extremes only if they are near. Changes have a
//! symmetric range around zero, up to the 99 % quantile of the magnitudes that are not zero.

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use math::statistics::{Histogram, value_past};

use super::ticks::Scale;

/// The lower bits of a float that ends of a range ignore: such a step is narrower than 1 %, less
/// than one color step.
const N_OMITTED: u32 = 16;

/// The range of the colors, and the number of values outside of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The scale of the colors.
    pub scale: Scale,
    /// The value of the first color; positive on a logarithmic scale.
    pub low: f64,
    /// The value of the last color; at least 1 % above `low`.
    pub high: f64,
    /// The least drawable value; below `low` if `n_below` is not zero.
    pub min: f32,
    /// The greatest drawable value; above `high` if `n_above` is not zero.
    pub max: f32,
    /// Pixels below `low`.
    pub n_below: u64,
    /// Pixels above `high`.
    pub n_above: u64,
    /// Pixels that the scale cannot show: NaN or infinite; on a logarithmic scale also zero,
    /// negative or subnormal.
    pub n_undrawable: u64,
}

impl Range {
    /// Returns the logarithmic range for `values`, in any order; a range around 1 if none is drawable.
    pub fn spanning<'a>(values: impl IntoIterator<Item = &'a f32>) -> Self {
        Self::from_histogram(&Histogram::count(values.into_iter().copied()))
    }

    /// Returns the logarithmic range for the values of a histogram.
    pub fn from_histogram(histogram: &Histogram) -> Self {
        let drawable = Drawable::new(histogram);
        let [min, max] = drawable.extremes;
        let (low, high) = drawable.robust_ends();
        let (low, high) = at_least_one_percent(low, high);
        // An end that clips values moves to the end of its step, so that the counts are exact.
        let low = if low > min.into() {
            f64::from(step_start(low as f32))
        } else {
            low
        };
        let high = if high < max.into() {
            f64::from(step_end(high as f32))
        } else {
            high
        };
        Self {
            scale: Scale::Logarithmic,
            low,
            high,
            min,
            max,
            n_below: drawable.n_where(|value| value < low && low > min.into()),
            n_above: drawable.n_where(|value| value > high),
            n_undrawable: histogram.n + histogram.n_other - drawable.n,
        }
    }

    /// Returns a linear range that is symmetric around zero; -1 to 1 if all values are zero.
    pub fn around_zero(values: &[f32]) -> Self {
        let histogram = Histogram::count(values.iter().map(|value| value.abs()));
        let reach = Drawable::new(&histogram).robust_max();
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        let n = |is_so: &dyn Fn(f64) -> bool| finite().filter(|&v| is_so(v.into())).count() as u64;
        Self {
            scale: Scale::Linear,
            low: -reach,
            high: reach,
            min: finite().fold(0.0, f32::min),
            max: finite().fold(0.0, f32::max),
            n_below: n(&|value| value < -reach),
            n_above: n(&|value| value > reach),
            n_undrawable: (values.len() - finite().count()) as u64,
        }
    }

    /// Returns a range between ascending ends, positive on a logarithmic scale; `clips` is true for
    /// each end that has values beyond it.
    pub fn between(scale: Scale, [low, high]: [f64; 2], clips: [bool; 2]) -> Self {
        let [n_below, n_above] = clips.map(u64::from);
        Self {
            scale,
            low,
            high,
            n_below,
            n_above,
            ..Self::spanning(&[])
        }
    }

    /// Returns the position of `value` between `low` (0) and `high` (1), beyond these outside of
    /// the range. Increases with `value`, which must be positive on a logarithmic scale.
    pub fn position(&self, value: f64) -> f64 {
        self.scale.position(value, [self.low, self.high])
    }
}

/// Returns true if a logarithmic scale can show `value`.
#[inline]
pub(super) fn is_drawable(value: f32) -> bool {
    (f32::MIN_POSITIVE..f32::INFINITY).contains(&value)
}

/// The drawable values of a histogram.
struct Drawable<'a> {
    histogram: &'a Histogram,
    n: u64,
    /// The least and the greatest value; 1 if there is none.
    extremes: [f32; 2],
}

impl<'a> Drawable<'a> {
    fn new(histogram: &'a Histogram) -> Self {
        let n = drawable_bins(histogram).map(|(_, n)| n).sum();
        let extremes = if n > 0 {
            [histogram.least_normal, histogram.greatest]
        } else {
            [1.0; 2]
        };
        Self {
            histogram,
            n,
            extremes,
        }
    }

    fn bins(&self) -> impl DoubleEndedIterator<Item = (f32, u64)> {
        drawable_bins(self.histogram)
    }

    /// Returns the number of values in some bins.
    fn n_where(&self, is_wanted: impl Fn(f64) -> bool) -> u64 {
        let wanted = self.bins().filter(|&(value, _)| is_wanted(value.into()));
        wanted.map(|(_, n)| n).sum()
    }

    /// Returns the 0.5 % and 99.5 % quantiles. Either is replaced by the extreme value on its side
    /// if this is within a factor of two, or extends the logarithmic range by at most a third.
    fn robust_ends(&self) -> (f64, f64) {
        let [min, max] = self.extremes.map(f64::from);
        // Among fewer than a hundred pixels none counts as an outlier.
        let n_tail = if self.n < 100 {
            0
        } else {
            (self.n / 200).max(1)
        };
        let low = value_past(n_tail, self.bins()).unwrap_or(1.0);
        let high = value_past(n_tail, self.bins().rev()).unwrap_or(1.0);
        let low = f64::from(step_start(low)).max(min);
        let high = f64::from(step_end(high)).min(max);
        let max_ratio = (high / low).cbrt().max(2.0);
        (
            if low / min <= max_ratio { min } else { low },
            if max / high <= max_ratio { max } else { high },
        )
    }

    /// Returns the 99 % quantile, or the greatest value if it is within a factor of two or there are
    /// fewer than a hundred values.
    fn robust_max(&self) -> f64 {
        let max = f64::from(self.extremes[1]);
        let n_tail = if self.n < 100 { 0 } else { self.n / 100 };
        let most = value_past(n_tail, self.bins().rev()).unwrap_or(1.0);
        let most = step_end(most).into();
        if max <= 2.0 * most { max } else { most }
    }
}

/// Returns the bins of the drawable values, each by its least float, and the number of values in it.
fn drawable_bins(histogram: &Histogram) -> impl DoubleEndedIterator<Item = (f32, u64)> {
    histogram.bins().filter(|&(value, _)| is_drawable(value))
}

/// Returns the least float in the step of a positive float.
fn step_start(value: f32) -> f32 {
    f32::from_bits(value.to_bits() >> N_OMITTED << N_OMITTED)
}

/// Returns the greatest float in the step of a positive float.
fn step_end(value: f32) -> f32 {
    f32::from_bits(value.to_bits() | ((1 << N_OMITTED) - 1))
}

/// Widens a range narrower than 1 %, such as a constant map's, to a factor of two around its
/// middle: smaller variations are noise.
fn at_least_one_percent(low: f64, high: f64) -> (f64, f64) {
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
        let range = Range::spanning(&a_decade(20_000));
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
    fn outliers_are_clipped_and_counted() {
        let mut values = a_decade(20_000);
        values[7] = 1e7;
        values[70] = 3e7;
        values[700] = 1e-2;
        let range = Range::spanning(&values);
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
    fn an_outlier_among_equals_is_clipped() {
        let mut values = vec![412.0; 300];
        values[5] = 412_000.0;
        let range = Range::spanning(&values);
        assert!(range.high < 1000.0 && range.n_above == 1, "{range:?}");
    }

    #[test]
    fn few_pixels_are_all_shown() {
        let range = Range::spanning(&[1.0, 1000.0, 1e6]);
        assert_eq!((range.low, range.high), (1.0, 1e6));
    }

    #[test]
    fn a_constant_map_lies_in_the_middle() {
        for value in [412.0, f32::MIN_POSITIVE, f32::MAX] {
            let range = Range::spanning(&[value; 9]);
            assert!(
                (range.position(value.into()) - 0.5).abs() < 1e-9,
                "{range:?}"
            );
            assert_eq!((range.n_below, range.n_above), (0, 0));
        }
    }

    #[test]
    fn undrawable_values_are_only_counted() {
        let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -5.0, 1e-40];
        let range = Range::spanning(&[&odd[..], &[3.0, 30.0]].concat());
        assert_eq!(range.n_undrawable, 6);
        assert_eq!((range.low, range.high), (3.0, 30.0));
        assert_eq!(Range::spanning(&odd).n_undrawable, 6);
        assert!(Range::spanning(&[]).high > Range::spanning(&[]).low);
    }

    #[test]
    fn the_order_of_the_pixels_does_not_matter() {
        let mut values = a_decade(5_000);
        values[17] = 1e9;
        let range = Range::spanning(&values);
        values.reverse();
        assert_eq!(Range::spanning(&values), range);
    }

    #[test]
    fn the_range_of_changes_is_symmetric() {
        let values: Vec<f32> = (0..1000).map(|i| i as f32 - 700.0).collect();
        let range = Range::around_zero(&values);
        assert_eq!((range.low, range.high), (-700.0, 700.0));
        assert_eq!((range.min, range.max, range.n_below), (-700.0, 299.0, 0));
        assert_eq!(
            [-700.0, 0.0, 350.0].map(|v| range.position(v)),
            [0.0, 0.5, 0.75]
        );
    }

    #[test]
    fn an_outlier_among_changes_is_clipped() {
        let mut values = vec![0.0; 10_000];
        values[..900].fill(-3.0);
        (values[900], values[901]) = (1e6, f32::NAN);
        let range = Range::around_zero(&values);
        assert!(range.high >= 3.0 && range.high < 3.03, "{range:?}");
        assert_eq!(
            (range.n_below, range.n_above, range.n_undrawable),
            (0, 1, 1)
        );
        assert_eq!(Range::around_zero(&[0.0; 9]).high, 1.0);
        assert_eq!(Range::around_zero(&[f32::INFINITY]).n_undrawable, 1);
    }

    #[test]
    fn position_grows_with_the_value() {
        let range = Range::spanning(&[10.0, 1000.0]);
        assert_eq!(
            [10.0, 100.0, 1000.0].map(|v| (range.position(v) * 1e6).round()),
            [0.0, 5e5, 1e6]
        );
        let positions: Vec<f64> = (1..5000).map(|v| range.position(v.into())).collect();
        assert!(positions.is_sorted_by(|a, b| a < b));
    }
}
