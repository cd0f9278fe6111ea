//! The time of each tile → the times of its pixels, by their counters.
//!
//! Rays in streams cannot be timed one by one, but tiles can. A linear model explains
//! the tiles' times by their counters: so many nanoseconds per node visit, primitive
//! test and ray of each kind, the same for all tiles, and none negative. Each pixel then
//! gets the share of its tile's time that the model gives it.

use rayon::prelude::*;

use crate::cost::{Cost, Counter};
use crate::film::{Film, Strip};
use crate::schedule::{Schedule, TileRun};
use crate::statistics::non_negative_least_squares;

/// All counters but the depth, which is not work.
const COUNTERS: [Counter; 7] = [
    Counter::NodeVisits,
    Counter::PrimitiveTests,
    Counter::Samples,
    Counter::ShadowRays,
    Counter::ReflectionRays,
    Counter::RefractionRays,
    Counter::DiffuseRays,
];

/// Nanoseconds per event that each of [`COUNTERS`] counts.
type Weights = [f64; COUNTERS.len()];

/// Sets the times of all pixels of a film to their shares of their tiles' times. The
/// pixels of a tile whose thread was interrupted are rejected.
pub(super) fn attribute_time(film: &mut Film, schedule: &Schedule) {
    let weights = fitted(&schedule.runs);
    let scales: Vec<f64> = schedule
        .runs
        .iter()
        .map(|run| scale(run, &weights))
        .collect();
    let mut strips = std::mem::take(&mut film.strips);
    let film_of_tiles = &*film;
    strips.par_iter_mut().for_each_init(
        || (Vec::new(), Vec::new(), Vec::new()),
        |(times, counts, tiles), strip| {
            model_times(film_of_tiles, strip, &weights, times, counts);
            film_of_tiles.tile_numbers(strip, tiles);
            for (i, &tile) in tiles.iter().enumerate() {
                let tile = tile as usize;
                let run = &schedule.runs[tile];
                let least = if run.is_missing { 0.0 } else { 1.0 };
                strip.time_ns[i] = (times[i] * scales[tile]).max(least) as f32;
                strip.n_rejected[i] = run.is_interrupted().into();
            }
        },
    );
    film.strips = strips;
}

/// The weights that explain the tiles' times best: relative errors count, so that cheap
/// tiles weigh as much as expensive ones.
fn fitted(runs: &[TileRun]) -> Weights {
    let rows = |with_interrupted: bool| {
        let is_used =
            move |run: &&TileRun| !run.is_missing && (with_interrupted || !run.is_interrupted());
        runs.iter().filter(is_used).map(|run| {
            let ns = run.rendering_ns().max(1) as f64;
            (terms(&run.counted).map(|count| count / ns), 1.0)
        })
    };
    let weights = non_negative_least_squares(rows(false));
    if weights.iter().any(|&weight| weight > 0.0) {
        return weights;
    }
    non_negative_least_squares(rows(true))
}

/// The measured time of a tile over that of the model; 0 without work.
fn scale(run: &TileRun, weights: &Weights) -> f64 {
    let terms = terms(&run.counted).into_iter().zip(weights);
    let modeled: f64 = terms.map(|(count, weight)| count * weight).sum();
    if modeled > 0.0 {
        run.rendering_ns() as f64 / modeled
    } else {
        0.0
    }
}

fn terms(counted: &Cost) -> Weights {
    COUNTERS.map(|counter| counted.get(counter) as f64)
}

