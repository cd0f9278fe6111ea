//! Order statistics of a sample: the median and the upper median.

use std::cmp::Ordering;

/// Returns the median: the middle value, or the mean of the two middle values; `None` without
/// values. Reorders the values.
pub fn median(values: &mut [f64]) -> Option<f64> {
    let n = values.len();
    let upper = upper_median(values, f64::total_cmp)?;
    if n % 2 == 1 {
        return Some(upper);
    }
    // The selection has left the lower half on the left.
    let lower = values[..n / 2].iter().copied().max_by(f64::total_cmp)?;
    Some((lower + upper) / 2.0)
}

/// Returns the upper median: the middle value, or the greater of the two middle values. Unlike
/// [`median`], it is always one of the values; `None` without values. Reorders the values.
pub fn upper_median<T: Copy>(values: &mut [T], order: impl FnMut(&T, &T) -> Ordering) -> Option<T> {
    order_statistic(values, values.len() / 2, order)
}

/// Returns the value that would have this index after sorting; `None` if out of range. Smaller
/// values end up on its left, greater ones on its right.
fn order_statistic<T: Copy>(
    values: &mut [T],
    index: usize,
    order: impl FnMut(&T, &T) -> Ordering,
) -> Option<T> {
    if index >= values.len() {
        return None;
    }
    Some(*values.select_nth_unstable_by(index, order).1)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn no_values_have_no_median() {
        assert_eq!(median(&mut []), None);
        assert_eq!(upper_median(&mut [], f64::total_cmp), None);
    }

    #[test]
    fn the_rules_differ_where_two_values_are_in_the_middle() {
        let values = [4.0, 1.0, 3.0, 2.0];
        assert_eq!(median(&mut values.clone()), Some(2.5));
        assert_eq!(upper_median(&mut values.clone(), f64::total_cmp), Some(3.0));
    }

    proptest! {
        /// The reference: all values sorted.
        #[test]
        fn selection_finds_what_sorting_does(
            values in prop::collection::vec(-9.0..9.0, 1..20),
        ) {
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            let n = sorted.len();
            let mean = (sorted[(n - 1) / 2] + sorted[n / 2]) / 2.0;
            prop_assert_eq!(median(&mut values.clone()), Some(mean));
            prop_assert_eq!(upper_median(&mut values.clone(), f64::total_cmp), Some(sorted[n / 2]));
        }
    }
}
