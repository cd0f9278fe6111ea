//! The content of a plot: rows of statistics as series of points.

use serde_json::Value;

use super::series_factors::series_factors;
use crate::study::factor_level::{size_of_level, text_of};
use crate::study::step_rows::STEP_TIME;
use crate::study::{CostLaw, CostSample, FlagFactor, PlotSpec, PowerLaw, StatisticsRow};
use output::chart::{Scale, rounded_number};

/// The content of a plot.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Figure {
    /// Title above the axes.
    pub title: String,
    /// Title of the horizontal axis.
    pub x_title: String,
    /// Title of the vertical axis.
    pub y_title: String,
    /// Scale of both axes.
    pub scale: Scale,
    /// Names of the horizontal positions 0, 1, …; empty for a numeric axis.
    pub categories: Vec<String>,
    /// True if the categories stand below each other, each with a horizontal bar.
    pub has_bars: bool,
    /// The series, at least one.
    pub series: Vec<Series>,
    /// True if a line joins the points of a series without a law.
    pub is_joined: bool,
    /// True if the horizontal positions are levels of a factor; then each has a tick label where
    /// there is room.
    pub has_levels: bool,
    /// Upper limits.
    pub ceilings: Vec<Ceiling>,
}

/// An upper limit over the whole horizontal axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Ceiling {
    /// The label at one end of the line.
    pub label: String,
    /// The line.
    pub law: PowerLaw,
}

/// Points of one kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// The values that its points have in common; empty if there is only one series.
    pub label: String,
    /// The points from left to right.
    pub points: Vec<PlotPoint>,
    /// The law fitted to all points that are not oversubscribed.
    pub law: Option<CostLaw>,
}

/// A median with its confidence interval.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlotPoint {
    /// Horizontal position.
    pub x: f64,
    /// Median.
    pub y: f64,
    /// Ends of the 95 % confidence interval of `y`, or of the range of all runs.
    pub interval: [f64; 2],
    /// The probability that the interval covers the true median.
    pub coverage: f64,
    /// True if the interval is the range of all runs, which are too few for a confidence interval.
    pub is_range: bool,
    /// Label beside the point; may be empty.
    pub label: String,
    /// Upper limit of only this point, drawn as a bar.
    pub limit: Option<f64>,
    /// True if the runs had more threads than there are processors.
    pub oversubscribed: bool,
}

impl Series {
    /// Returns the points that a law can be fitted to: all that are not oversubscribed; none if one
    /// of them is not positive.
    pub fn samples(&self) -> Vec<CostSample> {
        let fitted = self.points.iter().filter(|point| !point.oversubscribed);
        let sample = |point: &PlotPoint| CostSample {
            n: point.x,
            cost: point.y,
            interval: point.interval,
            coverage: point.coverage,
        };
        let samples: Vec<CostSample> = fitted.map(sample).collect();
        let is_positive = |sample: &CostSample| sample.n > 0.0 && sample.cost > 0.0;
        if samples.iter().all(is_positive) {
            samples
        } else {
            Vec::new()
        }
    }
}

impl Figure {
    /// Plots these rows; `None` if no row has the metrics.
    pub fn new(plot: &PlotSpec, title: &str, rows: &[StatisticsRow]) -> Option<Self> {
        let y_titles: Vec<String> = plot.y.iter().map(|y| axis_title(y)).collect();
        let mut figure = Self {
            title: title.to_owned(),
            x_title: match FlagFactor::ImageSize.name() {
                size if plot.fit && plot.x == size => "image size (pixels)".to_owned(),
                _ => axis_title(&plot.x),
            },
            y_title: y_titles.join(", "),
            scale: plot.scale,
            has_bars: plot.bars,
            has_levels: rows.iter().any(|row| row.point.contains_key(&plot.x)),
            ..Self::default()
        };
        let metric = plot.y.first()?;
        let by = plot.by.clone();
        let by = by.unwrap_or_else(|| series_factors(&plot.x, metric, rows));
        for row in rows.iter().filter(|row| plot.y.contains(&row.metric)) {
            let Some(x) = figure.x_of(plot, row, rows) else {
                continue;
            };
            let statistics = &row.statistics;
            let point = PlotPoint {
                x,
                y: statistics.median,
                interval: statistics.spread(),
                coverage: statistics.coverage(),
                is_range: statistics.interval.is_none(),
                label: if plot.bars {
                    bar_label(row, rows)
                } else {
                    String::new()
                },
                oversubscribed: row.oversubscribed,
                limit: None,
            };
            figure.series_of(label_of_row(row, &by)).points.push(point);
        }
        figure.is_joined = figure.categories.is_empty();
        figure.has_bars &= !figure.is_joined;
        figure.finish(plot.fit);
        (!figure.series.is_empty()).then_some(figure)
    }

