//! Color scales and axes of ParaView: a formula over an array, a title with a unit, a range and a
//! few labels.

use serde::{Deserialize, Serialize};

use super::color_points::color_points;
use super::template::StateValue;
use crate::chart::{Scale, Ticks};

/// The scale of colors or of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ColorScale {
    /// For positive values.
    Logarithmic,
    /// Linear, from any value to a greater one.
    Linear,
    /// Linear and symmetric around zero, from `-high` to `high`.
    Diverging,
}

/// An array of a file that determines colors or positions along an axis.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(from = "StoredAxis", into = "StoredAxis")]
pub struct Axis {
    /// The array's name in the file.
    array: String,
    name: String,
    unit: Option<TimeUnit>,
    scale: ColorScale,
    /// The value at the low end, in the unit shown.
    low: f64,
    /// The value at the high end, in the unit shown.
    high: f64,
    /// Maximum number of labels.
    n_labels: usize,
}

/// An axis as `summary.json` stores it.
#[derive(Serialize, Deserialize)]
struct StoredAxis {
    array: String,
    name: String,
    is_time: bool,
    scale: ColorScale,
    /// Both ends, in the array's own unit.
    ends: [f64; 2],
    n_labels: usize,
}

/// A unit of times, which files store in nanoseconds.
#[derive(Clone, Copy, Debug)]
struct TimeUnit {
    name: &'static str,
    /// The end of a formula that converts from nanoseconds.
    scaled: &'static str,
    /// Nanoseconds per unit.
    ns: f64,
}

/// The units of time, smallest first.
const TIME_UNITS: [TimeUnit; 3] = [
    TimeUnit {
        name: "µs",
        scaled: "*0.001",
        ns: 1e3,
    },
    TimeUnit {
        name: "ms",
        scaled: "*0.000001",
        ns: 1e6,
    },
    TimeUnit {
        name: "s",
        scaled: "*0.000000001",
        ns: 1e9,
    },
];

impl Axis {
    /// Creates an axis of the array's own values, from `low` to `high`, titled `name`.
    pub fn new(array: &str, name: &str, scale: ColorScale, [low, high]: [f64; 2]) -> Self {
        Self {
            array: array.to_owned(),
            name: name.to_owned(),
            unit: None,
            scale,
            low,
            high,
            n_labels: 6,
        }
    }

    /// Converts from nanoseconds to the largest unit in which the middle of the axis is at least
    /// 0.1, or to µs if there is none.
    pub fn in_time_unit(self) -> Self {
        let middle = match self.scale {
            ColorScale::Logarithmic => (self.low * self.high).sqrt(),
            ColorScale::Linear | ColorScale::Diverging => 0.5 * self.high,
        };
        let fits = |unit: &&TimeUnit| middle >= 0.1 * unit.ns;
        let unit = TIME_UNITS.iter().rfind(fits).unwrap_or(&TIME_UNITS[0]);
        Self {
            unit: Some(*unit),
            low: self.low / unit.ns,
            high: self.high / unit.ns,
            ..self
        }
    }

    /// Returns the axis that spans both.
    pub fn spanning(&self, other: &Self) -> Self {
        let [a, b] = [self, other].map(|axis| StoredAxis::from(axis.clone()));
        let ends = [a.ends[0].min(b.ends[0]), a.ends[1].max(b.ends[1])];
        StoredAxis { ends, ..a }.into()
    }

    /// Sets the maximum number of labels.
    pub fn with_labels(self, n_labels: usize) -> Self {
        Self { n_labels, ..self }
    }

    /// Returns the value of a template's key without the prefix of this axis, such as `title` or
    /// `colors(inferno)`; `None` for an unknown key.
    pub fn value(&self, key: &str) -> Option<StateValue> {
        let log10_of_ends = || [self.low, self.high].map(f64::log10);
        let number = match key {
            "array" => return Some(self.array.clone().into()),
            "formula" => return Some(self.formula().into()),
            "title" => return Some(self.title().into()),
            "labels" => return Some(StateValue::Many(self.labels(|value| value))),
            // Zeros, whose logarithm ParaView would replace by that of 1, count at the low end.
            "log10.formula" => {
                return Some(format!("log10(max({},{}))", self.formula(), self.low).into());
            }
            "log10.title" => return Some(format!("{}, log scale", self.title()).into()),
            "log10.labels" => return Some(StateValue::Many(self.labels(f64::log10))),
            _ => match key.split_once('(')? {
                ("colors", map) => {
                    let points = color_points(map.strip_suffix(')')?, |f| self.at(f));
                    return points.map(StateValue::Many);
                }
                ("at", f) => between(f, |f| self.at(f)),
                ("log10", f) => {
                    let [low, high] = log10_of_ends();
                    between(f, |f| low + (high - low) * f)
                }
                _ => None,
            },
        };
        Some(number?.to_string().into())
    }

