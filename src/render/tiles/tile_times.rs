//! Estimates of the time of each tile.
//!
//! Rays and their steps take time, and some pixels of each tile show how many there are. The time
//! of a ray and of a step depends on the scene, the machine and the mode of cost: it is measured by
//! rendering a few whole tiles as they will be rendered again. The times are thread times, which
//! other programs that interrupt them do not lengthen. Rays with the same counts differ in time,
//! too, by how coherent they are and by the look of their surfaces: the times of tiles are
//! corrected by how much longer measured ones nearby took than expected, by inverse distance
//! weighting (Shepard 1968, "A two-dimensional interpolation function for irregularly-spaced
//! data").

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use glam::DVec3;
use rayon::prelude::*;

use super::canvas::Canvas;
use super::prepass::{self, RayCounts, ray_counts};
use super::view::View;
use super::{TilePlan, TileRenderer, render_tile, renderer};
use crate::film::Film;
use crate::schedule::Tile;
use base::stop;
use math::statistics::non_negative_least_squares;
use tracer::cost::Meter;
use tracer::trace::Tracer;

/// Tiles for each that is measured, and the least and the greatest number of measured tiles.
const PER_MEASURED: usize = 64;
const LEAST_MEASURED: usize = 32;
const MOST_MEASURED: usize = 512;

/// A tile that was rendered.
#[derive(Debug, Clone, Copy)]
struct MeasuredTile {
    tile: Tile,
    counts: RayCounts,
    /// Time that its rays took in nanoseconds.
    ns: f64,
}

/// Returns the plan with the estimated time of each tile on this machine, in nanoseconds up to a
/// common factor. Renders some tiles on the current rayon pool.
pub fn estimate_times(plan: TilePlan, tracer: Tracer, meter: &Meter) -> TilePlan {
    let counts = prepass::counts(tracer, &plan.sensor, &plan.grid);
    let chosen = chosen(plan.sequence(), &counts);
    let tiles: Vec<Tile> = chosen.iter().map(|&n| plan.grid.tile(n)).collect();
    let film = plan.film_without_rows(tracer.scene, meter.mode());
    let view = View::new(tracer, &plan.sensor);
    // Streams take the same time for a ray whether it is counted or not.
    let meter = match meter {
        Meter::Off => &Meter::Counters,
        meter => meter,
    };
    let measured = measured(&film, &plan, &tiles, || renderer(view, meter, &plan));
    let ns_per_count = fitted(&measured);
    let ns_of = |counts: &RayCounts| -> f64 {
        let terms = counts.iter().zip(ns_per_count);
        terms.map(|(count, ns)| count * ns).sum()
    };
    let correction = Correction::new(&measured, plan.n_tiles(), ns_of);
    let numbers = 0..counts.len() as u32;
    let times = numbers
        .into_par_iter()
        .zip(&counts)
        .map(|(number, counts)| {
            let ns = ns_of(counts);
            ns * correction.factor(&plan.grid.tile(number), ns)
        });
    let times = times.collect();
    plan.with_times(times)
}

/// Factors by which measured tiles took longer than expected.
struct Correction {
    /// The position of each tile, and its expected time over its measured time: close to 0, and so
    /// nearly without effect, if its thread was disturbed.
    measured: Vec<(DVec3, f64)>,
    /// The distance of neighboring measured tiles in pixels.
    spacing: f64,
}

impl Correction {
    /// Compares measured tiles with `ns_of`, which returns the time expected of counts, in
    /// nanoseconds.
    fn new(measured: &[MeasuredTile], n_tiles: u32, ns_of: impl Fn(&RayCounts) -> f64) -> Self {
        let n_pixels: usize = measured.iter().map(|it| it.tile.n_pixels()).sum();
        let n = measured.len().max(1) as f64;
        let spacing = (f64::from(n_tiles) / n * n_pixels as f64 / n).sqrt();
        let of_tile = |it: &MeasuredTile| {
            let expected = ns_of(&it.counts);
            (
                place(&it.tile, spacing, expected),
                expected / it.ns.max(1.0),
            )
        };
        Self {
            measured: measured.iter().map(of_tile).collect(),
            spacing,
        }
    }

    /// Returns the factor by which a tile takes longer than expected: a mean over measured tiles,
    /// where tiles nearby with about the same expected time count the most.
    fn factor(&self, tile: &Tile, expected: f64) -> f64 {
        let here = place(tile, self.spacing, expected);
        let (mut speeds, mut weights) = (0.0, 0.0);
        for (there, speed) in &self.measured {
            let weight = (1.0 + here.distance_squared(*there)).powi(-2);
            speeds += weight * speed;
            weights += weight;
        }
        if speeds > 0.0 { weights / speeds } else { 1.0 }
    }
}

/// Returns the middle of a tile in units of the spacing, and the binary logarithm of its expected
/// time.
fn place(tile: &Tile, spacing: f64, expected: f64) -> DVec3 {
    let [x, y] = [tile.columns, tile.rows].map(|[first, end]| f64::from(first + end) / 2.0);
    DVec3::new(x / spacing, y / spacing, expected.max(1.0).log2())
}

