//! `cost.png`: the time of each pixel as a picture.

use std::io::{self, Write};
use std::time::Duration;

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use super::Rendering;
use super::cost_picture::{CostMap, draw};
use super::format;

/// Writes the map of `time_ns`.
pub(super) fn write(rendering: &Rendering, out: &mut impl Write) -> io::Result<()> {
    let film = rendering.film;
    let times: Vec<f32> = film.values(|strip| &strip.time_ns).collect();
    let picture = draw(&CostMap {
        values: &times,
        width: film.width,
        height: film.height,
        title: &format!("{}: time per pixel", rendering.name),
        unit: "ns",
        subtitle: &subtitle(rendering, median(&times)),
    });
    PngEncoder::new(out)
        .write_image(
            &picture,
            picture.width(),
            picture.height(),
            ExtendedColorType::Rgb8,
        )
        .map_err(io::Error::other)
}

fn subtitle(rendering: &Rendering, median_ns: f32) -> String {
    let image = &rendering.config.image;
    let n_threads = rendering.threads.used;
    let duration = |ns: f64| format::duration(Duration::from_nanos(ns as u64));
    format!(
        "{} × {} pixels, {} per pixel, {}; median {}, sum {}",
        image.width,
        image.height,
        format::counted(image.samples_per_pixel.into(), "sample"),
        format::counted(n_threads as u64, "thread"),
        duration(median_ns.into()),
        duration(rendering.film.total_time_ns()),
    )
}

/// The middle value.
fn median(values: &[f32]) -> f32 {
    let mut values = values.to_vec();
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}
