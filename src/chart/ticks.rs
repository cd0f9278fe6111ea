//! The ticks of a scale.

/// The ticks of a scale, in increasing order and within its ends.
#[derive(Debug, Default, PartialEq)]
pub struct Ticks {
    /// Values with a label; at least two.
    pub major: Vec<f64>,
    /// Values without a label; some may also be major ones.
    pub minor: Vec<f64>,
}

/// Ticks of a logarithmic scale from `low` to `high`, at least 1 % above it, as dense as labels fit that need `min_gap`
/// of the scale's length, up to 0.14, from one to the next.
///
/// They are 1, 2, 5 times a power of ten; on a narrow range multiples of such a number; on a wide
/// one every power of ten, or every n-th.
pub fn ticks(low: f64, high: f64, min_gap: f64) -> Ticks {
    let min_gap_decades = min_gap * (high / low).log10();
    if min_gap_decades <= 2f64.log10() {
        let major = multiples(&[1.0, 2.0, 5.0], low, high);
        if major.len() >= 3 {
            return Ticks {
                major,
                minor: multiples(&ONE_TO_NINE, low, high),
            };
        }
        return linear_ticks(low, high, min_gap_decades);
    }
    let powers = multiples(&[1.0], low, high);
    if min_gap_decades <= 1.0 {
        return Ticks {
            major: powers,
            minor: multiples(&ONE_TO_NINE, low, high),
        };
    }
    let stride = min_gap_decades.ceil();
    let is_major = |power: &f64| power.log10().round() % stride == 0.0;
    Ticks {
        major: powers.iter().copied().filter(is_major).collect(),
        minor: powers,
    }
}

/// Ticks of a linear scale from `-reach` to `reach`, with labels at least `min_gap` of its length
/// apart, up to 0.14: at zero and at multiples of 1, 2 or 5 times a power of ten on both sides.
pub fn ticks_around_zero(reach: f64, min_gap: f64) -> Ticks {
    // Closer labels are hard to read.
    let least_step = 2.0 * reach * min_gap.max(0.08);
    let power = 10f64.powf(least_step.log10().floor());
    let choices = [(1.0, 5.0), (2.0, 4.0), (5.0, 5.0), (10.0, 5.0)];
    let is_far_enough = |(factor, _): &(f64, f64)| factor * power >= least_step;
    let (factor, n_minor_steps) = choices
        .into_iter()
        .find(is_far_enough)
        .unwrap_or(choices[3]);
    let on_both_sides = |step: f64| -> Vec<f64> {
        let n = (reach / step * (1.0 + 1e-9)).floor() as i64;
        (-n..=n).map(|i| i as f64 * step).collect()
    };
    Ticks {
        major: on_both_sides(factor * power),
        minor: on_both_sides(factor * power / n_minor_steps),
    }
}

const ONE_TO_NINE: [f64; 9] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];

/// Each factor times each power of ten from `low` to `high`.
fn multiples(factors: &[f64], low: f64, high: f64) -> Vec<f64> {
    let exponents = low.log10().floor() as i32..=high.log10().floor() as i32;
    exponents
        .flat_map(|exponent| {
            factors
                .iter()
                .map(move |factor| factor * 10f64.powi(exponent))
        })
        .filter(|&value| is_within(value, low, high))
        .collect()
}

/// Equal steps of 1, 2 or 5 times a power of ten: at most seven, and as far apart as asked at the
/// high end, where they are closest.
fn linear_ticks(low: f64, high: f64, min_gap_decades: f64) -> Ticks {
    let smallest = 10f64.powf((high - low).log10().floor() - 1.0);
    let factors = [
        (1.0, 5.0),
        (2.0, 4.0),
        (5.0, 5.0),
        (10.0, 5.0),
        (20.0, 4.0),
        (50.0, 5.0),
    ];
    let mut ticks = Ticks::default();
    for (factor, n_minor_steps) in factors {
        let step = factor * smallest;
        let (major, minor) = (
            steps(step, low, high),
            steps(step / n_minor_steps, low, high),
        );
        if major.len() < 2 {
            break;
        }
        let gap = |pair: &[f64]| (pair[1] / pair[0]).log10();
        let fits = major.len() <= 7 && major.windows(2).all(|pair| gap(pair) >= min_gap_decades);
        ticks = Ticks { major, minor };
        if fits {
            break;
        }
    }
    ticks
}

