//! Writes the files of a comparison with another program.

use std::io::{self, Write};

use serde_json::{Value, json};

use super::comparison::{ForeignDiff, ForeignDifference, in_order};
use crate::diff::files::write_files;
use crate::diff::json::{self as json_file, side};
use crate::diff::map;
use crate::diff::report::{colors_sentence, light_sentence};
use host::folder::{OutputFolder, WriteError, Written};
use host::provenance::RunId;
use output::chart::{self, CostMap, Range};

/// Writes the map of the differences and all numbers; returns the files in the order of the report.
///
/// # Errors
/// The first file that could not be written; then no file of the folder has changed.
pub fn write(diff: &ForeignDiff, folder: &OutputFolder) -> Result<Vec<Written>, WriteError> {
    let names = [map::FILE.name, json_file::FILE.name];
    let json = to_json(diff);
    write_files(&names, &json, folder, |name, run, out| {
        if name == map::FILE.name {
            write_map(diff, run, out)
        } else {
            json_file::write(&json, run, out)
        }
    })
}

/// Returns the comparison as JSON.
pub fn to_json(diff: &ForeignDiff) -> Value {
    let file = json!({ "file": diff.file.path.display().to_string() });
    let [a, b] = in_order([side(&diff.output), file], diff.position);
    let [width, height] = diff.output.size();
    let (key, differences) = match &diff.comparison {
        ForeignDifference::Picture(picture) => ("picture", json!(picture)),
        ForeignDifference::Light(light) => ("light", json!(light)),
        ForeignDifference::Cost(metric, agreement) => {
            let mut differences = json!(agreement);
            differences["metric"] = json!(metric.name);
            ("cost", differences)
        }
    };
    let mut all = json!({
        "raycost": env!("CARGO_PKG_VERSION"),
        "a": a,
        "b": b,
        "image": { "width": width, "height": height },
        "greatest_difference": diff.greatest(),
    });
    all[key] = differences;
    all
}

fn write_map(diff: &ForeignDiff, run: RunId, out: &mut impl Write) -> io::Result<()> {
    let [width, height] = diff.output.size();
    let labels = [diff.output.label().to_owned(), diff.file.label()];
    let [a, b] = in_order(labels, diff.position);
    let channel = "the channel that differs most";
    let (title, unit, subtitle) = match &diff.comparison {
        ForeignDifference::Picture(picture) => (
            format!("{b} − {a}: color per pixel"),
            channel,
            colors_sentence(picture, [width, height]),
        ),
        ForeignDifference::Light(light) => (
            format!("{b} − {a}: light per pixel"),
            channel,
            light_sentence(light),
        ),
        ForeignDifference::Cost(metric, _) => (
            format!("{b} / {a}: {} per pixel, at the same sum", metric.label),
            "log2(B / A)",
            "+1: twice the share of the whole cost, −1: half of it".to_owned(),
        ),
    };
    let map = CostMap {
        values: &diff.map,
        range: Range::around_zero(&diff.map),
        width,
        height,
        title: &title,
        unit,
        subtitle: &subtitle,
    };
    chart::write(&map, Some(run), out)
}
