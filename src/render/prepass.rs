//! How much work each tile will be, from one pixel in 64.

use rayon::prelude::*;

use super::stream::{Place, StreamRenderer, WAVE_LEN};
use super::view::View;
use crate::accel::Accel;
use crate::config::Image;
use crate::cost::{Cost, Counters};
use crate::scene::Scene;
use crate::schedule::{Tile, TileGrid};

/// Columns, and rows, from one pixel that is looked at to the next.
const STEP: u32 = 8;

/// The work of each tile, in steps of the traversal: that of one sample of
/// some of its pixels, at least one, as if all were like these. It is counted,
/// not timed, and so the same on every run and any number of threads.
pub(super) fn work(scene: &Scene, accel: &Accel, image: &Image, grid: &TileGrid) -> Vec<u64> {
    let image = Image {
        samples_per_pixel: 1,
        ..*image
    };
    let view = View::new(scene, accel, &image);
    let renderer = || StreamRenderer::<Counters>::new(view);
    let per_tile = grid.tile_size.div_ceil(STEP).pow(2);
    // So many tiles make a stream that is worth its while.
    let n_together = (WAVE_LEN as u32 / per_tile).max(1);
    let work = |renderer: &mut StreamRenderer<Counters>, chunk: u32| -> Vec<u64> {
        let first = chunk * n_together;
        let numbers = first..grid.n_tiles().min(first + n_together);
        let tiles: Vec<Tile> = numbers.map(|number| grid.tile(number)).collect();
        let places = (0..).zip(tiles.iter().flat_map(sparse_pixels));
        renderer.follow(places.map(|(pixel, at)| Place { pixel, at }));
        let counters = renderer.probe();
        let mut pixels = 0..;
        let of_tile = |tile| {
            let n_looked_at = sparse_pixels(tile).count();
            let looked_at = pixels.by_ref().take(n_looked_at);
            let looked_at: u64 = looked_at.map(|pixel| steps(counters.of(pixel))).sum();
            looked_at * tile.n_pixels() as u64 / n_looked_at as u64
        };
        tiles.iter().map(of_tile).collect()
    };
    (0..grid.n_tiles().div_ceil(n_together))
        .into_par_iter()
        .map_init(renderer, work)
        .flatten_iter()
        .collect()
}

/// The pixels of a tile that are looked at.
fn sparse_pixels(tile: &Tile) -> impl Iterator<Item = (u32, u32)> + use<> {
    let places = |[first, end]: [u32; 2]| {
        // In the middle of each step, or of a tile that is shorter.
        let middle = first + STEP.min(end - first) / 2;
        (middle..end).step_by(STEP as usize)
    };
    let columns = places(tile.columns);
    places(tile.rows).flat_map(move |y| columns.clone().map(move |x| (x, y)))
}

/// A pixel's rays' own part and the steps of their traversal.
fn steps(cost: Cost) -> u64 {
    cost.node_visits + cost.primitive_tests + RAY_STEPS * cost.n_rays()
}

/// What a ray takes beside its traversal, in steps of it.
const RAY_STEPS: u64 = 4;
