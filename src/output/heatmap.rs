//! `cost.png`: what each pixel cost as a picture.

use std::io::{self, Write};

use super::Rendering;
use super::measure::Measure;
use crate::chart::{CostMap, Scale, draw, png};
use crate::provenance::{self, RunId};
use crate::statistics::upper_median;
use crate::text::numbers;

/// Writes the map of the film's best measure; nothing for a film without cost.
pub(super) fn write(rendering: &Rendering, run: RunId, out: &mut impl Write) -> io::Result<()> {
    let film = rendering.film;
    let Some([measure, _]) = Measure::best_two(film) else {
        return Ok(());
    };
    let values = measure.of(film);
    let picture = draw(&CostMap {
        values: &values,
        scale: Scale::Logarithmic,
        width: film.grid.width,
        height: film.grid.height,
        title: &format!("{}: {}", rendering.name, measure.name),
        unit: measure.unit,
        subtitle: &subtitle(rendering, measure, &values),
    });
    let (width, height) = picture.dimensions();
    let rows = picture.chunks_exact(3 * width as usize);
    let texts = [(provenance::KEY, &*run.to_string())];
    png::write([width, height], rows, &texts, out)
}

fn subtitle(rendering: &Rendering, measure: Measure, values: &[f32]) -> String {
    let image = &rendering.config.image;
    let n_threads = rendering.threads.used;
    let median = upper_median(&mut values.to_vec(), f32::total_cmp);
    format!(
        "{} × {} pixels, {} per pixel, {}; median {}, sum {}",
        image.width,
        image.height,
        numbers::counted(image.samples_per_pixel.into(), "sample"),
        numbers::counted(n_threads as u64, "thread"),
        measure.label(median.unwrap_or_default().into()),
        measure.label(values.iter().copied().map(f64::from).sum()),
    )
}
