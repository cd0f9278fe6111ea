//! A diff as JSON: the content of the report, and all groups.

use std::io::{self, Write};

use serde_json::{Value, json};

use super::file::DiffFile;
use super::gate::Gate;
use super::{CostGroup, Diff, Side, Total, Totals, ratio};
use math::statistics::CONFIDENCE;
use tracer::cost::MetricUnit;

/// The file.
pub(super) const FILE: DiffFile = DiffFile {
    name: "diff.json",
    write: |job, out| write(job.json, out),
};

/// Writes a comparison.
pub(super) fn write(json: &Value, out: &mut impl Write) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *out, json)?;
    writeln!(out)
}

/// Returns the whole diff as JSON. A ratio B / A with A = 0 < B is infinite: null in
/// JSON.
pub fn to_json(diff: &Diff, sides: &[Side; 2], gate: Option<&Gate>) -> Value {
    let [a, b] = sides.each_ref().map(side);
    json!({
        "raycost": env!("CARGO_PKG_VERSION"),
        "a": a,
        "b": b,
        "image": { "width": diff.size[0], "height": diff.size[1] },
        "origin": sides[0].origin(),
        "totals": totals(&diff.totals, |total| diff.ratio(total)),
        "noise": diff.noise,
        "confidence": CONFIDENCE,
        "gate": gate,
        "objects": groups(&diff.objects),
        "objects_reached": groups(&diff.reached),
        "tiles": groups(&diff.tiles),
        "picture": diff.picture,
        "light": diff.light,
        "n_pixels_of_other_objects": diff.n_other_objects,
        "settings": diff.settings,
        "machine": diff.machine,
    })
}

pub(super) fn side(side: &Side) -> Value {
    json!({ "folder": side.name(), "scene": side.summary().scene })
}

/// Returns the totals by the names of the arrays.
fn totals(totals: &Totals, ratio_of: impl Fn(&Total) -> f64) -> Value {
    let total = |total: &Total| {
        let [a, b] = total.cost;
        let [number_a, number_b, difference] = [a, b, b - a].map(|value| match total.metric.unit {
            MetricUnit::Count => json!(value as i64),
            MetricUnit::Nanoseconds | MetricUnit::Ratio => json!(value),
        });
        let value = json!({
            "a": number_a, "b": number_b, "difference": difference, "ratio": ratio_of(total),
        });
        (total.metric.name.to_owned(), value)
    };
    Value::Object(totals.0.iter().map(total).collect())
}

fn groups(groups: &[CostGroup]) -> Value {
    let group = |group: &CostGroup| {
        let totals = totals(&group.totals, |total| ratio(total.cost));
        match group.bounds {
            Some(bounds) => {
                json!({ "name": group.name, "x": bounds.x, "y": bounds.y, "totals": totals })
            }
            None => json!({ "name": group.name, "totals": totals }),
        }
    };
    groups.iter().map(group).collect()
}
