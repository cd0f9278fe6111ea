//! `diff.pvsm`: the change of the cost in ParaView.

use super::{Diff, volume};
use crate::output::OutputFolder;
use crate::output::cost_picture::{Range, Scale};
use crate::output::state::{between, fill, picture_camera};

const TEMPLATE: &str = include_str!("../../paraview/diff.pvsm");

/// The state of a diff in this folder, in ASCII.
pub(super) fn text(diff: &Diff, folder: &OutputFolder) -> String {
    let change = &diff.change;
    let reach = Range::on(Scale::AroundZero, &change.differences).high;
    // Labels at the ends lie within only if the ends are rounded, too.
    let [low, high] = [change.ratio_of_most.recip(), change.ratio_of_most].map(rounded);
    let ratio_at = |f: f64| low * (high / low).powf(f);
    let number = |key: &str| -> Option<f64> {
        if let Some(fraction) = key.strip_prefix("difference.linear(") {
            return between(fraction, |f| reach * (2.0 * f - 1.0));
        }
        if let Some(fraction) = key.strip_prefix("ratio.log(") {
            return between(fraction, ratio_at);
        }
        if let Some(fraction) = key.strip_prefix("ratio.label(") {
            return between(fraction, |f| rounded(ratio_at(f)));
        }
        picture_camera(diff.size.map(f64::from), key.strip_prefix("image.")?)
    };
    fill(TEMPLATE, |key| match key {
        volume::FILE => Some(folder.path_of(key).to_string_lossy().into_owned()),
        "difference.array" => Some(format!("{}_difference", change.measure.array)),
        "difference.title" => Some(title("B - A", diff)),
        "ratio.array" => Some(format!("{}_ratio", change.measure.array)),
        "ratio.title" => Some(title("B / A", diff)),
        _ => number(key).map(|number| number.to_string()),
    })
}

/// To three digits.
fn rounded(ratio: f64) -> f64 {
    format!("{ratio:.2e}").parse().unwrap_or(ratio)
}

/// "B - A: time per pixel (ns)"
fn title(what: &str, diff: &Diff) -> String {
    let measure = diff.change.measure;
    let unit = match (what, measure.unit) {
        ("B - A", "ns") => " (ns)",
        _ => "",
    };
    format!("{what}: {} per pixel{unit}", measure.name)
}
