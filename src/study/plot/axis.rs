//! An axis of a plot: positions of values, and ticks.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

use crate::chart::{Ticks, ticks};
use crate::study::AxisScale;

/// Length of a label as a share of a logarithmic axis.
const LABEL_GAP: f64 = 0.12;
/// Minimum distance between two labeled levels as a share of the axis.
const LEVEL_GAP: f64 = 0.07;

/// An axis of a plot.
pub(super) struct PlotAxis {
    /// The value at the left or lower end.
    pub(super) low: f64,
    /// The value at the right or upper end.
    pub(super) high: f64,
    scale: AxisScale,
    /// Names of the positions 0, 1, …; empty for a numeric axis.
    names: Vec<String>,
    /// Values with tick labels, ascending; empty for automatic ticks.
    levels: Vec<f64>,
}

impl PlotAxis {
    /// An axis around these values, at least one, with margins at both ends.
    pub(super) fn around(values: impl Iterator<Item = f64>, scale: AxisScale) -> Self {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        let (low, high) = match scale {
            AxisScale::Log => {
                let room = (high / low).powf(0.08).max(1.2);
                (low / room, high * room)
            }
            AxisScale::Linear => (low.min(0.0), high + 0.08 * (high - low.min(0.0)).max(1e-9)),
        };
        Self {
            low,
            high,
            scale,
            names: Vec::new(),
            levels: Vec::new(),
        }
    }

    /// The same axis with tick labels at these values where there is room.
    pub(super) fn with_levels(mut self, mut levels: Vec<f64>) -> Self {
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        self.levels = levels;
        self
    }

    /// An axis of named positions.
    pub(super) fn of_names(names: &[String]) -> Self {
        Self {
            low: -0.5,
            high: names.len() as f64 - 0.5,
            scale: AxisScale::Linear,
            names: names.to_vec(),
            levels: Vec::new(),
        }
    }

    /// Major ticks, with labels, and minor ones.
    fn ticks(&self) -> Ticks {
        if !self.names.is_empty() {
            let major = (0..self.names.len()).map(|place| place as f64).collect();
            return Ticks {
                major,
                minor: Vec::new(),
            };
        }
        if self.levels.len() > 1 {
            return self.ticks_at_levels();
        }
        match self.scale {
            AxisScale::Log => ticks(self.low, self.high, LABEL_GAP),
            AxisScale::Linear => Ticks {
                major: even_steps(self.low, self.high),
                minor: Vec::new(),
            },
        }
    }

    /// A major tick for each level that is far enough from the one before.
    fn ticks_at_levels(&self) -> Ticks {
        let mut major: Vec<f64> = Vec::new();
        let mut minor = Vec::new();
        for &level in &self.levels {
            let is_far = |last: &f64| self.share(level) - self.share(*last) >= LEVEL_GAP;
            if major.last().is_none_or(is_far) {
                major.push(level);
            } else {
                minor.push(level);
            }
        }
        Ticks { major, minor }
    }

    /// The position of a value on the axis, from 0 to 1.
    fn share(&self, value: f64) -> f64 {
        match self.scale {
            AxisScale::Log => (value / self.low).ln() / (self.high / self.low).ln(),
            AxisScale::Linear => (value - self.low) / (self.high - self.low),
        }
    }
}

/// Multiples of 1, 2 or 5 times a power of ten, at most eight.
fn even_steps(low: f64, high: f64) -> Vec<f64> {
    let power = 10_f64.powf(((high - low) / 8.0).log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power);
    let step = steps.into_iter().find(|step| (high - low) / step <= 8.0);
    let step = step.unwrap_or(high - low);
    let first = (low / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    (first..=last).map(|i| i as f64 * step).collect()
}

impl Ranged for PlotAxis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (begin, end): (i32, i32)) -> i32 {
        begin + (self.share(*value) * f64::from(end - begin)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        let ticks = self.ticks();
        if hint.weight().allow_light_points() {
            ticks.major.into_iter().chain(ticks.minor).collect()
        } else {
            ticks.major
        }
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for PlotAxis {
    fn format_ext(&self, value: &f64) -> String {
        match self.names.get(*value as usize) {
            Some(name) => name.clone(),
            None => short_number(*value),
        }
    }
}

/// A number with at most three decimals and an SI prefix, such as "20 k" for 20,000.
pub(super) fn short_number(value: f64) -> String {
    let units = [(1e12, "T"), (1e9, "G"), (1e6, "M"), (1e3, "k")];
    let unit = units
        .into_iter()
        .find(|(unit, _)| value.abs() >= 0.999 * unit);
    let (unit, name) = unit.unwrap_or((1.0, ""));
    let digits = format!("{:.3}", value / unit);
    let digits = digits.trim_end_matches('0').trim_end_matches('.');
    match name {
        "" => digits.to_owned(),
        name => format!("{digits} {name}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_prefixes() {
        let names = [0.0, 0.05, 7.0, 1500.0, 2e6].map(short_number);
        assert_eq!(names, ["0", "0.05", "7", "1.5 k", "2 M"]);
    }

    #[test]
    fn steps_are_round_and_few() {
        assert_eq!(
            even_steps(0.0, 7.3),
            [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]
        );
        assert_eq!(
            even_steps(0.0, 0.9),
            [0.0, 0.2, 0.4, 0.6, 0.8].map(|x: f64| (x / 0.2).round() * 0.2)
        );
    }

    #[test]
    fn a_log_axis_has_equal_ratios_at_equal_distances() {
        let axis = PlotAxis {
            low: 1.0,
            high: 10_000.0,
            scale: AxisScale::Log,
            names: Vec::new(),
            levels: Vec::new(),
        };
        let places = [1.0, 10.0, 100.0, 1000.0, 10_000.0].map(|value| axis.map(&value, (0, 400)));
        assert_eq!(places, [0, 100, 200, 300, 400]);
    }

    #[test]
    fn levels_have_labels_where_there_is_room() {
        let axis = PlotAxis::around([1.0, 1000.0].into_iter(), AxisScale::Log);
        let ticks = axis.with_levels(vec![1000.0, 1.0, 1.1, 8.0, 1.0]).ticks();
        assert_eq!(ticks.major, [1.0, 8.0, 1000.0]);
        assert_eq!(ticks.minor, [1.1]);
    }
}
