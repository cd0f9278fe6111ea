//! Estimates the work of each tile from one pixel in 64.

use std::time::Instant;

use cpu_time::ThreadTime as ThreadClock;
use rayon::prelude::*;

use super::stream::{StreamRenderer, WAVE_LEN};
use super::timed::SingleRayRenderer;
use super::view::View;
use crate::accel::Accel;
use crate::config::{CostMode, Image};
use crate::cost::{Cost, Counters};
use crate::scene::Scene;
use crate::schedule::{Tile, TileGrid};

/// Distance of probed pixels in columns and rows.
const STEP: u32 = 8;
/// Their distance where each gets as many samples as in the picture.
const WIDE_STEP: u32 = 32;

/// Probed pixels that are traced in a stream and timed together: few, since neighbors take
/// about the same time per step.
const TIMED_PIXELS: u32 = 256;

/// Estimates the work of each tile in traversal steps: one sample of some of its
/// pixels, at least one, extrapolated to all of them. It is counted, not timed,
/// and so does not depend on the run or the number of threads.
pub(super) fn work(scene: &Scene, accel: &Accel, image: &Image, grid: &TileGrid) -> Vec<u64> {
    let image = of_one_sample(image);
    let view = View::new(scene, accel, &image);
    let per_tile = grid.tile_size.div_ceil(STEP).pow(2);
    // Enough tiles to fill a stream.
    let n_per_chunk = (WAVE_LEN as u32 / per_tile).max(1);
    let renderer = || StreamRenderer::<Counters>::new(view);
    chunks(grid, n_per_chunk, renderer, |renderer, tiles| {
        steps_of_tiles(renderer, tiles, STEP)
    })
}

/// Estimates the time of each tile on this machine, in nanoseconds but for a common factor, by
/// some of its pixels, at least one, rendered as the cost mode asks: with one sample, or with
/// those that adaptive sampling gives them.
pub(super) fn times(
    (scene, accel): (&Scene, &Accel),
    image: &Image,
    grid: &TileGrid,
    mode: CostMode,
) -> Vec<f64> {
    let (image, step) = match image.adaptive {
        None => (of_one_sample(image), STEP),
        Some(_) => (*image, WIDE_STEP),
    };
    let view = View::new(scene, accel, &image);
    if mode == CostMode::Time {
        let renderer = || SingleRayRenderer::new(view, None, (1, &image));
        return chunks(grid, 1, renderer, |renderer, tiles| {
            let of_tile = |tile| time_of_tile(renderer, tile, step);
            tiles.iter().map(of_tile).collect()
        });
    }
    let per_tile = grid.tile_size.div_ceil(step).pow(2);
    let n_per_chunk = (TIMED_PIXELS / per_tile).max(1);
    // The first chunk of a thread is traced twice: its memory is new.
    let renderer = || (StreamRenderer::<Counters>::new(view), true);
    chunks(grid, n_per_chunk, renderer, |(renderer, is_new), tiles| {
        if std::mem::take(is_new) {
            steps_of_tiles(renderer, tiles, step);
        }
        let begin = ThreadClock::now();
        let steps = steps_of_tiles(renderer, tiles, step);
        let ns = begin.elapsed().as_nanos() as f64;
        let ns_per_step = ns / steps.iter().sum::<u64>().max(1) as f64;
        steps.iter().map(|&n| n as f64 * ns_per_step).collect()
    })
}

fn of_one_sample(image: &Image) -> Image {
    Image {
        samples_per_pixel: 1,
        adaptive: None,
        ..*image
    }
}

/// Calls `of_chunk` with the tiles of the grid, some at a time, on the current rayon pool;
/// returns what it returns of each tile.
fn chunks<R, T: Send>(
    grid: &TileGrid,
    n_per_chunk: u32,
    renderer: impl Fn() -> R + Sync + Send,
    of_chunk: impl Fn(&mut R, &[Tile]) -> Vec<T> + Sync + Send,
) -> Vec<T> {
    (0..grid.n_tiles().div_ceil(n_per_chunk))
        .into_par_iter()
        .map_init(renderer, |renderer, chunk| {
            let first = chunk * n_per_chunk;
            let numbers = first..grid.n_tiles().min(first + n_per_chunk);
            let tiles: Vec<Tile> = numbers.map(|number| grid.tile(number)).collect();
            of_chunk(renderer, &tiles)
        })
        .flatten_iter()
        .collect()
}

/// Traces the probed pixels of tiles; returns the steps of each tile.
fn steps_of_tiles(renderer: &mut StreamRenderer<Counters>, tiles: &[Tile], step: u32) -> Vec<u64> {
    let places = tiles.iter().flat_map(|tile| probed_pixels(tile, step));
    renderer.follow((0..).zip(places));
    let counters = renderer.probe();
    let mut pixels = 0..;
    let of_tile = |tile| {
        let n_probed = probed_pixels(tile, step).count();
        let probed = pixels.by_ref().take(n_probed);
        let n_steps: u64 = probed.map(|pixel| steps(counters.of(pixel))).sum();
        n_steps * tile.n_pixels() as u64 / n_probed as u64
    };
    tiles.iter().map(of_tile).collect()
}

/// Renders the probed pixels of a tile one by one; returns the time of all of its pixels in
/// nanoseconds.
fn time_of_tile(renderer: &mut SingleRayRenderer, tile: &Tile, step: u32) -> f64 {
    let n_probed = probed_pixels(tile, step).count();
    let begin = Instant::now();
    for place in probed_pixels(tile, step) {
        renderer.render_pixel(place, 0);
    }
    let ns = begin.elapsed().as_nanos() as f64;
    ns * tile.n_pixels() as f64 / n_probed as f64
}

/// Returns the probed pixels of a tile.
fn probed_pixels(tile: &Tile, step: u32) -> impl Iterator<Item = (u32, u32)> + use<> {
    let places = move |[first, end]: [u32; 2]| {
        // The middle of each step, or of a shorter tile.
        let middle = first + step.min(end - first) / 2;
        (middle..end).step_by(step as usize)
    };
    let columns = places(tile.columns);
    places(tile.rows).flat_map(move |y| columns.clone().map(move |x| (x, y)))
}

/// Returns the traversal steps of a pixel's rays, with [`RAY_STEPS`] for each ray.
fn steps(cost: Cost) -> u64 {
    cost.node_visits + cost.primitive_tests + RAY_STEPS * cost.n_rays()
}

/// Work per ray outside of its traversal, in traversal steps.
const RAY_STEPS: u64 = 4;
