//! What a plot shows: rows of the table as series of points.

use std::fmt;

use serde::Deserialize;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use serde_json::Value;

use super::{CostLaw, PowerLaw, Row, Sample, apart};

/// A plot, as the study file asks for it.
///
/// ```
/// # use raycost::{study::Plot, yaml};
/// let plot: Plot = yaml::from_str("{ x: threads, y: render_wall_ms, fit: true }").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plot {
    /// A factor, or what was measured, along the lower axis.
    pub x: String,
    /// What was measured, along the left axis: medians with their intervals; one
    /// name or several of one unit.
    #[serde(deserialize_with = "names")]
    pub y: Vec<String>,
    /// The factors that tell series apart; if not given, those without which a
    /// series would have several points at one place.
    #[serde(default)]
    pub by: Option<Vec<String>>,
    /// The axes; logarithmic if not given.
    #[serde(default)]
    pub scale: Scale,
    /// Whether a [`CostLaw`] is drawn through each series.
    #[serde(default)]
    pub fit: bool,
}

/// How values lie on the axes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case", expecting = "`log` or `linear`")]
pub enum Scale {
    /// By their logarithms; where a value is 0, by themselves.
    #[default]
    Log,
    /// By themselves, from 0.
    Linear,
}

/// Series of points, to be drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Above the axes.
    pub title: String,
    /// The lower axis.
    pub x_title: String,
    /// The left axis.
    pub y_title: String,
    /// The axes.
    pub scale: Scale,
    /// Names of the places 0, 1, … along the lower axis, if those are no numbers.
    pub categories: Vec<String>,
    /// At least one.
    pub series: Vec<Series>,
    /// Whether a line joins the points of a series that has no law.
    pub is_joined: bool,
    /// Whether places along the lower axis are levels of a factor, which are all
    /// named where there is room.
    pub has_levels: bool,
    /// Limits that nothing can pass.
    pub ceilings: Vec<Ceiling>,
}

/// A limit along the whole lower axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Ceiling {
    /// What stands beside it.
    pub label: String,
    /// Where it lies.
    pub law: PowerLaw,
}

/// Points of one kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// What they have in common; empty for an only series.
    pub label: String,
    /// From left to right.
    pub points: Vec<Mark>,
    /// A law through them, but for those that are oversubscribed.
    pub law: Option<CostLaw>,
}

/// A median and the interval that holds it.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Place along the lower axis.
    pub x: f64,
    /// Median.
    pub y: f64,
    /// Ends of the interval.
    pub interval: [f64; 2],
    /// What stands beside it; may be empty.
    pub label: String,
    /// A limit of this point's own, drawn as a bar.
    pub limit: Option<f64>,
    /// Whether more threads ran than there are processors.
    pub oversubscribed: bool,
}

impl Mark {
    fn sample(&self) -> Sample {
        Sample {
            n: self.x,
            cost: self.y,
            interval: self.interval,
        }
    }
}

impl Plot {
    /// "threads 2, cost time, render wall (ms)": what tells a row's series apart,
    /// and what was measured.
    fn label(&self, row: &Row, apart: &[String]) -> String {
        let named = |(name, value): (&String, &Value)| match name.as_str() {
            "scene" => text(value),
            _ => format!("{} {}", name.replace('_', " "), text(value)),
        };
        let tells = |(name, _): &(&String, &Value)| apart.contains(name);
        let factors = row.point.iter().filter(tells).map(named);
        let metric = titled(&row.metric);
        factors.chain([metric]).collect::<Vec<_>>().join(", ")
    }
}

