//! Order statistics of many floats.

/// Number of intervals of floats with the same upper 16 bits, and of floats in each.
const N_INTERVALS: usize = 1 << 16;

/// Returns the values that would have these indices if all were sorted by [`f32::total_cmp`];
/// `None` if an index is out of range.
///
/// One pass counts the values by their upper bits, and a second one, by their lower bits, the
/// values of the intervals that hold an index: faster than a selection, which would move all
/// values.
pub fn floats_at<const N: usize>(values: &[f32], indices: [usize; N]) -> Option<[f32; N]> {
    if indices.iter().any(|&index| index >= values.len()) {
        return None;
    }
    // Count the values by their upper bits, and find the intervals that hold an index.
    let mut by_upper = vec![0; N_INTERVALS];
    for &value in values {
        by_upper[ordered(value) >> 16] += 1;
    }
    let places = indices.map(|index| place(&by_upper, index));
    let mut by_lower: Vec<(usize, Vec<u32>)> = Vec::new();
    for (interval, _) in places {
        if by_lower.iter().all(|(known, _)| *known != interval) {
            by_lower.push((interval, vec![0; N_INTERVALS]));
        }
    }
    for &value in values {
        let ordered = ordered(value);
        for (interval, counts) in &mut by_lower {
            if *interval == ordered >> 16 {
                counts[ordered % N_INTERVALS] += 1;
            }
        }
    }
    Some(places.map(|(interval, index)| {
        let members = by_lower.iter().find(|(known, _)| *known == interval);
        let (lower, _) = members.map_or((0, 0), |(_, counts)| place(counts, index));
        from_ordered(interval << 16 | lower)
    }))
}

/// Returns the interval that holds an index, and the index within it, given the number of values in
/// each.
fn place(counts: &[u32], mut index: usize) -> (usize, usize) {
    for (interval, &n) in counts.iter().enumerate() {
        if index < n as usize {
            return (interval, index);
        }
        index -= n as usize;
    }
    (0, 0)
}

/// Maps a value to bits that have the order of [`f32::total_cmp`].
fn ordered(value: f32) -> usize {
    let bits = value.to_bits();
    // Negative floats sort in the opposite order of their bits.
    let ordered = if value.is_sign_negative() {
        !bits
    } else {
        bits | 1 << 31
    };
    ordered as usize
}

/// Inverts [`ordered`].
fn from_ordered(ordered: usize) -> f32 {
    let ordered = ordered as u32;
    let is_negative = ordered >> 31 == 0;
    f32::from_bits(if is_negative {
        !ordered
    } else {
        ordered & !(1 << 31)
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn an_index_beyond_the_last_has_no_value() {
        assert_eq!(floats_at(&[], [0]), None);
        assert_eq!(floats_at(&[1.0], [0, 1]), None);
    }

    proptest! {
        /// The reference: all values sorted.
        #[test]
        fn selected_floats_are_those_of_sorting(
            values in prop::collection::vec(
                prop_oneof![any::<f32>(), 1.0..1.01_f32, Just(0.0), Just(-0.0)],
                1..60,
            ),
            parts in [0..=100_usize, 0..=100],
        ) {
            let indices = parts.map(|part| part * (values.len() - 1) / 100);
            let mut sorted = values.clone();
            sorted.sort_by(f32::total_cmp);
            let found = floats_at(&values, indices).unwrap();
            let bits = found.map(f32::to_bits);
            prop_assert_eq!(bits, indices.map(|index| sorted[index].to_bits()));
        }
    }
}