    /// Plots a line through points from left to right, with the titles of both axes.
    pub fn line(
        title: &str,
        [x_title, y_title]: [&str; 2],
        points: impl Iterator<Item = [f64; 2]>,
    ) -> Self {
        let point = |[x, y]: [f64; 2]| PlotPoint {
            x,
            y,
            interval: [y; 2],
            ..PlotPoint::default()
        };
        Self {
            title: title.to_owned(),
            x_title: x_title.to_owned(),
            y_title: y_title.to_owned(),
            scale: Scale::Linear,
            series: vec![Series {
                label: String::new(),
                points: points.map(point).collect(),
                law: None,
            }],
            is_joined: true,
            ..Self::default()
        }
    }

    /// Shortens the labels, sorts the points, fits a law to each series if `fit`, and selects a
    /// linear scale if a value is not positive.
    pub(super) fn finish(&mut self, fit: bool) {
        self.remove_common_label_parts();
        let has_categories = !self.categories.is_empty();
        for series in &mut self.series {
            series.points.sort_by(|a, b| a.x.total_cmp(&b.x));
            if fit && !has_categories {
                series.law = CostLaw::fit(&series.samples());
            }
        }
        let is_positive =
            |point: &PlotPoint| (has_categories || point.x > 0.0) && point.interval[0] > 0.0;
        if !self.points().all(is_positive) {
            self.scale = Scale::Linear;
        }
    }

    /// Returns the points of all series.
    pub(super) fn points(&self) -> impl Iterator<Item = &PlotPoint> {
        self.series.iter().flat_map(|series| &series.points)
    }

    /// Returns the series with this label; adds it if it is new.
    pub(super) fn series_of(&mut self, label: String) -> &mut Series {
        let known = self.series.iter().position(|series| series.label == label);
        let index = known.unwrap_or_else(|| {
            self.series.push(Series {
                label,
                points: Vec::new(),
                law: None,
            });
            self.series.len() - 1
        });
        &mut self.series[index]
    }

    /// Returns the horizontal position of a row's point; `None` if its metric is missing. A text
    /// becomes a category.
    fn x_of(
        &mut self,
        plot: &PlotSpec,
        row: &StatisticsRow,
        rows: &[StatisticsRow],
    ) -> Option<f64> {
        let Some(value) = row.point.get(&plot.x) else {
            let is_x = |other: &&StatisticsRow| other.metric == plot.x && other.point == row.point;
            return rows.iter().find(is_x).map(|row| row.statistics.median);
        };
        let number = if plot.fit {
            size_of_level(value)
        } else {
            value.as_f64()
        };
        if number.is_some() {
            return number;
        }
        let name = text_of(value);
        let known = self.categories.iter().position(|known| *known == name);
        let position = known.unwrap_or_else(|| {
            self.categories.push(name);
            self.categories.len() - 1
        });
        Some(position as f64)
    }

    /// Removes the parts that the labels of all series have in common.
    fn remove_common_label_parts(&mut self) {
        let parts = |series: &Series| -> Vec<String> {
            series.label.split(", ").map(str::to_owned).collect()
        };
        let all: Vec<Vec<String>> = self.series.iter().map(parts).collect();
        for (series, own) in self.series.iter_mut().zip(&all) {
            let differs = |part: &&String| !all.iter().all(|parts| parts.contains(part));
            let kept: Vec<&str> = own.iter().filter(differs).map(String::as_str).collect();
            series.label = kept.join(", ");
        }
    }
}

/// Returns the label of a row's series: the values of the factors in `by` and the metric, such as
/// "threads 2, cost time, render wall (ms)".
fn label_of_row(row: &StatisticsRow, by: &[String]) -> String {
    let values = row.point.iter().filter(|(factor, _)| by.contains(factor));
    let factors = values.map(|(factor, value)| factor_label(factor, value, text_of));
    factors
        .chain([axis_title(&row.metric)])
        .collect::<Vec<_>>()
        .join(", ")
}

/// Returns the label of a factor's value, such as "tile size 8"; for a scene only its name.
pub(super) fn factor_label(factor: &str, value: &Value, text: fn(&Value) -> String) -> String {
    match factor {
        "scene" => text(value),
        _ => format!("{} {}", factor.replace('_', " "), text(value)),
    }
}

/// Returns the label of a bar: the value, or for the time of a step its speedups, such as "4.1 x,
/// 820 x in all".
fn bar_label(row: &StatisticsRow, rows: &[StatisticsRow]) -> String {
    let speedup = |metric: &str| {
        let is_it = |other: &&StatisticsRow| other.metric == metric && other.point == row.point;
        let found = rows.iter().find(is_it)?;
        Some(format!("{} x", rounded_number(found.statistics.median)))
    };
    if row.metric != STEP_TIME {
        return rounded_number(row.statistics.median);
    }
    let both = speedup("speedup_over_step").zip(speedup("speedup_over_start"));
    both.map_or(String::new(), |(step, start)| {
        format!("{step}, {start} in all")
    })
}

/// Returns the title of an axis: "render wall (ms)" for `render_wall_ms`.
fn axis_title(name: &str) -> String {
    let units = ["ms", "ns", "bytes"];
    match name.rsplit_once('_') {
        Some((quantity, unit)) if units.contains(&unit) => {
            format!("{} ({unit})", quantity.replace('_', " "))
        }
        _ => name.replace('_', " "),
    }
}
