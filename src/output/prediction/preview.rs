//! Renders a small picture of a scene, for all that depends on the camera.

use std::time::Instant;

use super::look::Look;
use crate::chart::CostMap;
use render::film::Film;
use render::tiles::{TilePlan, render};
use scene::build::Sensor;
use scene::config::{Config, CostMode, Image, Tiling};
use tracer::cost::{Counter, Meter};
use tracer::trace::Tracer;

/// Maximum number of pixels of the picture: a hundredth of a second of rays, and the share of hits
/// to about 0.5 %.
const MOST_PIXELS: usize = 1 << 16;

/// Properties of the rendering, estimated from the small picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Preview {
    pub(super) look: Look,
    /// The share of pixels with a hit.
    pub(super) hit_share: f64,
    /// Bytes of a pixel's packed counters in the film.
    pub(super) counter_bytes: f64,
    /// Wall time per sample, in seconds.
    pub(super) seconds_per_sample: f64,
    /// Pixels of `cost.png` per pixel of the picture; 0 without a map.
    pub(super) map_pixels: f64,
}

/// Returns the settings of the small picture: a subset of the columns and rows, with one sample
/// each.
fn small(image: &Image) -> Image {
    let stride = stride(image);
    image.shrunk(|side| side.div_ceil(stride))
}

/// Returns the columns and rows of the picture per column and row of the small one.
fn stride(image: &Image) -> u32 {
    let share = image.n_pixels() as f64 / MOST_PIXELS as f64;
    (share.sqrt().ceil() as u32).max(1)
}

impl Preview {
    /// Renders the small picture on the current rayon pool.
    pub(super) fn render(config: &Config, tracer: Tracer) -> Self {
        let small = small(&config.image);
        // Tiles that show as much of the scene as the picture's.
        let tiling = Tiling {
            size: (config.tiles.size / stride(&config.image)).max(Tiling::MIN_SIZE),
            ..config.tiles
        };
        let meter = match config.cost {
            CostMode::None => Meter::Off,
            _ => Meter::new(CostMode::Counters),
        };
        let plan = TilePlan::new(
            tracer,
            &Sensor::of_image(tracer.scene, config, small),
            tiling,
        );
        let begin = Instant::now();
        let (film, _) = render(tracer, &plan, &meter, &|_| {});
        let n_pixels = small.n_pixels() as f64;
        Self {
            look: Look::new(&film, config, tracer),
            hit_share: film.n_hits() as f64 / n_pixels,
            counter_bytes: counter_bytes(&film, &config.image),
            seconds_per_sample: begin.elapsed().as_secs_f64() / n_pixels,
            map_pixels: match config.cost {
                CostMode::None => 0.0,
                _ => {
                    let map = CostMap::typical([config.image.width, config.image.height]);
                    map.n_picture_pixels() as f64 / config.image.n_pixels() as f64
                }
            },
        }
    }
}

/// Returns the bytes of a pixel's counters, packed as in the tiles of the picture: each takes as
/// many bytes as the greatest one of its tile.
fn counter_bytes(film: &Film, image: &Image) -> f64 {
    if !film.cost.has_counters() {
        return 0.0;
    }
    let of_counter = |counter: Counter| {
        let n_samples = match counter {
            Counter::Depth => 1,
            _ => image.samples_per_pixel,
        };
        match counter {
            Counter::Samples if image.adaptive.is_none() => 0.0,
            Counter::Samples => n_bytes(n_samples),
            _ => mean_bytes(film, counter, n_samples),
        }
    };
    Counter::ALL.into_iter().map(of_counter).sum()
}

/// Returns the mean bytes of a counter of this many samples.
fn mean_bytes(film: &Film, counter: Counter, n_samples: u32) -> f64 {
    let grid = &film.grid;
    let mut greatest = vec![0; grid.n_tiles() as usize];
    let mut counts = Vec::new();
    for strip in &film.strips {
        film.counter(strip, counter, &mut counts);
        for (y, row) in (strip.first_row..).zip(counts.chunks_exact(grid.width as usize)) {
            let first = (y / grid.tile_size * grid.n_columns) as usize;
            let tiles = greatest[first..].iter_mut();
            for (tile, pixels) in tiles.zip(row.chunks(grid.tile_size as usize)) {
                *tile = pixels.iter().copied().fold(*tile, u32::max);
            }
        }
    }
    let n_tiles = greatest.len() as f64;
    let bytes = greatest
        .into_iter()
        .map(|count| n_bytes(count.saturating_mul(n_samples)));
    bytes.sum::<f64>() / n_tiles
}

/// Returns the number of bytes that a number needs.
fn n_bytes(number: u32) -> f64 {
    f64::from((u32::BITS - number.leading_zeros()).div_ceil(u8::BITS))
}