/// Overwrites `times` with what the model gives the pixels of a strip.
fn model_times(
    film: &Film,
    strip: &Strip,
    weights: &Weights,
    times: &mut Vec<f64>,
    counts: &mut Vec<u32>,
) {
    times.clear();
    times.resize(strip.rgb.len(), 0.0);
    for (counter, &weight) in COUNTERS.into_iter().zip(weights) {
        if weight == 0.0 {
            continue;
        }
        film.counter(strip, counter, counts);
        for (time, &count) in times.iter_mut().zip(&*counts) {
            *time += weight * f64::from(count);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;
    use crate::config::{CostMode, TileOrder};
    use crate::cost::Counters;
    use crate::film::PackedCounters;
    use crate::schedule::TileGrid;

    /// A film of tiles of four pixels, and its schedule: each tile took the time that
    /// `ns` gives its counters.
    fn rendered(n_tiles: u32, ns: impl Fn(&Cost) -> u64) -> (Film, Schedule) {
        let grid = TileGrid::new(2 * n_tiles, 2, 2);
        let mut film = Film::new(grid, 3, CostMode::AttributedTime);
        let mut counters = Counters::default();
        let mut runs = Vec::new();
        for number in 0..n_tiles {
            counters.reset(4, film.n_samples);
            for pixel in 0..4 {
                counters.add(pixel as usize, &cost(4 * number + pixel));
            }
            let packed = PackedCounters::new(&counters);
            film.tiles[number as usize].counters.push(packed);
            let counted = counters.total();
            let run = TileRun {
                end_ns: ns(&counted) + 77,
                film_ns: 77,
                counted,
                ..TileRun::default()
            };
            runs.push((number, run));
        }
        let schedule = Schedule::new(grid, TileOrder::Scanline, Instant::now(), vec![runs]);
        (film, schedule)
    }

    /// The cost of a pixel by its position in the order of the tiles.
    fn cost(i: u32) -> Cost {
        let word = u64::from(i.wrapping_mul(2_654_435_761));
        Cost {
            node_visits: word % 97,
            primitive_tests: word >> 8 & 63,
            rays: [3, word >> 16 & 3, word >> 20 & 1, 0, 0],
            depth: 0,
        }
    }

    fn model(cost: &Cost) -> u64 {
        let [camera, shadow, reflection, ..] = cost.rays;
        40 * cost.node_visits
            + 15 * cost.primitive_tests
            + 300 * camera
            + 200 * shadow
            + 500 * reflection
    }

    /// The time of pixel `i` in the order of the tiles.
    fn time_ns(film: &Film, i: u32) -> f32 {
        let (tile, pixel) = (i / 4, i % 4);
        let (x, y) = (2 * tile + pixel % 2, pixel / 2);
        film.strips[0].time_ns[(y * film.grid.width + x) as usize]
    }

    #[test]
    fn pixels_get_what_tiles_like_them_take() {
        let (mut film, schedule) = rendered(50, model);
        attribute_time(&mut film, &schedule);
        for i in 0..200 {
            let [time_ns, expected] = [time_ns(&film, i), model(&cost(i)) as f32];
            assert!(
                (time_ns / expected - 1.0).abs() < 1e-3,
                "{time_ns} {expected}"
            );
        }
    }

    #[test]
    fn the_pixels_of_a_tile_share_its_time() {
        // No linear model explains these.
        let (mut film, mut schedule) = rendered(50, |cost| 1000 + model(cost) % 719);
        schedule.runs[7].waiting_ns = 30;
        attribute_time(&mut film, &schedule);
        for (tile, run) in (0..).zip(&schedule.runs) {
            let sum: f32 = (4 * tile..4 * tile + 4).map(|i| time_ns(&film, i)).sum();
            assert!((sum / run.rendering_ns() as f32 - 1.0).abs() < 1e-3);
        }
        assert_eq!(film.n_rejected(), 4);
        assert_eq!(film.strips[0].n_rejected[14..16], [1, 1]);
    }

    #[test]
    fn a_tile_without_work_takes_no_time() {
        let (mut film, mut schedule) = rendered(2, model);
        schedule.runs.iter_mut().for_each(|run| {
            *run = TileRun {
                waiting_ns: 1,
                ..TileRun::default()
            };
        });
        attribute_time(&mut film, &schedule);
        assert!(film.values(|strip| &strip.time_ns).all(|ns| ns == 1.0));
    }
}
