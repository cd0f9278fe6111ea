//! Estimates how long each tile takes.
//!
//! Rays and their steps take time, and some pixels of each tile show how many there are. How long
//! a ray and a step take depends on the scene, the machine and the mode of cost: a few whole tiles
//! show it, which are rendered as they will be again. The times are those of the threads, which
//! other programs that interrupt them do not lengthen.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use cpu_time::ThreadTime as ThreadClock;

use super::canvas::Canvas;
use super::prepass::{self, RayCounts, ray_counts};
use super::stream::StreamRenderer;
use super::timed::SingleRayRenderer;
use super::view::View;
use super::{TilePlan, TileRenderer, render_tile};
use crate::accel::Accel;
use crate::cost::{Counters, Meter};
use crate::film::Film;
use crate::scene::Scene;
use crate::schedule::Tile;
use crate::statistics::non_negative_least_squares;
use crate::stop;

/// Tiles for each that is measured, and the least and the greatest number of these.
const PER_MEASURED: usize = 64;
const LEAST_MEASURED: usize = 32;
const MOST_MEASURED: usize = 512;

/// The counts of a tile's rays, and the time that they took in nanoseconds.
type MeasuredTile = (RayCounts, f64);

/// The plan with the estimated time of each tile on this machine, in nanoseconds but for a common
/// factor. Renders some tiles on the current rayon pool.
pub fn estimate_times(plan: TilePlan, (scene, accel): (&Scene, &Accel), meter: &Meter) -> TilePlan {
    let counts = prepass::counts(scene, accel, &plan.image, &plan.grid);
    let chosen = chosen(plan.sequence(), &counts);
    let tiles: Vec<Tile> = chosen.iter().map(|&n| plan.grid.tile(n)).collect();
    let film = plan.film_without_rows(scene, meter.mode());
    let view = View::new(scene, accel, &plan.image);
    let measured = match meter {
        Meter::Time(clock) => {
            let renderer = || SingleRayRenderer::new(view, Some(clock), plan.room());
            measured(&film, &plan, &tiles, renderer)
        }
        Meter::Off | Meter::Counters | Meter::AttributedTime(_) => {
            let renderer = || StreamRenderer::<Counters>::new(view);
            measured(&film, &plan, &tiles, renderer)
        }
    };
    let ns_per_count = fitted(&measured);
    let ns_of = |counts: &RayCounts| -> f64 {
        let terms = counts.iter().zip(ns_per_count);
        terms.map(|(count, ns)| count * ns).sum()
    };
    let times = counts.iter().map(ns_of).collect();
    plan.with_times(times)
}

/// Some of the tiles: as many cheap ones as there are, and as many expensive ones as they have
/// work.
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
fn measured<R: TileRenderer>(
    film: &Film,
    plan: &TilePlan,
    tiles: &[Tile],
    renderer: impl Fn() -> R + Sync,
) -> Vec<MeasuredTile> {
    let n_taken = AtomicUsize::new(0);
    let measure_some = |_: rayon::BroadcastContext| {
        let mut renderer = renderer();
        let mut film = film.of_one_tile();
        let canvas = Canvas::of_one_tile(&mut film);
        let mut measured = Vec::new();
        while let Some(tile) = tiles.get(n_taken.fetch_add(1, Ordering::Relaxed)) {
            // The first tile of a thread is rendered twice: its memory is new.
            let n_renderings = if measured.is_empty() { 2 } else { 1 };
            for i in 1..=n_renderings {
                let begin = ThreadClock::now();
                let run = render_tile(&mut renderer, (plan, tile), &canvas, Instant::now());
                if i == n_renderings && !stop::is_requested() {
                    let ns = begin.elapsed().as_nanos() as f64;
                    measured.push((ray_counts(&run.counted), ns));
                }
            }
        }
        measured
    };
    rayon::broadcast(measure_some).concat()
}

/// The time of each count, so that the errors of tiles are least for the work that they have:
/// cheap tiles are as right as expensive ones.
fn fitted(measured: &[MeasuredTile]) -> RayCounts {
    let rows = measured.iter().map(|(counts, ns)| {
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

    #[test]
    fn counts_are_fitted_to_times() {
        let ns = [20.0, 9.0, 2.5, 4.0];
        let counts = |i: u32| {
            let [others, visits, tests] = [i * i, 100 + i * 40 % 71, i * 17 % 53];
            [256, others, visits, tests].map(f64::from)
        };
        let time = |counts: RayCounts| counts.iter().zip(ns).map(|(n, ns)| n * ns).sum();
        let measured: Vec<_> = (0..24).map(|i| (counts(i), time(counts(i)))).collect();
        for (found, expected) in fitted(&measured).into_iter().zip(ns) {
            assert!((found - expected).abs() < 1e-3, "{found}");
        }
        assert_eq!(fitted(&[]), [1.0; 4]);
    }
}
