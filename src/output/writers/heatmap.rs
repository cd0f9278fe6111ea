//! `cost.png`: the cost of each pixel as a picture.

use std::io::{self, Write};

use super::file::{FileContent, OutputFile};
use super::reduced_map::ReducedMap;
use super::{RenderingView, time_notes};
use crate::chart::{self, CostMap, Range};
use base::numbers;
use host::provenance::RunId;
use render::film::Film;
use tracer::cost::{Metric, MetricUnit};

/// The file.
pub(super) const FILE: OutputFile = OutputFile {
    name: "cost.png",
    is_wanted: |request| request.has_counters(),
    content: FileContent::Written(|job, out| write(job.rendering, job.run, out)),
};

/// Writes the map of the film's first metric.
fn write(rendering: &RenderingView, run: RunId, out: &mut impl Write) -> io::Result<()> {
    let (film, survey) = (rendering.film, rendering.survey);
    // Without any cost, as before the first tile, the map shows the number of rays, 0 everywhere.
    let metric = survey.metrics.map_or(Metric::RAYS, |[metric, _]| metric);
    let of_film: Vec<f32>;
    let ([width, height], values) = match &survey.map {
        Some(map) => (map.size, &map.values),
        None => {
            of_film = film.metric(metric);
            ([film.grid.width, film.grid.height], &of_film)
        }
    };
    let partial = rendering.partial.map(|partial| format!(" ({partial})"));
    let partial = partial.unwrap_or_default();
    let map = CostMap {
        values,
        range: survey.range,
        width,
        height,
        title: &format!("{}: {}{partial}", rendering.name, metric.title),
        unit: metric.unit_label(),
        subtitle: &subtitle(rendering, metric),
    };
    chart::write(&map, Some(run), out)
}

/// Writes a map of a film's costs, or of none, with any labels: the means of blocks of pixels with
/// this side.
pub(crate) fn write_bare(
    film: &Film,
    side: u32,
    has_costs: bool,
    out: &mut impl Write,
) -> io::Result<()> {
    let metrics = film.heatmap_metrics();
    let metric = metrics.map_or(Metric::RAYS, |[metric, _]| metric);
    let size = [film.grid.width, film.grid.height];
    let mut map = ReducedMap::reduce(size, side, &film.metric(metric));
    let range = Range::spanning(&map.values);
    if !has_costs {
        map.values.fill(0.0);
    }
    let map = CostMap {
        values: &map.values,
        range,
        unit: metric.unit_label(),
        ..CostMap::typical(map.size)
    };
    chart::write(&map, None, out)
}

fn subtitle(rendering: &RenderingView, metric: Metric) -> String {
    let (image, survey) = (&rendering.config.image, rendering.survey);
    let n_threads = rendering.threads.used;
    let means = match &survey.map {
        Some(map) if map.block != [1, 1] => {
            let [width, height] = map.block;
            format!(", means of {width} × {height}")
        }
        _ => String::new(),
    };
    // A sum of ratios means nothing, their mean does.
    let [name, whole] = match metric.unit {
        MetricUnit::Ratio => {
            let n_pixels = image.n_pixels() as f64;
            ["mean", &metric.format(survey.sum / n_pixels)]
        }
        _ => ["sum", &metric.format(survey.sum)],
    };
    let notes = if metric.is_timed() {
        time_notes(rendering)
    } else {
        Vec::new()
    };
    let notes: String = notes.iter().map(|note| format!("; {note}")).collect();
    format!(
        "{} × {} pixels{means}, {} per pixel, {}; median {}, {name} {whole}{notes}",
        image.width,
        image.height,
        image.samples(),
        numbers::counted(n_threads as u64, "thread"),
        metric.format(survey.median.into()),
    )
}