impl Figure {
    /// What a plot shows of these rows; `None` if they have nothing of it.
    pub fn of(plot: &Plot, title: &str, rows: &[Row]) -> Option<Self> {
        let mut figure = Self {
            title: title.to_owned(),
            x_title: titled(&plot.x),
            y_title: plot
                .y
                .iter()
                .map(|y| titled(y))
                .collect::<Vec<_>>()
                .join(", "),
            scale: plot.scale,
            categories: Vec::new(),
            series: Vec::new(),
            is_joined: false,
            has_levels: rows.iter().any(|row| row.point.contains_key(&plot.x)),
            ceilings: Vec::new(),
        };
        let metric = plot.y.first()?;
        let apart = plot.by.clone();
        let apart = apart.unwrap_or_else(|| apart::factors(&plot.x, metric, rows));
        for row in rows.iter().filter(|row| plot.y.contains(&row.metric)) {
            let Some(x) = figure.place(plot, row, rows) else {
                continue;
            };
            let statistics = &row.statistics;
            let mark = Mark {
                x,
                y: statistics.median,
                interval: [statistics.low_95, statistics.high_95],
                label: String::new(),
                limit: None,
                oversubscribed: row.oversubscribed,
            };
            figure.series_of(plot.label(row, &apart)).points.push(mark);
        }
        figure.is_joined = figure.categories.is_empty();
        figure.finish(plot.fit);
        (!figure.series.is_empty()).then_some(figure)
    }

    /// Puts labels, points and scale in order, and laws through the points if
    /// they are asked for.
    pub(super) fn finish(&mut self, fit: bool) {
        self.leave_out_what_is_common();
        let has_categories = !self.categories.is_empty();
        for series in &mut self.series {
            series.points.sort_by(|a, b| a.x.total_cmp(&b.x));
            let fitted = series.points.iter().filter(|mark| !mark.oversubscribed);
            let samples: Vec<Sample> = fitted.map(Mark::sample).collect();
            let is_positive = samples.iter().all(|of| of.n > 0.0 && of.cost > 0.0);
            if fit && is_positive && !has_categories {
                series.law = CostLaw::through(&samples);
            }
        }
        self.check_scale(has_categories);
    }

    /// Where a row's point lies along the lower axis.
    fn place(&mut self, plot: &Plot, row: &Row, rows: &[Row]) -> Option<f64> {
        let Some(value) = row.point.get(&plot.x) else {
            let is_it = |other: &&Row| other.metric == plot.x && other.point == row.point;
            return rows.iter().find(is_it).map(|row| row.statistics.median);
        };
        if let Some(number) = value.as_f64() {
            return Some(number);
        }
        let name = text(value);
        let known = self.categories.iter().position(|known| *known == name);
        let place = known.unwrap_or_else(|| {
            self.categories.push(name);
            self.categories.len() - 1
        });
        Some(place as f64)
    }

    /// The series of this label, begun if need be.
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

    /// Shortens the labels by the parts that all series share.
    fn leave_out_what_is_common(&mut self) {
        let parts = |label: &str| label.split(", ").map(str::to_owned).collect::<Vec<_>>();
        let all: Vec<Vec<String>> = self
            .series
            .iter()
            .map(|series| parts(&series.label))
            .collect();
        for (series, own) in self.series.iter_mut().zip(&all) {
            let differs = |part: &&String| !all.iter().all(|parts| parts.contains(part));
            let kept: Vec<&str> = own.iter().filter(differs).map(String::as_str).collect();
            series.label = kept.join(", ");
        }
    }

    /// No logarithms of what is not greater than 0.
    fn check_scale(&mut self, has_categories: bool) {
        let marks = self.series.iter().flat_map(|series| &series.points);
        let is_positive = |mark: &Mark| (has_categories || mark.x > 0.0) && mark.interval[0] > 0.0;
        if !marks.into_iter().all(is_positive) {
            self.scale = Scale::Linear;
        }
    }
}

/// One name or several.
fn names<'de, D: Deserializer<'de>>(d: D) -> Result<Vec<String>, D::Error> {
    d.deserialize_any(NamesVisitor)
}

struct NamesVisitor;

impl<'de> Visitor<'de> for NamesVisitor {
    type Value = Vec<String>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("the name of what was measured, or a list of names")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<Vec<String>, E> {
        Ok(vec![name.to_owned()])
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Vec<String>, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(list))
    }
}

fn text(value: &Value) -> String {
    value
        .as_str()
        .map_or_else(|| value.to_string(), str::to_owned)
}

/// "render_wall_ms" as "render wall (ms)".
fn titled(name: &str) -> String {
    let units = ["ms", "ns", "bytes"];
    match name.rsplit_once('_') {
        Some((what, unit)) if units.contains(&unit) => {
            format!("{} ({unit})", what.replace('_', " "))
        }
        _ => name.replace('_', " "),
    }
}
