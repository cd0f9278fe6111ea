//! Color scales and axes of ParaView states: formula, title with unit, ends, and round
//! labels.

use super::template::StateValue;
use crate::chart::{ticks, ticks_around_zero};

/// The scale of colors or of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ColorScale {
    /// For positive values.
    Logarithmic,
    /// For values from 0 or a least value.
    Linear,
    /// Linear and symmetric around zero, from `-high` to `high`.
    Diverging,
}

/// An array of a file on a color bar or an axis of a plot.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    /// The array's name in the file.
    array: String,
    name: String,
    unit: Option<TimeUnit>,
    scale: ColorScale,
    /// The least value, in the displayed unit.
    low: f64,
    high: f64,
    n_labels: usize,
}

/// A display unit of times, which are in nanoseconds in files.
#[derive(Clone, Copy, Debug)]
struct TimeUnit {
    name: &'static str,
    /// The suffix of a formula that converts nanoseconds into it.
    scaled: &'static str,
    ns: f64,
}

/// In ascending order.
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
    /// Creates the axis of an array with the values of the file and this title.
    pub(crate) fn new(array: &str, name: &str, scale: ColorScale, [low, high]: [f64; 2]) -> Self {
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

    /// Displays times, which are in nanoseconds, in the largest unit in which the
    /// middle of the axis is not small; in µs if there is none.
    pub(crate) fn of_time(self) -> Self {
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

    /// Limits the number of labels.
    pub(crate) fn with_labels(self, n_labels: usize) -> Self {
        Self { n_labels, ..self }
    }

    /// Returns the value of a key without the axis' own prefix.
    pub(crate) fn value(&self, key: &str) -> Option<StateValue> {
        let log10_of_ends = || [self.low, self.high].map(f64::log10);
        let number = match key {
            "array" => return Some(self.array.clone().into()),
            "formula" => return Some(self.formula().into()),
            "title" => return Some(self.title().into()),
            "labels" => return Some(StateValue::Many(self.labels(|value| value))),
            "log10.formula" => return Some(format!("log10({})", self.formula()).into()),
            "log10.title" => return Some(format!("{}, log scale", self.title()).into()),
            "log10.labels" => return Some(StateValue::Many(self.labels(f64::log10))),
            _ => match key.split_once('(')? {
                ("log", f) => between(f, |f| self.low * (self.high / self.low).powf(f)),
                ("linear", f) => between(f, |f| self.low + (self.high - self.low) * f),
                ("log10", f) => {
                    let [low, high] = log10_of_ends();
                    between(f, |f| low + (high - low) * f)
                }
                _ => None,
            },
        };
        Some(number?.to_string().into())
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

    /// Returns positions and texts in alternation.
    fn labels(&self, place: impl Fn(f64) -> f64) -> Vec<String> {
        let labels = self.ticks().into_iter();
        let label = |value| [place(value).to_string(), text(value)];
        labels.flat_map(label).collect()
    }

    /// Returns at most `n_labels` round values between the ends.
    fn ticks(&self) -> Vec<f64> {
        match self.scale {
            ColorScale::Logarithmic => self.log_ticks(),
            ColorScale::Linear => {
                // Values without a unit are counts.
                let least_step = if self.unit.is_some() { 0.0 } else { 1.0 };
                linear_ticks([self.low, self.high], self.n_labels, least_step)
            }
            ColorScale::Diverging => ticks_around_zero(self.high, 0.17).major,
        }
    }

    /// Returns round values, without those that are too close together.
    fn log_ticks(&self) -> Vec<f64> {
        let gap = 1.0 / (self.n_labels as f64 - 0.5);
        let position = |value: f64| (value / self.low).ln() / (self.high / self.low).ln();
        let mut kept: Vec<f64> = Vec::new();
        for tick in ticks(self.low, self.high, gap.min(0.14)).major {
            let is_apart = |last: &f64| position(tick) - position(*last) >= gap;
            if kept.last().is_none_or(is_apart) {
                kept.push(tick);
            }
        }
        kept
    }
}

/// Returns at most `n` multiples of 1, 2 or 5 times a power of ten that have at least
/// this distance.
fn linear_ticks([low, high]: [f64; 2], n: usize, least_step: f64) -> Vec<f64> {
    let least_step = least_step.max((high - low) / (n as f64 - 1.0));
    let power = 10f64.powf(least_step.log10().floor());
    let factors = [1.0, 2.0, 5.0, 10.0].into_iter();
    let mut steps = factors.map(|factor| factor * power);
    let step = steps.find(|step| *step >= least_step * (1.0 - 1e-9));
    let step = step.unwrap_or(least_step);
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last).map(|i| i as f64 * step).collect()
}

/// Formats a label with at most three digits: `0.05`, `200`, `20k`, `−3`.
fn text(value: f64) -> String {
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

/// The interpolated value for the text behind `log(` or `linear(`: a fraction
/// from 0 to 1 and a closing bracket.
pub(crate) fn between(fraction: &str, interpolate: impl Fn(f64) -> f64) -> Option<f64> {
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
            let axis = axis(ColorScale::Logarithmic, [0.1 * high, high]).of_time();
            assert_eq!(
                (axis.title().as_str(), axis.formula().as_str()),
                (title, formula)
            );
        }
    }

    #[test]
    fn labels_are_round() {
        let log = axis(ColorScale::Logarithmic, [52.0, 1900.0]).of_time();
        assert_eq!(texts(&log), ["0.1", "0.2", "0.5", "1"]);
        assert_eq!(
            texts(&axis(ColorScale::Linear, [0.0, 23.0])),
            ["0", "5", "10", "15", "20"]
        );
        let around = axis(ColorScale::Diverging, [-700.0, 700.0]);
        assert_eq!(texts(&around), ["−500", "0", "500"]);
        let wide = axis(ColorScale::Logarithmic, [1.0, 1e9]);
        assert_eq!(texts(&wide), ["1", "100", "10k", "1M", "100M"]);
    }

    #[test]
    fn no_axis_has_more_than_six_labels_or_close_ones() {
        for n_labels in [4, 6] {
            for i in 0..600 {
                let low = 10f64.powf(f64::from(i) * 0.013 - 2.0);
                for ratio in [1.01, 1.3, 3.0, 17.0, 400.0, 1e7] {
                    for scale in [ColorScale::Logarithmic, ColorScale::Linear] {
                        let axis = axis(scale, [low, low * ratio])
                            .of_time()
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
