//! The change of one metric in every pixel.

use super::ratio;
use tracer::cost::Metric;

/// The change of one metric in every pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// The metric.
    pub metric: Metric,
    /// B - A, row-major, row 0 on top.
    pub differences: Vec<f32>,
    /// The range of the color map of the ratios B / A: 98 % of them lie between `1 / max_ratio` and
    /// `max_ratio`, which is greater than 1.
    pub max_ratio: f64,
}

impl Change {
    /// Computes the change from `a` to `b`, both row-major, row 0 on top.
    pub(super) fn new(metric: Metric, [a, b]: &[Vec<f64>; 2]) -> Self {
        let pairs = || a.iter().zip(b);
        Self {
            metric,
            differences: pairs().map(|(a, b)| (b - a) as f32).collect(),
            max_ratio: robust_max(pairs().map(|(&a, &b)| ratio([a, b]).log2().abs())).exp2(),
        }
    }
}

/// Least range of a color map, as a logarithm to base 2: smaller changes, of less than 5 %, are
/// noise.
const MIN_LOG2: f64 = 0.07;

/// Returns the 98 % quantile of the finite values; at least [`MIN_LOG2`].
fn robust_max(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    let rank = values.len() * 98 / 100;
    if rank >= values.len() {
        return MIN_LOG2;
    }
    let (_, quantile, _) = values.select_nth_unstable_by(rank, f64::total_cmp);
    quantile.max(MIN_LOG2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outliers_do_not_widen_the_range() {
        let mut a = vec![100.0; 1000];
        let mut b = vec![50.0; 1000];
        (a[3], b[4], a[5]) = (0.0, 0.0, 1.0);
        let change = Change::new(Metric::TIME, &[a, b]);
        assert_eq!(change.max_ratio, 2.0);
        assert_eq!(change.differences[..5], [-50.0, -50.0, -50.0, 50.0, -100.0]);
        let same = Change::new(Metric::TIME, &[vec![0.0; 9], vec![0.0; 9]]);
        assert!(same.max_ratio > 1.0 && same.max_ratio < 1.06);
    }
}
