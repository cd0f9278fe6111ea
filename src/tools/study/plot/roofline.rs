//! The roofline plot of a study.
//!
//! If instructions were counted, an instruction roofline: instructions per second over instructions
//! per byte (Williams, Waterman and Patterson, "Roofline", CACM 2009; Ding and Williams, "An
//! Instruction Roofline Model for GPUs", PMBS 2019). If not, rays per second over bytes per ray,
//! with the same bandwidth ceilings.

use serde_json::Value;

use super::figure::{Ceiling, Figure, PlotPoint, factor_label};
use crate::study::point::SETTINGS;
use crate::study::{PowerLaw, RooflinePoint};
use output::chart::short_number;
use render::instruments::MachineLimits;

impl Figure {
    /// Creates the roofline plot: the points, each with a bar for its limit by memory latency, and
    /// the bandwidth of each memory level as a ceiling; `None` without points.
    pub fn roofline(title: &str, points: &[RooflinePoint], limits: &MachineLimits) -> Option<Self> {
        let peak = limits.instructions_per_second.filter(|_| {
            let counted = |point: &RooflinePoint| point.instructions_per_ray.is_some();
            points.iter().all(counted)
        });
        let label = label_factor(points)?;
        let titles = match peak {
            Some(_) => [
                "instructions per byte of the hierarchy",
                "instructions per second and thread",
            ],
            None => [
                "bytes of the hierarchy per ray",
                "rays per second and thread",
            ],
        };
        let [x_title, y_title] = titles.map(str::to_owned);
        let mut figure = Self {
            title: title.to_owned(),
            x_title,
            y_title,
            is_joined: points.iter().all(|point| point.point[label].is_number()),
            ceilings: ceilings(points, limits, peak),
            ..Self::default()
        };
        for point in points {
            let mut plot_point = place_point(point, label, peak.is_some());
            // Points of the same counters in several series coincide: one label is enough.
            let has_same_label = |other: &&PlotPoint| other.label == plot_point.label;
            let same = figure.points().find(has_same_label);
            if same.is_some_and(|other| other.x == plot_point.x) {
                plot_point.label.clear();
            }
            let series = figure.series_of(series_label(point, label));
            series.points.push(plot_point);
        }
        figure.finish(false);
        Some(figure)
    }
}

/// Returns a point in the plot, by its instructions or by its rays.
fn place_point(point: &RooflinePoint, label: &str, by_instructions: bool) -> PlotPoint {
    let bytes = point.bytes_per_ray;
    let per_ray = point.instructions_per_ray.filter(|_| by_instructions);
    let (x, amount) = match per_ray {
        Some(n) => (n / bytes, n),
        None => (bytes, 1.0),
    };
    let per_second = |ns: f64| 1e9 * amount / ns;
    let time = &point.render_ns_per_ray;
    let [low, high] = time.spread();
    PlotPoint {
        x,
        y: per_second(time.median),
        interval: [per_second(high), per_second(low)],
        coverage: time.coverage(),
        is_range: time.interval.is_none(),
        label: point.point.get(label).map(short_text).unwrap_or_default(),
        limit: Some(per_second(time.median * point.latency_share)),
        oversubscribed: false,
    }
}

/// Returns the bandwidth per thread of each memory level, with the maximum number of threads of the
/// points, and the peak rate of instructions.
fn ceilings(points: &[RooflinePoint], limits: &MachineLimits, peak: Option<f64>) -> Vec<Ceiling> {
    let n_threads = points.iter().map(|point| point.n_threads);
    let n_threads = n_threads.fold(1.0, f64::max);
    let levels = limits.levels().into_iter().map(|level| {
        let bandwidth = level.block.bandwidth(n_threads);
        Ceiling {
            label: format!("{} {} GB/s", level.name, two_digits(bandwidth)),
            law: PowerLaw {
                factor: 1e9 * bandwidth,
                exponent: if peak.is_some() { 1.0 } else { -1.0 },
            },
        }
    });
    let flat = peak.map(|per_second| Ceiling {
        label: format!("{} G instructions/s", two_digits(per_second * 1e-9)),
        law: PowerLaw {
            factor: per_second,
            exponent: 0.0,
        },
    });
    levels.chain(flat).collect()
}

/// Returns the factor with the most values, which label the points; the other factors distinguish
/// the series. `None` without points.
fn label_factor(points: &[RooflinePoint]) -> Option<&str> {
    let factors = points.first()?.point.keys();
    let n_values = |factor: &&String| {
        let mut values: Vec<String> = points
            .iter()
            .filter_map(|point| point.point.get(*factor).map(short_text))
            .collect();
        values.sort();
        values.dedup();
        values.len()
    };
    // `max_by_key` takes the last maximum: reversed, that is the first factor.
    factors.rev().max_by_key(n_values).map(String::as_str)
}

/// Returns the values of the other factors, such as "cost time, threads 2".
fn series_label(point: &RooflinePoint, label: &str) -> String {
    let others = point.point.iter();
    let others = others.filter(|(factor, _)| ![label, SETTINGS].contains(&factor.as_str()));
    let labels = others.map(|(factor, value)| factor_label(factor, value, short_text));
    labels.collect::<Vec<_>>().join(", ")
}

/// Returns a text, or a number with an SI prefix.
fn short_text(value: &Value) -> String {
    match (value.as_str(), value.as_f64()) {
        (Some(text), _) => text.to_owned(),
        (None, Some(number)) => short_number(number),
        _ => value.to_string(),
    }
}

fn two_digits(value: f64) -> String {
    if value < 10.0 {
        format!("{value:.1}")
    } else {
        format!("{value:.0}")
    }
}
