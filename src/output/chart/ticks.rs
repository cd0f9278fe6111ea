//! Scales, and ticks at round values.

use base::keywords;

keywords! {
    /// The scale of colors or of an axis.
    #[derive(Default)]
    pub enum Scale {
        /// For positive values.
        #[default]
        Logarithmic = "log",
        /// For changes around zero.
        Linear = "linear",
    }
}

impl Scale {
    /// Returns the position of `value` between `low` (0) and `high` (1), beyond these outside of
    /// both. Increases with `value`; on a logarithmic scale all three are positive.
    pub fn position(self, value: f64, [low, high]: [f64; 2]) -> f64 {
        let along = match self {
            Self::Logarithmic => f64::log2,
            Self::Linear => |value| value,
        };
        (along(value) - along(low)) / (along(high) - along(low))
    }

    /// Returns the ticks from `low` to a greater `high`, on a logarithmic scale at least 1 % above:
    /// labels at least the fraction `min_gap`, up to 0.14, of the scale's length apart.
    pub fn ticks(self, [low, high]: [f64; 2], min_gap: f64) -> Ticks {
        match self {
            Self::Logarithmic => log_ticks(low, high, min_gap),
            // Closer labels are hard to read.
            Self::Linear => linear_ticks(low, high, (high - low) * min_gap.max(0.08)),
        }
    }
}

/// The ticks of a scale, in increasing order and within its ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ticks {
    /// Values with a label.
    pub major: Vec<f64>,
    /// Values without a label; some may also be major ones.
    pub minor: Vec<f64>,
}

impl Ticks {
    /// Splits `values`, in increasing order, into major and minor ticks: a value is labeled if its
    /// `position` along the scale, from 0 to 1, is at least `min_gap` after the last labeled one.
    pub fn spaced(values: &[f64], min_gap: f64, position: impl Fn(f64) -> f64) -> Self {
        let mut ticks = Self::default();
        for &value in values {
            let is_apart = |last: &f64| position(value) - position(*last) >= min_gap;
            if ticks.major.last().is_none_or(is_apart) {
                ticks.major.push(value);
            } else {
                ticks.minor.push(value);
            }
        }
        ticks
    }
}

/// Returns the ticks of a logarithmic scale from `low` to `high`, which is at least 1 % above it:
/// at least two labels, as dense as fits if each needs the fraction `min_gap`, up to 0.14, of the
/// scale's length.
///
/// Labels are at 1, 2 and 5 times a power of ten; on a narrow range, at multiples of such a number;
/// on a wide one, at every power of ten, or every n-th.
fn log_ticks(low: f64, high: f64, min_gap: f64) -> Ticks {
    let min_gap_decades = min_gap * (high / low).log10();
    if min_gap_decades <= 2f64.log10() {
        let major = in_each_decade(&[1.0, 2.0, 5.0], low, high);
        if major.len() >= 3 {
            return Ticks {
                major,
                minor: in_each_decade(&ONE_TO_NINE, low, high),
            };
        }
        return narrow_log_ticks(low, high, min_gap_decades);
    }
    let powers = in_each_decade(&[1.0], low, high);
    if min_gap_decades <= 1.0 {
        return Ticks {
            major: powers,
            minor: in_each_decade(&ONE_TO_NINE, low, high),
        };
    }
    let stride = min_gap_decades.ceil();
    let is_major = |power: &f64| power.log10().round() % stride == 0.0;
    Ticks {
        major: powers.iter().copied().filter(is_major).collect(),
        minor: powers,
    }
}

/// Returns the ticks of a linear scale from `low` to a greater `high`: labels at the multiples of
/// the least number of the form 1, 2 or 5 times a power of ten that is at least `min_step`, which
/// is positive.
fn linear_ticks(low: f64, high: f64, min_step: f64) -> Ticks {
    let power = 10f64.powf(min_step.log10().floor());
    let is_large_enough = |step: &RoundStep| step.size * power >= min_step * (1.0 - TOLERANCE);
    let step = ROUND_STEPS[..4].iter().find(|step| is_large_enough(step));
    step.unwrap_or(&ROUND_STEPS[3]).ticks(power, low, high)
}

/// Relative tolerance of comparisons with a bound, for rounding.
const TOLERANCE: f64 = 1e-9;

const ONE_TO_NINE: [f64; 9] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];

/// A distance between labels, to be scaled by a power of ten.
struct RoundStep {
    size: f64,
    /// Number of minor steps in it.
    n_minor: f64,
}

