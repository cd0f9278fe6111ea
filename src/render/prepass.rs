//! Estimates the work of each tile from one pixel in 64.

use rayon::prelude::*;

use super::stream::{StreamRenderer, WAVE_LEN};
use super::view::View;
use crate::accel::Accel;
use crate::config::Image;
use crate::cost::{Cost, Counters};
use crate::scene::Scene;
use crate::schedule::{Tile, TileGrid};

/// Distance of probed pixels in columns and rows.
const STEP: u32 = 8;

/// Estimates the work of each tile in traversal steps: one sample of some of its
/// pixels, at least one, extrapolated to all of them. It is counted, not timed,
/// and so does not depend on the run or the number of threads.
pub(super) fn work(scene: &Scene, accel: &Accel, image: &Image, grid: &TileGrid) -> Vec<u64> {
    let image = Image {
        samples_per_pixel: 1,
        adaptive: None,
        ..*image
    };
    let view = View::new(scene, accel, &image);
    let renderer = || StreamRenderer::<Counters>::new(view);
    let per_tile = grid.tile_size.div_ceil(STEP).pow(2);
    // Enough tiles to fill a stream.
    let n_per_chunk = (WAVE_LEN as u32 / per_tile).max(1);
    let work = |renderer: &mut StreamRenderer<Counters>, chunk: u32| -> Vec<u64> {
        let first = chunk * n_per_chunk;
        let numbers = first..grid.n_tiles().min(first + n_per_chunk);
        let tiles: Vec<Tile> = numbers.map(|number| grid.tile(number)).collect();
        let places = (0..).zip(tiles.iter().flat_map(probed_pixels));
        renderer.follow(places);
        let counters = renderer.probe();
        let mut pixels = 0..;
        let of_tile = |tile| {
            let n_probed = probed_pixels(tile).count();
            let probed = pixels.by_ref().take(n_probed);
            let n_steps: u64 = probed.map(|pixel| steps(counters.of(pixel))).sum();
            n_steps * tile.n_pixels() as u64 / n_probed as u64
        };
        tiles.iter().map(of_tile).collect()
    };
    (0..grid.n_tiles().div_ceil(n_per_chunk))
        .into_par_iter()
        .map_init(renderer, work)
        .flatten_iter()
        .collect()
}

/// Returns the probed pixels of a tile.
fn probed_pixels(tile: &Tile) -> impl Iterator<Item = (u32, u32)> + use<> {
    let places = |[first, end]: [u32; 2]| {
        // The middle of each step, or of a shorter tile.
        let middle = first + STEP.min(end - first) / 2;
        (middle..end).step_by(STEP as usize)
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