/// Chooses tiles to be measured: cheap ones in proportion to their number, expensive ones in
/// proportion to their work.
fn chosen(sequence: &[u32], counts: &[RayCounts]) -> Vec<u32> {
    let work = |number: u32| counts[number as usize].iter().sum::<f64>();
    let mut numbers = sequence.to_vec();
    numbers.sort_by(|&a, &b| work(a).total_cmp(&work(b)));
    let n_wanted = (numbers.len() / PER_MEASURED).clamp(LEAST_MEASURED, MOST_MEASURED);
    let all: f64 = numbers.iter().map(|&number| work(number)).sum();
    let (n, mut share, mut chosen) = (numbers.len() as f64, 0.0, Vec::new());
    for number in numbers {
        share += 0.5 * (work(number) / all.max(1.0) + 1.0 / n);
        if share * n_wanted as f64 >= chosen.len() as f64 + 0.5 {
            chosen.push(number);
        }
    }
    chosen
}

/// Renders tiles and forgets their pixels.
fn measured<'a>(
    film: &Film,
    plan: &TilePlan,
    tiles: &[Tile],
    renderer: impl Fn() -> Box<dyn TileRenderer + 'a> + Sync,
) -> Vec<MeasuredTile> {
    let n_taken = AtomicUsize::new(0);
    let measure_some = |_: rayon::BroadcastContext| {
        let mut renderer = renderer();
        let mut film = film.empty_tile();
        let canvas = Canvas::one_tile(&mut film, plan.grid);
        let mut measured = Vec::new();
        while let Some(tile) = tiles.get(n_taken.fetch_add(1, Ordering::Relaxed)) {
            // The first tile of a thread is rendered twice: its memory is new.
            let n_renderings = if measured.is_empty() { 2 } else { 1 };
            for i in 1..=n_renderings {
                let begin = Instant::now();
                let run = render_tile(&mut *renderer, plan, tile, &canvas, begin);
                if i == n_renderings && !stop::is_requested() {
                    measured.push(MeasuredTile {
                        tile: *tile,
                        counts: ray_counts(&run.counted),
                        ns: run.busy_ns() as f64,
                    });
                }
            }
        }
        measured
    };
    rayon::broadcast(measure_some).concat()
}

/// Returns the time of each count that minimizes the errors of tiles relative to their work: cheap
/// tiles are as accurate as expensive ones.
fn fitted(measured: &[MeasuredTile]) -> RayCounts {
    let rows = measured.iter().map(|MeasuredTile { counts, ns, .. }| {
        let weight = ns.max(1.0).recip();
        (counts.map(|count| weight * count), weight * ns)
    });
    let fitted = non_negative_least_squares(rows);
    if fitted.iter().any(|&ns| ns > 0.0) {
        fitted
    } else {
        [1.0; 4]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::TileGrid;

    #[test]
    fn tiles_are_chosen_by_number_and_by_work() {
        // One tile in a hundred has nine tenths of the work.
        let work = |i: u32| if i.is_multiple_of(100) { 891.0 } else { 1.0 };
        let counts: Vec<RayCounts> = (0..6400).map(|i| [0.0, 0.0, work(i), 0.0]).collect();
        let sequence: Vec<u32> = (0..6400).rev().collect();
        let chosen = chosen(&sequence, &counts);
        assert_eq!(chosen.len(), 100);
        let n_expensive = chosen.iter().filter(|i| i.is_multiple_of(100)).count();
        assert!((44..=46).contains(&n_expensive), "{n_expensive}");
    }

    /// Returns a tile of a picture with eight in a row.
    fn tile(number: u32) -> Tile {
        TileGrid::new(128, 128, 16).tile(number)
    }

    #[test]
    fn times_are_corrected_by_those_of_neighbors() {
        // Tiles in the upper half take twice as long as counted.
        let measured = |number| MeasuredTile {
            tile: tile(number),
            counts: [100.0, 0.0, 0.0, 0.0],
            ns: if number < 32 { 2000.0 } else { 1000.0 },
        };
        let measured: Vec<_> = (0..64).step_by(3).map(measured).collect();
        let correction = Correction::new(&measured, 64, |counts| 10.0 * counts[0]);
        let factor = |number| correction.factor(&tile(number), 1000.0);
        assert!(factor(1) > 1.7, "{}", factor(1));
        assert!(factor(62) < 1.3, "{}", factor(62));
        let mut disturbed = measured.clone();
        disturbed[5].ns *= 1000.0;
        let disturbed = Correction::new(&disturbed, 64, |counts| 10.0 * counts[0]);
        for number in 0..64 {
            let factor = disturbed.factor(&tile(number), 1000.0) / factor(number);
            assert!((1.0..2.5).contains(&factor), "{factor}");
        }
        let none = Correction::new(&[], 64, |_| 1.0);
        assert_eq!(none.factor(&tile(1), 1000.0), 1.0);
    }

    #[test]
    fn counts_are_fitted_to_times() {
        let ns = [20.0, 9.0, 2.5, 4.0];
        let counts = |i: u32| {
            let [others, visits, tests] = [i * i, 100 + i * 40 % 71, i * 17 % 53];
            [256, others, visits, tests].map(f64::from)
        };
        let time = |counts: RayCounts| counts.iter().zip(ns).map(|(n, ns)| n * ns).sum();
        let measured = |i| MeasuredTile {
            tile: tile(i),
            counts: counts(i),
            ns: time(counts(i)),
        };
        let measured: Vec<_> = (0..24).map(measured).collect();
        for (found, expected) in fitted(&measured).into_iter().zip(ns) {
            assert!((found - expected).abs() < 1e-3, "{found}");
        }
        assert_eq!(fitted(&[]), [1.0; 4]);
    }
}
