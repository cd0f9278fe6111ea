//! The points of a study under the machine's limits.
//!
//! Where instructions were counted, an instruction roofline: instructions a
//! second over instructions a byte (Williams, Waterman and Patterson,
//! "Roofline", CACM 2009; Ding and Williams, "An Instruction Roofline Model for
//! GPUs", PMBS 2019). Where they were not, the same limits of bandwidth over
//! what is known without them: rays a second over bytes a ray.

use serde_json::Value;

use super::figure::{Ceiling, Figure, Mark, Scale};
use super::{Limits, PowerLaw, Standing};

impl Figure {
    /// The points as marks, a bar over each for the latency of memory, and the
    /// bandwidth of each level as a line; `None` without points.
    pub fn roofline(title: &str, standings: &[Standing], limits: &Limits) -> Option<Self> {
        let peak = limits.instructions_per_second.filter(|_| {
            let counted = |standing: &Standing| standing.instructions_per_ray.is_some();
            standings.iter().all(counted)
        });
        let label = labelling(standings)?;
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
            scale: Scale::Log,
            categories: Vec::new(),
            series: Vec::new(),
            is_joined: standings
                .iter()
                .all(|standing| standing.point[label].is_number()),
            has_levels: false,
            ceilings: ceilings(standings, limits, peak),
        };
        for standing in standings {
            let mut mark = mark(standing, label, peak.is_some());
            // Series of the same counters lie one over the other: one name will do.
            let of_same_name = |other: &&Mark| other.label == mark.label;
            let mut marks = figure.series.iter().flat_map(|series| &series.points);
            if marks
                .find(of_same_name)
                .is_some_and(|other| other.x == mark.x)
            {
                mark.label.clear();
            }
            let series = figure.series_of(series_label(standing, label));
            series.points.push(mark);
        }
        figure.finish(false);
        Some(figure)
    }
}

/// Where a point lies: by its instructions, or by its rays.
fn mark(standing: &Standing, label: &str, by_instructions: bool) -> Mark {
    let bytes = standing.bytes_per_ray;
    let per_ray = standing.instructions_per_ray.filter(|_| by_instructions);
    let (x, amount) = match per_ray {
        Some(n) => (n / bytes, n),
        None => (bytes, 1.0),
    };
    let per_second = |ns: f64| 1e9 * amount / ns;
    let time = &standing.render_ns_per_ray;
    Mark {
        x,
        y: per_second(time.median),
        interval: [per_second(time.high_95), per_second(time.low_95)],
        label: standing.point.get(label).map(name).unwrap_or_default(),
        limit: Some(per_second(time.median * standing.latency_share)),
        oversubscribed: false,
    }
}

/// The bandwidth of each level, as a thread has it with as many at work as the
/// points had at most, and the peak of instructions.
fn ceilings(standings: &[Standing], limits: &Limits, peak: Option<f64>) -> Vec<Ceiling> {
    let n_threads = standings.iter().map(|standing| standing.n_threads);
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

/// The factor of most values, whose value stands beside each mark; the others
/// tell series apart. `None` without points.
fn labelling(standings: &[Standing]) -> Option<&str> {
    let factors = standings.first()?.point.keys();
    let n_values = |factor: &&String| {
        let mut values: Vec<String> = standings
            .iter()
            .filter_map(|standing| standing.point.get(*factor).map(name))
            .collect();
        values.sort();
        values.dedup();
        values.len()
    };
    // Of several the first one, the scene.
    factors.rev().max_by_key(n_values).map(String::as_str)
}

/// "cost time, threads 2": the other factors.
fn series_label(standing: &Standing, label: &str) -> String {
    let others = standing.point.iter().filter(|(factor, _)| *factor != label);
    let named = others.map(|(factor, value)| match factor.as_str() {
        "scene" => name(value),
        _ => format!("{} {}", factor.replace('_', " "), name(value)),
    });
    named.collect::<Vec<_>>().join(", ")
}

/// The text or the number, a large one shortly.
fn name(value: &Value) -> String {
    match (value.as_str(), value.as_f64()) {
        (Some(text), _) => text.to_owned(),
        (None, Some(number)) => super::axis::short(number),
        _ => value.to_string(),
    }
}

fn two_digits(value: f64) -> String {
    match value < 10.0 {
        true => format!("{value:.1}"),
        false => format!("{value:.0}"),
    }
}
