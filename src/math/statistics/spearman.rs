//! Spearman's rank correlation.
//!
//! C. Spearman: The proof and measurement of association between two things, American Journal of
//! Psychology 15 (1904).

use super::rank_sum::doubled_ranks;

/// Returns the correlation of the ranks of paired values, -1 to 1; equal values share the mean of
/// their ranks. `None` if all values of a sample are equal. The values must not be NaN, and the
/// samples have the same length.
pub fn spearman(a: &[f64], b: &[f64]) -> Option<f64> {
    // The mean of the doubled ranks.
    let mean = a.len() as f64 + 1.0;
    let deviations = [a, b].map(|values| {
        let ranks = doubled_ranks(values, &[]).into_iter();
        ranks.map(|rank| rank as f64 - mean).collect::<Vec<f64>>()
    });
    let [a, b] = &deviations;
    let sum = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    let spread = (sum(a, a) * sum(b, b)).sqrt();
    (spread > 0.0).then(|| sum(a, b) / spread)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_order_matters() {
        let a = [1.0, 2.0, 3.0, 4.0];
        assert_eq!(spearman(&a, &[0.0, 1.0, 10.0, 1e9]), Some(1.0));
        assert_eq!(spearman(&a, &[9.0, 8.0, 7.0, 0.0]), Some(-1.0));
        assert_eq!(spearman(&a, &[5.0; 4]), None);
        assert_eq!(spearman(&[], &[]), None);
    }

    /// The ranks of `b` are 1.5, 1.5, 4 and 3.
    #[test]
    fn equal_values_share_their_ranks() {
        let found = spearman(&[1.0, 2.0, 3.0, 4.0], &[7.0, 7.0, 9.0, 8.0]).unwrap();
        let (covariance, spreads) = (3.5, 5.0_f64 * 4.5);
        assert!(
            (found - covariance / spreads.sqrt()).abs() < 1e-15,
            "{found}"
        );
    }
}
