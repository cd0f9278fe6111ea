//! Sums of many floats.

/// Sums that are added in parallel.
const N_LANES: usize = 16;

/// Returns the sum of values in double precision, in vector instructions: the same bits on every
/// machine.
pub fn sum(values: &[f32]) -> f64 {
    let (many, rest) = values.as_chunks::<N_LANES>();
    let mut lanes = [0.0; N_LANES];
    for values in many {
        for (lane, &value) in lanes.iter_mut().zip(values) {
            *lane += f64::from(value);
        }
    }
    let rest = rest.iter().copied().map(f64::from).sum::<f64>();
    lanes.into_iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_added_once() {
        for n in 0..=50_u16 {
            let values: Vec<f32> = (1..=n).map(f32::from).collect();
            assert_eq!(sum(&values), f64::from(n) * f64::from(n + 1) / 2.0);
        }
    }
}