/// Each multiple of `step` from `low` to `high`.
fn steps(step: f64, low: f64, high: f64) -> Vec<f64> {
    let counts = (low / step).floor() as u64..=(high / step).ceil() as u64;
    counts
        .map(|i| i as f64 * step)
        .filter(|&value| is_within(value, low, high))
        .collect()
}

/// Tolerates the rounding of `value`.
fn is_within(value: f64, low: f64, high: f64) -> bool {
    value >= low * (1.0 - 1e-9) && value <= high * (1.0 + 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn major_ticks_of_typical_ranges() {
        let table: [(f64, f64, f64, &[f64]); 9] = [
            (
                100.0,
                10_000.0,
                0.04,
                &[100.0, 200.0, 500.0, 1e3, 2e3, 5e3, 1e4],
            ),
            (130.0, 9_000.0, 0.04, &[200.0, 500.0, 1e3, 2e3, 5e3]),
            (1.0, 10.0, 0.04, &[1.0, 2.0, 5.0, 10.0]),
            (
                210.0,
                990.0,
                0.04,
                &[300.0, 400.0, 500.0, 600.0, 700.0, 800.0, 900.0],
            ),
            (
                412.0 / 2f64.sqrt(),
                412.0 * 2f64.sqrt(),
                0.04,
                &[300.0, 350.0, 400.0, 450.0, 500.0, 550.0],
            ),
            (100.0, 102.0, 0.04, &[100.0, 100.5, 101.0, 101.5, 102.0]),
            (
                1.0,
                1e9,
                0.04,
                &[1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9],
            ),
            (
                20.0,
                3e3,
                0.13,
                &[20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3],
            ),
            (1.0, 1e9, 0.14, &[1.0, 100.0, 1e4, 1e6, 1e8]),
        ];
        for (low, high, min_gap, expected) in table {
            let got = ticks(low, high, min_gap).major;
            let is_equal = got.len() == expected.len()
                && got
                    .iter()
                    .zip(expected)
                    .all(|(a, b)| (a / b - 1.0).abs() < 1e-9);
            assert!(
                is_equal,
                "{low} to {high}, gap {min_gap}: {got:?}, expected {expected:?}"
            );
        }
    }

    #[test]
    fn ticks_around_zero_are_round_and_far_enough_apart() {
        let ticks = |reach, min_gap| ticks_around_zero(reach, min_gap).major;
        assert_eq!(ticks(1.0, 0.14), [-1.0, -0.5, 0.0, 0.5, 1.0]);
        assert_eq!(
            ticks(700.0, 0.05),
            [-600.0, -400.0, -200.0, 0.0, 200.0, 400.0, 600.0]
        );
        for i in 0..2000 {
            let reach = 10f64.powf(-30.0 + f64::from(i) * 0.03);
            for min_gap in [0.01, 0.1, 0.14] {
                let ticks = ticks(reach, min_gap);
                let n = ticks.len();
                assert!(
                    n % 2 == 1 && (3..=13).contains(&n) && ticks[n / 2] == 0.0,
                    "{ticks:?}"
                );
                assert!(ticks[n - 1] <= reach * (1.0 + 1e-8) && ticks[0] == -ticks[n - 1]);
                assert!(ticks[n - 1] - ticks[n - 2] >= 2.0 * reach * min_gap * (1.0 - 1e-9));
            }
        }
    }

    #[test]
    fn every_range_has_labels_that_fit() {
        for min_gap in [0.02, 0.05, 0.1, 0.14] {
            for i in 0..400 {
                for n_decades in [
                    0.00433, 0.01, 0.1, 0.31, 0.6, 0.8, 0.99, 1.1, 2.1, 2.4, 5.0, 12.0, 76.0,
                ] {
                    let low = 10f64.powf(-38.0 + f64::from(i) * 0.0937);
                    let high = low * 10f64.powf(n_decades);
                    let Ticks { major, minor } = ticks(low, high, min_gap);
                    let context = format!("{low} to {high}, gap {min_gap}: {major:?}");
                    assert!(major.len() >= 2, "{context}");
                    assert!(
                        [&major, &minor]
                            .iter()
                            .all(|t| t.iter().all(|&v| is_within(v, low, high))),
                        "{context}"
                    );
                    let gap = |pair: &[f64]| (pair[1] / pair[0]).log10() / n_decades;
                    assert!(
                        major.windows(2).all(|pair| gap(pair) >= min_gap - 1e-9),
                        "{context}"
                    );
                }
            }
        }
    }
}
