//! `diff.png`: a map of the change of the cost per pixel.

use std::io::{self, Write};

use super::file::DiffFile;
use super::report::ratio_label;
use super::{Diff, Noise, Side};
use host::provenance::RunId;
use output::chart::{self, CostMap, Range};

/// The file.
pub(super) const FILE: DiffFile = DiffFile {
    name: "diff.png",
    write: |job, out| write(job.diff, job.sides, job.run, out),
};

/// Writes the map of [`Diff::change`].
fn write(diff: &Diff, [a, b]: &[Side; 2], run: RunId, out: &mut impl Write) -> io::Result<()> {
    let change = &diff.change;
    let [width, height] = diff.size;
    let map = CostMap {
        values: &change.differences,
        range: Range::around_zero(&change.differences),
        width,
        height,
        title: &format!(
            "{} − {}: {} per pixel",
            b.label(),
            a.label(),
            change.metric.label
        ),
        unit: change.metric.unit_label(),
        subtitle: &subtitle(diff),
    };
    chart::write(&map, Some(run), out)
}

fn subtitle(diff: &Diff) -> String {
    let metric = diff.change.metric;
    let cost = diff.totals.cost(metric).unwrap_or_default();
    let [a, b] = cost.map(|cost| metric.format(cost));
    let ratio = ratio_label(
        diff.totals
            .total(metric)
            .map_or(1.0, |total| diff.ratio(total)),
    );
    let noise = match diff.noise.as_ref().and_then(Noise::test) {
        Some(test) => format!("; Mann-Whitney {}", test.p_label()),
        None => String::new(),
    };
    let [width, height] = diff.size;
    format!("{width} × {height} pixels; sum {a}, then {b}; B / A {ratio}{noise}")
}
