//! What each pixel changed by.

use super::measure::{Measure, ratio};

/// One measure's change, pixel by pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// Which measure.
    pub measure: Measure,
    /// B - A, row-major, row 0 on top.
    pub differences: Vec<f32>,
    /// Most pixels' ratios B / A are between this, above 1, and one over it.
    pub ratio_of_most: f64,
}

impl Change {
    /// The change from `a` to `b`, both row-major, row 0 on top.
    pub(super) fn of(measure: Measure, [a, b]: &[Vec<f64>; 2]) -> Self {
        let pairs = || a.iter().zip(b);
        Self {
            measure,
            differences: pairs().map(|(a, b)| (b - a) as f32).collect(),
            ratio_of_most: most(pairs().map(|(&a, &b)| ratio([a, b]).log2().abs())).exp2(),
        }
    }
}

/// Smaller logarithms to base 2 are noise and are not colored: 5 %.
const LEAST_SIZE: f64 = 0.07;

/// The 98 % quantile of the finite sizes; at least [`LEAST_SIZE`].
fn most(sizes: impl Iterator<Item = f64>) -> f64 {
    let mut sizes: Vec<f64> = sizes.filter(|size| size.is_finite()).collect();
    let rank = sizes.len() * 98 / 100;
    if rank >= sizes.len() {
        return LEAST_SIZE;
    }
    let (_, most, _) = sizes.select_nth_unstable_by(rank, f64::total_cmp);
    most.max(LEAST_SIZE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_far_ratios_do_not_count() {
        let mut a = vec![100.0; 1000];
        let mut b = vec![50.0; 1000];
        (a[3], b[4], a[5]) = (0.0, 0.0, 1.0);
        let change = Change::of(Measure::TIME, &[a, b]);
        assert_eq!(change.ratio_of_most, 2.0);
        assert_eq!(change.differences[..5], [-50.0, -50.0, -50.0, 50.0, -100.0]);
        let same = Change::of(Measure::TIME, &[vec![0.0; 9], vec![0.0; 9]]);
        assert!(same.ratio_of_most > 1.0 && same.ratio_of_most < 1.06);
    }
}
