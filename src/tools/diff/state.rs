//! `diff.pvsm`: a ParaView state that shows the change of the cost.

use std::io::Write;

use super::file::DiffFile;
use super::{Diff, volume};
use host::folder::OutputFolder;
use host::provenance::stamped;
use output::chart::Range;
use output::paraview::{Axis, ColorScale, Panels, fill, value_of_panels};

const TEMPLATE: &str = include_str!("diff.pvsm");

/// The file.
pub const FILE: DiffFile = DiffFile {
    name: "diff.pvsm",
    write: |job, out| {
        let state = stamped(&text(job.diff, job.folder), job.run);
        out.write_all(state.as_bytes())
    },
};

/// Returns the state of a diff in this folder, in ASCII.
fn text(diff: &Diff, folder: &OutputFolder) -> String {
    let change = &diff.change;
    let size = diff.size.map(f64::from);
    let n_labels = Panels::new(3, size).n_labels();
    let max_difference = Range::around_zero(&change.differences).high;
    let axis = |what, scale, ends| {
        let metric = change.metric;
        let array = format!("{}_{what}", metric.name);
        let sign = if what == "ratio" { "B / A" } else { "B - A" };
        let name = format!("{sign}: {} per pixel", metric.label);
        let axis = Axis::new(&array, &name, scale, ends).with_labels(n_labels);
        if metric.is_timed() && what == "difference" {
            axis.in_time_unit()
        } else {
            axis
        }
    };
    let difference = axis(
        "difference",
        ColorScale::Diverging,
        [-max_difference, max_difference],
    );
    let max_ratio = change.max_ratio;
    let ratio = axis(
        "ratio",
        ColorScale::Logarithmic,
        [max_ratio.recip(), max_ratio],
    );
    fill(TEMPLATE, |key| {
        if key == volume::FILE.name {
            return Some(folder.path_of(key).to_string_lossy().into_owned().into());
        }
        if key == "histogram.pixels" {
            return Some((size[0] * size[1]).to_string().into());
        }
        if let Some(key) = key.strip_prefix("difference.") {
            return difference.value(key);
        }
        if let Some(key) = key.strip_prefix("ratio.") {
            return ratio.value(key);
        }
        value_of_panels(size, key)
    })
}
