//! Estimates the work of each tile from some of its pixels.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::stream::StreamRenderer;
use super::view::View;
use crate::schedule::{Tile, TileGrid};
use scene::build::Sensor;
use scene::config::{ExtraArrays, Image};
use tracer::cost::{Cost, Counters, RayKind};
use tracer::trace::Tracer;

/// Distance of probed pixels in columns and rows.
const STEP: u32 = 8;
/// Distance of probed pixels where each gets all samples of the picture.
const WIDE_STEP: u32 = 32;

/// Greatest number of pixels that are traced at a time, unless one tile has more: enough for a
/// stream, few enough that the threads share the work of a small picture.
const CHUNK_LEN: u32 = 512;

/// Estimates the work of each tile in traversal steps: one sample of some of its pixels, at least
/// one, extrapolated to all of them. It is counted, not timed, and so does not depend on the run or
/// the number of threads.
pub(super) fn work(tracer: Tracer, sensor: &Sensor, grid: &TileGrid) -> Vec<u64> {
    let view = View::new(tracer, &with_one_sample(sensor));
    let n_probed = grid.tile_size.div_ceil(STEP).pow(2);
    let renderer = || StreamRenderer::<Counters>::new(view);
    chunks(grid, n_probed, renderer, |renderer, tiles| {
        steps_of_tiles(renderer, tiles, STEP)
    })
}

/// Estimates the counts of the rays of each tile by about one camera ray in 64, from at least one
/// pixel: with one sample, or with the samples that a limit of noise gives it.
pub(super) fn counts(tracer: Tracer, sensor: &Sensor, grid: &TileGrid) -> Vec<RayCounts> {
    let image = &sensor.image;
    let n_samples = f64::from(image.samples_per_pixel);
    let limit = image.adaptive.and_then(|adaptive| adaptive.noise);
    let (sensor, step, factor) = match limit {
        None => {
            let step = (f64::from(STEP) / n_samples.sqrt()).max(1.0) as u32;
            (with_one_sample(sensor), step.next_power_of_two(), n_samples)
        }
        Some(_) => (*sensor, WIDE_STEP, 1.0),
    };
    let view = View::new(tracer, &sensor);
    let n_probed = grid.tile_size.div_ceil(step).pow(2);
    let renderer = || StreamRenderer::<Counters>::new(view);
    chunks(grid, n_probed, renderer, |renderer, tiles| {
        let costs = costs_of_tiles(renderer, tiles, step);
        let of_tile = |(tile, (cost, n_probed)): (&Tile, (Cost, usize))| {
            let factor = factor * tile.n_pixels() as f64 / n_probed as f64;
            ray_counts(&cost).map(|count| count * factor)
        };
        tiles.iter().zip(costs).map(of_tile).collect()
    })
}

/// The counts that determine the time: camera rays, other rays, and the node visits and primitive
/// tests of all.
pub(super) type RayCounts = [f64; 4];

/// Returns the counts of a cost.
pub(super) fn ray_counts(cost: &Cost) -> RayCounts {
    let camera = cost.rays_of(RayKind::Camera);
    let others = cost.n_rays() - camera;
    [camera, others, cost.node_visits, cost.primitive_tests].map(|count| count as f64)
}

fn with_one_sample(sensor: &Sensor) -> Sensor {
    let image = Image {
        samples_per_pixel: 1,
        adaptive: None,
        ..sensor.image
    };
    Sensor {
        image,
        extra_arrays: ExtraArrays::default(),
        ..*sensor
    }
}

/// Calls `of_chunk` with the tiles of the grid, some at a time, with `n_probed` pixels of each, on
/// the current rayon pool. Returns the results of all tiles.
pub(super) fn chunks<R, T: Send>(
    grid: &TileGrid,
    n_probed: u32,
    renderer: impl Fn() -> R + Sync,
    of_chunk: impl Fn(&mut R, &[Tile]) -> Vec<T> + Sync,
) -> Vec<T> {
    let n_per_chunk = (CHUNK_LEN / n_probed).max(1);
    let chunks = (0..grid.n_tiles()).step_by(n_per_chunk as usize);
    let chunks: Vec<Range<u32>> = chunks
        .map(|first| first..grid.n_tiles().min(first + n_per_chunk))
        .collect();
    let n_taken = AtomicUsize::new(0);
    let some_chunks = |_: rayon::BroadcastContext| {
        let mut renderer = renderer();
        let mut done = Vec::new();
        while let Some(numbers) = chunks.get(n_taken.fetch_add(1, Ordering::Relaxed)) {
            let tiles: Vec<Tile> = numbers.clone().map(|number| grid.tile(number)).collect();
            done.push((numbers.start, of_chunk(&mut renderer, &tiles)));
        }
        done
    };
    let mut done: Vec<(u32, Vec<T>)> = rayon::broadcast(some_chunks)
        .into_iter()
        .flatten()
        .collect();
    done.sort_unstable_by_key(|&(first, _)| first);
    done.into_iter().flat_map(|(_, results)| results).collect()
}

/// Traces the probed pixels of tiles. Returns the steps of each tile.
fn steps_of_tiles(renderer: &mut StreamRenderer<Counters>, tiles: &[Tile], step: u32) -> Vec<u64> {
    let costs = costs_of_tiles(renderer, tiles, step);
    let of_tile = |(tile, (cost, n_probed)): (&Tile, (Cost, usize))| {
        steps(cost) * tile.n_pixels() as u64 / n_probed as u64
    };
    tiles.iter().zip(costs).map(of_tile).collect()
}

/// Traces the probed pixels of tiles. Returns their cost and their number for each tile.
fn costs_of_tiles(
    renderer: &mut StreamRenderer<Counters>,
    tiles: &[Tile],
    step: u32,
) -> Vec<(Cost, usize)> {
    let places = tiles.iter().flat_map(|tile| probed_pixels(tile, step));
    renderer.follow((0..).zip(places));
    let counters = renderer.probe();
    let mut pixels = 0..;
    let of_tile = |tile| {
        let n_probed = probed_pixels(tile, step).count();
        let probed = pixels.by_ref().take(n_probed);
        let cost = probed.map(|pixel| counters.pixel(pixel)).reduce(Cost::with);
        (cost.unwrap_or_default(), n_probed)
    };
    tiles.iter().map(of_tile).collect()
}

/// Returns the probed pixels of a tile.
pub(super) fn probed_pixels(tile: &Tile, step: u32) -> impl Iterator<Item = (u32, u32)> + use<> {
    let places = move |[first, end]: [u32; 2]| {
        // The middle of each step, or of a shorter tile.
        let middle = first + step.min(end - first) / 2;
        (middle..end).step_by(step as usize)
    };
    let columns = places(tile.columns);
    places(tile.rows).flat_map(move |y| columns.clone().map(move |x| (x, y)))
}

/// Returns the traversal steps of rays, with [`RAY_STEPS`] for each ray.
fn steps(cost: Cost) -> u64 {
    cost.node_visits + cost.primitive_tests + RAY_STEPS * cost.n_rays()
}

/// Work per ray outside of its traversal, in traversal steps.
const RAY_STEPS: u64 = 4;