const ROUND_STEPS: [RoundStep; 6] = [
    RoundStep::new(1.0, 5.0),
    RoundStep::new(2.0, 4.0),
    RoundStep::new(5.0, 5.0),
    RoundStep::new(10.0, 5.0),
    RoundStep::new(20.0, 4.0),
    RoundStep::new(50.0, 5.0),
];

impl RoundStep {
    const fn new(size: f64, n_minor: f64) -> Self {
        Self { size, n_minor }
    }

    /// Returns labels at the multiples of this step times `power`.
    fn ticks(&self, power: f64, low: f64, high: f64) -> Ticks {
        let step = self.size * power;
        Ticks {
            major: multiples(step, low, high),
            minor: multiples(step / self.n_minor, low, high),
        }
    }
}

/// Returns the ticks of a logarithmic scale of less than a decade, in equal steps: at most seven
/// labels, spaced for the high end, where they are closest.
fn narrow_log_ticks(low: f64, high: f64, min_gap_decades: f64) -> Ticks {
    let smallest = 10f64.powf((high - low).log10().floor() - 1.0);
    let mut ticks = Ticks::default();
    for step in &ROUND_STEPS {
        let wider = step.ticks(smallest, low, high);
        if wider.major.len() < 2 {
            break;
        }
        ticks = wider;
        let is_apart = |pair: &[f64]| (pair[1] / pair[0]).log10() >= min_gap_decades;
        if ticks.major.len() <= 7 && ticks.major.windows(2).all(is_apart) {
            break;
        }
    }
    ticks
}

/// Returns each factor times each power of ten from `low`, above 0, to `high`.
fn in_each_decade(factors: &[f64], low: f64, high: f64) -> Vec<f64> {
    let is_within =
        |value: &f64| *value >= low * (1.0 - TOLERANCE) && *value <= high * (1.0 + TOLERANCE);
    let exponents = low.log10().floor() as i32..=high.log10().floor() as i32;
    let powers = exponents.map(|exponent| 10f64.powi(exponent));
    powers
        .flat_map(|power| factors.iter().map(move |factor| factor * power))
        .filter(is_within)
        .collect()
}

/// Returns each multiple of `step` from `low` to `high`.
fn multiples(step: f64, low: f64, high: f64) -> Vec<f64> {
    let tolerance = TOLERANCE * low.abs().max(high) / step;
    let first = (low / step - tolerance).ceil() as i64;
    let last = (high / step + tolerance).floor() as i64;
    (first..=last).map(|i| i as f64 * step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn major_ticks_of_typical_ranges() {
        let narrow = [3e2, 3.5e2, 4e2, 4.5e2, 5e2, 5.5e2];
        let (third, root) = ([3e2, 4e2, 5e2, 6e2, 7e2, 8e2, 9e2], 2f64.sqrt());
        let decades: Vec<f64> = (0..10).map(|exponent| 10f64.powi(exponent)).collect();
        let table: [([f64; 3], &[f64]); 9] = [
            ([1e2, 1e4, 0.04], &[1e2, 2e2, 5e2, 1e3, 2e3, 5e3, 1e4]),
            ([130.0, 9e3, 0.04], &[2e2, 5e2, 1e3, 2e3, 5e3]),
            ([1.0, 10.0, 0.04], &[1.0, 2.0, 5.0, 10.0]),
            ([210.0, 990.0, 0.04], &third),
            ([412.0 / root, 412.0 * root, 0.04], &narrow),
            ([1e2, 102.0, 0.04], &[1e2, 100.5, 101.0, 101.5, 102.0]),
            ([1.0, 1e9, 0.04], &decades),
            ([20.0, 3e3, 0.13], &[20.0, 50.0, 1e2, 2e2, 5e2, 1e3, 2e3]),
            ([1.0, 1e9, 0.14], &[1.0, 1e2, 1e4, 1e6, 1e8]),
        ];
        for ([low, high, min_gap], expected) in table {
            let got = log_ticks(low, high, min_gap).major;
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
        let ticks = |reach: f64, min_gap| Scale::Linear.ticks([-reach, reach], min_gap).major;
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
                    let Ticks { major, minor } = log_ticks(low, high, min_gap);
                    let is_within = |v: f64| v >= low * (1.0 - 2e-9) && v <= high * (1.0 + 2e-9);
                    let context = format!("{low} to {high}, gap {min_gap}: {major:?}");
                    assert!(major.len() >= 2, "{context}");
                    assert!(
                        [&major, &minor]
                            .iter()
                            .all(|t| t.iter().all(|&v| is_within(v))),
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
