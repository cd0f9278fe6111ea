//! `cost.png`: the cost of each pixel as a picture.

use std::io::{self, Write};

use super::RenderingView;
use super::file::{FileContent, OutputFile};
use crate::chart::{self, CostMap};
use crate::cost::Metric;
use crate::provenance::RunId;
use crate::text::numbers;

/// The file.
pub(super) const FILE: OutputFile = OutputFile {
    name: "cost.png",
    is_wanted: |request| request.has_counters(),
    content: FileContent::Written(|job, out| write(job.rendering, job.run, out)),
};

/// Writes the map of the film's first metric.
fn write(rendering: &RenderingView, run: RunId, out: &mut impl Write) -> io::Result<()> {
    let (film, survey) = (rendering.film, rendering.survey);
    // Without any cost, as before the first tile, that of rays is 0 everywhere.
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
    chart::write(&map, run, out)
}

fn subtitle(rendering: &RenderingView, metric: Metric) -> String {
    let (image, survey) = (&rendering.config.image, rendering.survey);
    let n_threads = rendering.threads.used;
    let means = match &survey.map {
        Some(map) if map.side > 1 => format!(", means of {0} × {0}", map.side),
        _ => String::new(),
    };
    format!(
        "{} × {} pixels{means}, {} per pixel, {}; median {}, sum {}",
        image.width,
        image.height,
        image.samples(),
        numbers::counted(n_threads as u64, "thread"),
        metric.format(survey.median.into()),
        metric.format(survey.sum),
    )
}
