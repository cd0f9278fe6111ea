//! `cost.png`: the cost of each pixel as a picture.

use std::io::{self, Write};

use super::RenderingView;
use super::file::{FileContent, OutputFile};
use crate::chart::{self, CostMap, Range};
use crate::cost::Metric;
use crate::provenance::RunId;
use crate::statistics::floats_at;
use crate::text::numbers;

/// The file.
pub(super) const FILE: OutputFile = OutputFile {
    name: "cost.png",
    is_wanted: |request| request.has_counters(),
    content: FileContent::Written(|job, out| {
        write(job.rendering, job.states.cost_range(), job.run, out)
    }),
};

/// Writes the map of the film's first metric, whose range is known.
fn write(
    rendering: &RenderingView,
    range: &Range,
    run: RunId,
    out: &mut impl Write,
) -> io::Result<()> {
    let film = rendering.film;
    // Without any cost, as before the first tile, that of rays is 0 everywhere.
    let metrics = film.heatmap_metrics();
    let metric = metrics.map_or(Metric::RAYS, |[metric, _]| metric);
    let values = film.metric(metric);
    let partial = rendering.partial.map(|partial| format!(" ({partial})"));
    let partial = partial.unwrap_or_default();
    let map = CostMap {
        values: &values,
        range: *range,
        width: film.grid.width,
        height: film.grid.height,
        title: &format!("{}: {}{partial}", rendering.name, metric.title),
        unit: metric.unit_label(),
        subtitle: &subtitle(rendering, metric, &values),
    };
    chart::write(&map, run, out)
}

fn subtitle(rendering: &RenderingView, metric: Metric, values: &[f32]) -> String {
    let image = &rendering.config.image;
    let n_threads = rendering.threads.used;
    let [median] = floats_at(values, [values.len() / 2]).unwrap_or_default();
    format!(
        "{} × {} pixels, {} per pixel, {}; median {}, sum {}",
        image.width,
        image.height,
        image.samples(),
        numbers::counted(n_threads as u64, "thread"),
        metric.format(median.into()),
        metric.format(values.iter().copied().map(f64::from).sum()),
    )
}