    /// Returns the value at a fraction, from 0 to 1, of the axis.
    fn at(&self, fraction: f64) -> f64 {
        match self.scale {
            ColorScale::Logarithmic => self.low * (self.high / self.low).powf(fraction),
            ColorScale::Linear | ColorScale::Diverging => {
                self.low + (self.high - self.low) * fraction
            }
        }
    }

    fn formula(&self) -> String {
        let scaled = self.unit.map_or("", |unit| unit.scaled);
        format!("{}{scaled}", self.array)
    }

    fn title(&self) -> String {
        match self.unit {
            Some(unit) => format!("{} ({})", self.name, unit.name),
            None => self.name.clone(),
        }
    }

    /// Returns the `position` and the text of each label alternately, as ParaView stores
    /// annotations: of the round values, and of the ends that are apart from these.
    fn labels(&self, position: impl Fn(f64) -> f64) -> Vec<String> {
        let (scale, ends) = self.scale_and_ends();
        let ticks = self.ticks();
        let min_gap = 0.6 / (self.n_labels as f64 - 0.5);
        let at = |value: f64| scale.position(value, ends);
        let is_far = |end: f64, tick: f64| (at(end) - at(tick)).abs() >= min_gap;
        let is_apart = |end: &f64| ticks.iter().all(|tick| is_far(*end, *tick));
        let label = |value: f64, shown| [position(value).to_string(), label_text(shown)];
        let round = ticks.iter().map(|&value| label(value, value));
        let ends = ends.into_iter().filter(is_apart);
        let labels = round.chain(ends.map(|end| label(end, two_digits(end))));
        labels.flatten().collect()
    }

    /// Returns how values lie along the axis, and the values at both ends.
    fn scale_and_ends(&self) -> (Scale, [f64; 2]) {
        match self.scale {
            ColorScale::Logarithmic => (Scale::Logarithmic, [self.low, self.high]),
            ColorScale::Linear => (Scale::Linear, [self.low, self.high]),
            ColorScale::Diverging => (Scale::Linear, [-self.high, self.high]),
        }
    }

    /// Returns at most `n_labels` round values between the ends.
    fn ticks(&self) -> Vec<f64> {
        let (scale, ends) = self.scale_and_ends();
        match self.scale {
            ColorScale::Logarithmic => self.log_ticks(),
            ColorScale::Linear => {
                // Values without a unit are counts.
                let min_step = if self.unit.is_none() { 1.0 } else { 0.0 };
                let min_gap =
                    (min_step / (self.high - self.low)).max(1.0 / (self.n_labels as f64 - 1.0));
                scale.ticks(ends, min_gap).major
            }
            ColorScale::Diverging => scale.ticks(ends, 0.17).major,
        }
    }

    /// Returns round values no denser than `n_labels` labels allow; possibly more than
    /// [`Scale::ticks`] keeps.
    fn log_ticks(&self) -> Vec<f64> {
        let min_gap = 1.0 / (self.n_labels as f64 - 0.5);
        let (scale, ends) = self.scale_and_ends();
        let ticks = scale.ticks(ends, min_gap.min(0.14)).major;
        Ticks::spaced(&ticks, min_gap, |value| scale.position(value, ends)).major
    }
}

impl From<StoredAxis> for Axis {
    fn from(stored: StoredAxis) -> Self {
        let StoredAxis {
            array,
            name,
            scale,
            ends,
            ..
        } = stored;
        let axis = Self::new(&array, &name, scale, ends).with_labels(stored.n_labels);
        if stored.is_time {
            axis.in_time_unit()
        } else {
            axis
        }
    }
}

