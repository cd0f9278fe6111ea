//! Renders some rows of the picture, to measure their compression.

use std::num::NonZeroU8;

use super::length::Length;
use crate::writers;
use render::film::Film;
use render::tiles::{TilePlan, repeat};
use scene::build::Sensor;
use scene::config::{Config, Image, Repeats};
use tracer::cost::Meter;
use tracer::trace::Tracer;

/// Camera rays of the rows, unless the minimum number of rows has more: about half a second.
const N_SAMPLES: u64 = 1 << 19;

/// Minimum number of rows of tiles. If their camera rays are too many, pixels have fewer samples.
const LEAST_ROWS_OF_TILES: u32 = 3;
const MOST_SAMPLES: u64 = 1 << 20;

/// Two renderings, which show the spread of times.
const TWICE: Repeats = Repeats::Exactly(NonZeroU8::new(2).unwrap());

/// Rows of the picture.
pub(super) struct RowSample<'a> {
    config: &'a Config,
    film: Film,
    /// Rows of the picture per row of the film.
    share: f64,
}

impl<'a> RowSample<'a> {
    /// Renders some rows of the picture on the current rayon pool.
    pub(super) fn render(config: &'a Config, tracer: Tracer, is_repeated: bool) -> Self {
        let has_spread = config.cost.has_time() && config.repeats.has_spread();
        let repeats = if has_spread { TWICE } else { Repeats::ONCE };
        let (image, n_rows) = rows(config, if has_spread { 2 } else { 1 });
        let plan = TilePlan::of_some_rows(
            &Sensor::of_image(tracer.scene, config, image),
            config.tiles.size,
            n_rows,
        );
        let meter = Meter::new(config.cost);
        let (mut film, ..) = repeat(repeats, tracer, &plan, &meter, &|_| {});
        if !is_repeated {
            for strip in &mut film.strips {
                strip.time_mad_ns.fill(0.0);
            }
        }
        Self {
            config,
            share: f64::from(config.image.height) / f64::from(film.grid.height),
            film,
        }
    }

    /// Returns the bytes of a cloud of this many hits, and of the frame, without their headers.
    pub(super) fn of_arrays(&self, n_hits: u64) -> [u64; 2] {
        let empty = Film {
            strips: Vec::new(),
            tiles: Vec::new(),
            ..self.film
        };
        let codec = self.config.compress;
        let cloud = |film| Length::measure(|out| writers::write_hits(film, codec, out));
        let frame = |film| Length::measure(|out| writers::write_frame(film, codec, out));
        let of_hits = match self.film.n_hits() {
            0 => self.share,
            n => n_hits as f64 / n as f64,
        };
        [
            scaled(cloud(&self.film) - cloud(&empty), of_hits),
            scaled(frame(&self.film) - frame(&empty), self.share),
        ]
    }

    /// Returns the bytes of the picture without its texts.
    pub(super) fn of_picture(&self) -> u64 {
        let bits = self.config.film.bits;
        let of_rows = Length::measure(|out| writers::write_bare_picture(&self.film, bits, out));
        scaled(of_rows, self.share)
    }

    /// Returns the bytes of the cost map, 0 without one, whose pixels are blocks of pixels with
    /// this side.
    pub(super) fn of_map(&self, side: u32) -> u64 {
        if !self.config.cost.has_counters() {
            return 0;
        }
        let [costs, none] = [true, false].map(|has_costs| {
            Length::measure(|out| writers::write_bare_map(&self.film, side, has_costs, out))
        });
        none + scaled(costs.saturating_sub(none), self.share)
    }
}

/// Returns the picture with at most the samples that there is time for, and the number of rows,
/// which are rendered `n_renderings` times.
fn rows(config: &Config, n_renderings: u64) -> (Image, u32) {
    let image = config.image;
    let per_row = u64::from(image.width) * n_renderings;
    let least = LEAST_ROWS_OF_TILES * config.tiles.size;
    let most_samples = MOST_SAMPLES / (per_row * u64::from(least));
    let n_samples = u64::from(image.samples_per_pixel).min(most_samples).max(1);
    let n_rows = N_SAMPLES / (per_row * n_samples);
    let image = Image {
        samples_per_pixel: n_samples as u32,
        ..image
    };
    (image, least.max(n_rows as u32))
}

fn scaled(n_bytes: u64, factor: f64) -> u64 {
    (n_bytes as f64 * factor).round() as u64
}
