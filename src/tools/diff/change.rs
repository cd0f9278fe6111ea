//! The change of one metric in every pixel.

use super::{Side, ratio};
use host::text::Diagnostic;
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
    /// Computes the change of a metric from A to B.
    ///
    /// # Errors
    /// The metric cannot be read.
    pub(super) fn measure([a, b]: &[Side; 2], metric: Metric) -> Result<Self, Diagnostic> {
        let mut differences = Vec::new();
        let mut changes = Vec::new();
        for rows in a.bands() {
            let (a, b) = (a.costs(metric, rows.clone())?, b.costs(metric, rows)?);
            differences.extend(a.iter().zip(&b).map(|(a, b)| (b - a) as f32));
            changes.extend(a.iter().zip(&b).filter_map(|(&a, &b)| log2_change([a, b])));
        }
        Ok(Self {
            metric,
            differences,
            max_ratio: f64::from(robust_max(changes)).exp2(),
        })
    }
}

/// Least range of a color map, as a logarithm to base 2: smaller changes, of less than 5 %, are
/// noise.
const MIN_LOG2: f32 = 0.07;

/// Returns the size of the logarithm to base 2 of the ratio B / A; `None` if it is infinite.
fn log2_change(cost: [f64; 2]) -> Option<f32> {
    let change = ratio(cost).log2().abs() as f32;
    change.is_finite().then_some(change)
}

/// Returns the 98 % quantile of the values; at least [`MIN_LOG2`].
fn robust_max(mut values: Vec<f32>) -> f32 {
    let rank = values.len() * 98 / 100;
    if rank >= values.len() {
        return MIN_LOG2;
    }
    let (_, quantile, _) = values.select_nth_unstable_by(rank, f32::total_cmp);
    quantile.max(MIN_LOG2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outliers_do_not_widen_the_range() {
        let mut costs = vec![[100.0, 50.0]; 1000];
        (costs[3][0], costs[4][1], costs[5][0]) = (0.0, 0.0, 1.0);
        let max =
            |costs: Vec<[f64; 2]>| robust_max(costs.into_iter().filter_map(log2_change).collect());
        assert_eq!(max(costs), 1.0);
        assert_eq!(max(vec![[0.0; 2]; 9]), MIN_LOG2);
    }
}