impl From<Axis> for StoredAxis {
    fn from(axis: Axis) -> Self {
        let ns = axis.unit.map_or(1.0, |unit| unit.ns);
        Self {
            is_time: axis.unit.is_some(),
            scale: axis.scale,
            ends: [axis.low, axis.high].map(|end| end * ns),
            n_labels: axis.n_labels,
            array: axis.array,
            name: axis.name,
        }
    }
}

/// Formats a round number for a narrow color bar, without a space, and with "k" only from 10,000:
/// "0.05", "2000", "20k", "−3".
fn label_text(value: f64) -> String {
    let size = value.abs();
    let (size, suffix) = match size {
        1e10.. => return format!("{value:.1e}"),
        1e9.. => (size / 1e9, "G"),
        1e6.. => (size / 1e6, "M"),
        1e4.. => (size / 1e3, "k"),
        _ => (size, ""),
    };
    if size > 0.0 && size < 1e-4 {
        return format!("{value:.1e}");
    }
    let rounded: f64 = format!("{size:.3e}").parse().unwrap_or(size);
    let sign = if value < 0.0 { "−" } else { "" };
    format!("{sign}{rounded}{suffix}")
}

/// Rounds to two digits.
fn two_digits(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}

/// Interpolates at the fraction, from 0 to 1, at the start of `0.5)`, the rest of a key such as
/// `at(0.5)`; `None` unless it is a number and a closing parenthesis.
pub fn between(fraction: &str, interpolate: impl Fn(f64) -> f64) -> Option<f64> {
    Some(interpolate(fraction.strip_suffix(')')?.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(axis: &Axis) -> Vec<String> {
        axis.labels(|value| value)
            .into_iter()
            .skip(1)
            .step_by(2)
            .collect()
    }

    fn axis(scale: ColorScale, ends: [f64; 2]) -> Axis {
        Axis::new("time_ns", "Time", scale, ends)
    }

    #[test]
    fn times_are_in_a_unit_that_fits() {
        for (high, title, formula) in [
            (300.0, "Time (µs)", "time_ns*0.001"),
            (2e5, "Time (µs)", "time_ns*0.001"),
            (3e6, "Time (ms)", "time_ns*0.000001"),
            (2e9, "Time (s)", "time_ns*0.000000001"),
        ] {
            let axis = axis(ColorScale::Logarithmic, [0.1 * high, high]).in_time_unit();
            assert_eq!(
                (axis.title().as_str(), axis.formula().as_str()),
                (title, formula)
            );
        }
    }

    #[test]
    fn labels_are_round_but_for_ends_apart_from_them() {
        let log = axis(ColorScale::Logarithmic, [52.0, 1900.0]).in_time_unit();
        assert_eq!(texts(&log), ["0.1", "0.2", "0.5", "1", "0.052", "1.9"]);
        assert_eq!(
            texts(&axis(ColorScale::Linear, [0.0, 23.4])),
            ["0", "5", "10", "15", "20", "23"]
        );
        let around = axis(ColorScale::Diverging, [-712.0, 712.0]);
        assert_eq!(texts(&around), ["−500", "0", "500", "−710", "710"]);
        let wide = axis(ColorScale::Logarithmic, [1.0, 1e9]);
        assert_eq!(texts(&wide), ["1", "100", "10k", "1M", "100M", "1G"]);
        // No room at the low end.
        let full = axis(ColorScale::Logarithmic, [0.9, 1900.0]);
        assert_eq!(texts(&full), ["1", "10", "100", "1000"]);
    }

    #[test]
    fn no_axis_has_more_than_six_labels_or_close_ones() {
        for n_labels in [4, 6] {
            for i in 0..600 {
                let low = 10f64.powf(f64::from(i) * 0.013 - 2.0);
                for ratio in [1.01, 1.3, 3.0, 17.0, 400.0, 1e7] {
                    for scale in [ColorScale::Logarithmic, ColorScale::Linear] {
                        let axis = axis(scale, [low, low * ratio])
                            .in_time_unit()
                            .with_labels(n_labels);
                        let [low, high] = [axis.low, axis.high];
                        let ticks = axis.ticks();
                        assert!((1..=n_labels).contains(&ticks.len()), "{axis:?}: {ticks:?}");
                        let is_within = |t: &f64| *t >= low * 0.999_999 && *t <= high * 1.000_001;
                        assert!(ticks.iter().all(is_within), "{axis:?}: {ticks:?}");
                    }
                }
            }
        }
    }
}
