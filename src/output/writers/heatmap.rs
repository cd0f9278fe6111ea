//! `cost.png`: the cost of each pixel as a picture.

use std::io::{self, Write};

use super::RenderingView;
use super::file::{FileContent, OutputFile};
use super::reduced_map::ReducedMap;
use crate::chart::{self, CostMap, Range};
use base::provenance::RunId;
use base::text::numbers;
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
    let mut map = ReducedMap::of_pixels(size, side, &film.metric(metric));
    let range = Range::spanning(&map.values);
    if !has_costs {
        map.values.fill(0.0);
    }
    let [width, height] = map.size;
    let map = CostMap {
        values: &map.values,
        range,
        width,
        height,
        title: "still_life: time per pixel",
        unit: metric.unit_label(),
        subtitle: "720 × 480 pixels, 256 samples per pixel, 16 threads; median 412 ns, sum 1.27 s",
    };
    chart::write(&map, None, out)
}

fn subtitle(rendering: &RenderingView, metric: Metric) -> String {
    let (image, survey) = (&rendering.config.image, rendering.survey);
    let n_threads = rendering.threads.used;
    let means = match &survey.map {
        Some(map) if map.side > 1 => format!(", means of {0} × {0}", map.side),
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
    format!(
        "{} × {} pixels{means}, {} per pixel, {}; median {}, {name} {whole}",
        image.width,
        image.height,
        image.samples(),
        numbers::counted(n_threads as u64, "thread"),
        metric.format(survey.median.into()),
    )
}
