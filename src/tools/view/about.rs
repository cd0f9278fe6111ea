//! The JSON that the page's script reads about the rendering.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::cloud::Cloud;
use super::frame::ShownPixels;
use super::hottest;
use base::Keyword;
use base::numbers::{capitalized, counted};
use output::results::LoadedArray;
use output::summary::CameraSection;
use output::summary::{ObjectEntry, Summary};
use scene::config::{Adaptive, CostMode};
use tracer::cost::Metric;
use world::color::{ColorMap, rgb8};

/// Returns the JSON.
pub(super) fn json(
    summary: &Summary,
    pixels: &ShownPixels,
    arrays: &[LoadedArray],
    cloud: &Cloud,
    notes: &[String],
    hottest: Value,
) -> String {
    let array = |(i, array): (usize, &LoadedArray)| {
        json!({
            "id": array_id(i),
            "name": array.name,
            "type": array.values.type_name(),
            "n_components": array.n_components,
        })
    };
    let about = json!({
        "name": summary.scene.name,
        "facts": facts(summary),
        "notes": notes,
        "size": pixels.shown,
        "full_size": pixels.full,
        "origin": summary.image.place().origin,
        "arrays": arrays.iter().enumerate().map(array).collect::<Vec<_>>(),
        "metrics": Metric::with_own(summary.cost.ratio_metrics())
            .map(metric)
            .collect::<Vec<_>>(),
        "hottest": hottest,
        "trace": hottest::trace_command(summary),
        "objects": objects(summary),
        "materials": summary.materials,
        "cloud": { "n": cloud.len(), "n_all": cloud.n_all() },
        "camera": summary.camera.as_ref().map(CameraSection::relative_to_origin),
        "color_maps": {
            "Inferno": color_map(ColorMap::Inferno),
            "Viridis": color_map(ColorMap::Viridis),
        },
    });
    about.to_string()
}

/// Returns a cost metric as the page describes arrays.
fn metric(metric: Metric) -> Value {
    json!({
        "name": metric.name,
        "label": capitalized(metric.label),
        "about": metric.about,
        "log": metric.spans_decades,
    })
}

/// Returns the ID of the frame's array at this position. Names of arrays cannot serve as IDs: they
/// may contain any characters.
pub(super) fn array_id(position: usize) -> String {
    format!("array-{position}")
}

/// Returns a note on values that were not measured; `None` if all were.
pub(super) fn missing(summary: &Summary) -> Option<String> {
    let note = match summary.cost.mode {
        CostMode::SingleRayTime | CostMode::Time => return None,
        CostMode::Counters => "Time was not measured: render again with `--cost time` to see it.",
        CostMode::None => {
            "Cost was not measured: render again without `--no-cost` to see time and counters."
        }
    };
    Some(note.to_owned())
}

/// Returns short facts about the rendering, the most important first.
fn facts(summary: &Summary) -> Vec<String> {
    let image = &summary.image;
    let structure = match (&*summary.acceleration.kind, &summary.acceleration.quality) {
        ("bvh", Some(quality)) => format!("BVH ({})", quality.name()),
        ("bvh", None) => "BVH".to_owned(),
        _ => "brute force".to_owned(),
    };
    let place = image.window.map_or(String::new(), |window| {
        let ([x, y], [width, height]) = (window.origin, window.picture);
        format!(" at {x}, {y} of {width} × {height}")
    });
    let mut facts = vec![
        format!("{} × {} pixels{place}", image.width, image.height),
        format!(
            "{} per pixel",
            Adaptive::samples(image.adaptive, image.samples_per_pixel)
        ),
        counted(summary.n_primitives, "primitive"),
        structure,
        counted(summary.threads.used as u64, "thread"),
    ];
    if let Some(film) = &summary.film {
        let exposure = (film.exposure != 0.0).then(|| format!("{:+} stops", film.exposure));
        let curve = (film.tone_curve != "none").then(|| format!("tone curve {}", film.tone_curve));
        facts.extend(exposure.into_iter().chain(curve));
    }
    if let Some(n_rays) = summary.cost.total("rays") {
        facts.push(counted(n_rays as u64, "ray"));
    }
    facts.extend(summary.machine.cpu.clone());
    facts
}

/// Returns the label of each object: its name, or its shape if it has none.
fn objects(summary: &Summary) -> Vec<Value> {
    let label = |object: &ObjectEntry| {
        let label = object.name.as_deref().unwrap_or(&object.kind);
        Value::from(label)
    };
    summary.objects.iter().map(label).collect()
}

/// Returns 256 colors of three bytes as base64.
fn color_map(map: ColorMap) -> String {
    let colors = (0..256).flat_map(|i| rgb8(map.at(f64::from(i) / 255.0)));
    STANDARD.encode(colors.collect::<Vec<u8>>())
}
