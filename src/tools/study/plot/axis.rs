//! An axis of a plot: positions of values, and ticks.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

use crate::study::AxisScale;
use output::chart::{Ticks, linear_ticks, log_ticks, short_number};

/// Length of a label as a share of a logarithmic axis.
const LABEL_GAP: f64 = 0.12;
/// Maximum number of steps between the labels of a linear axis.
const N_STEPS: f64 = 8.0;
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
    /// Creates an axis around these values, at least one, with margins at both ends.
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

    /// Returns the axis with tick labels at these values where there is room.
    pub(super) fn with_levels(mut self, mut levels: Vec<f64>) -> Self {
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        self.levels = levels;
        self
    }

    /// Creates an axis of named positions.
    pub(super) fn of_names(names: &[String]) -> Self {
        Self {
            low: -0.5,
            high: names.len() as f64 - 0.5,
            scale: AxisScale::Linear,
            names: names.to_vec(),
            levels: Vec::new(),
        }
    }

    /// Returns major ticks, with labels, and minor ones.
    fn ticks(&self) -> Ticks {
        if !self.names.is_empty() {
            let major = (0..self.names.len()).map(|place| place as f64).collect();
            return Ticks {
                major,
                minor: Vec::new(),
            };
        }
        if self.levels.len() > 1 {
            return Ticks::spaced(&self.levels, LEVEL_GAP, |level| self.share(level));
        }
        match self.scale {
            AxisScale::Log => log_ticks(self.low, self.high, LABEL_GAP),
            AxisScale::Linear => Ticks {
                minor: Vec::new(),
                ..linear_ticks(self.low, self.high, (self.high - self.low) / N_STEPS)
            },
        }
    }

    /// Returns the position of a value on the axis, from 0 to 1.
    fn share(&self, value: f64) -> f64 {
        match self.scale {
            AxisScale::Log => (value / self.low).ln() / (self.high / self.low).ln(),
            AxisScale::Linear => (value - self.low) / (self.high - self.low),
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_axis_has_few_round_ticks_from_zero() {
        let ticks = |high: f64| PlotAxis::around([high].into_iter(), AxisScale::Linear).ticks();
        assert_eq!(ticks(7.0).major, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        let fifths = [0.0, 1.0, 2.0, 3.0, 4.0].map(|n| n * 0.2);
        assert_eq!(ticks(0.9).major, fifths);
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
