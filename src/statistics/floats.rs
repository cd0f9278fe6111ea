//! Order statistics of many floats.

/// Number of intervals of floats: those with the same upper 16 bits.
const N_INTERVALS: usize = 1 << 16;

/// The values that would have these indices if all were sorted by
/// [`f32::total_cmp`]; `None` if there are not as many values.
///
/// One pass counts the values by interval, another one selects from those intervals
/// that hold an index: faster than a selection from all values, which it leaves in
/// their order.
pub fn floats_at<const N: usize>(values: &[f32], indices: [usize; N]) -> Option<[f32; N]> {
    if indices.iter().any(|&index| index >= values.len()) {
        return None;
    }
    let mut n_by_interval = vec![0_u32; N_INTERVALS];
    for &value in values {
        n_by_interval[interval(value)] += 1;
    }
    // The interval of each index, and the number of values in those before.
    let places = indices.map(|index| {
        let mut n_before = 0;
        let counts = n_by_interval.iter().enumerate();
        let mut is_in = |n: u32| {
            n_before += n as usize;
            n_before > index
        };
        let found = counts.map(|(i, &n)| (i, n)).find(|&(_, n)| is_in(n));
        let (interval, n) = found.unwrap_or_default();
        (interval, index - (n_before - n as usize))
    });
    let mut wanted: Vec<(usize, Vec<f32>)> = Vec::new();
    for (interval, _) in places {
        if wanted.iter().all(|(known, _)| *known != interval) {
            wanted.push((interval, Vec::new()));
        }
    }
    for &value in values {
        let interval = interval(value);
        for (known, members) in &mut wanted {
            if *known == interval {
                members.push(value);
            }
        }
    }
    Some(places.map(|(interval, index)| {
        let members = wanted.iter_mut().find(|(known, _)| *known == interval);
        let members = members.map_or(&mut [][..], |(_, members)| &mut members[..]);
        *members.select_nth_unstable_by(index, f32::total_cmp).1
    }))
}

/// The interval of a value; intervals have the order of their values.
fn interval(value: f32) -> usize {
    let bits = value.to_bits();
    // Negative floats have the opposite order of their bits.
    let ordered = if value.is_sign_negative() {
        !bits
    } else {
        bits | 1 << 31
    };
    (ordered >> 16) as usize
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
