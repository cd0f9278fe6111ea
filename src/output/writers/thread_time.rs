//! The breakdown of the threads' time, and what limits the times of pixels.

use super::RenderingView;
use crate::summary::ThreadTime;
use base::numbers::count;
use math::statistics::median;
use render::schedule::{GROUP_PATHS, N_GRIDS, group_sides};
use render::tiles::{LEAST_GRIDS, Repeat};
use tracer::cost::Meter;

/// The relative difference between the times of all pixels and the threads' CPU time beyond which
/// times are doubtful.
const TOLERANCE: f64 = 0.1;

/// Computes the breakdown for a rendering; `None` if there are no times.
pub fn thread_time(rendering: &RenderingView) -> Option<ThreadTime> {
    rendering.meter.clock()?;
    let repeats = rendering.repeats.iter();
    let total = |ns: fn(&Repeat) -> u64| repeats.clone().map(ns).sum::<u64>() as f64;
    let all_apart = repeats.clone().map(|repeat| apart(rendering, repeat));
    let [clock_ns, film_ns] = all_apart.fold([0.0; 2], |sum, parts| {
        [sum[0] + parts[0], sum[1] + parts[1]]
    });
    let time = ThreadTime::new(
        total(|repeat| repeat.busy_ns),
        repeats.clone().filter_map(|repeat| repeat.pixels_ns).sum(),
        clock_ns,
        film_ns,
        total(|repeat| repeat.warm_up_ns),
    );
    Some(ThreadTime {
        waiting_ns: total(|repeat| repeat.waiting_ns),
        ..time
    })
}

/// Returns the nanoseconds of clock readings and of writing to the film, where the times of pixels
/// leave them out.
fn apart(rendering: &RenderingView, repeat: &Repeat) -> [f64; 2] {
    match rendering.meter {
        Meter::SingleRayTime(clock) => {
            let n_readings = rendering.config.image.n_pixels() as f64;
            [n_readings * clock.overhead_ns(), repeat.film_ns as f64]
        }
        _ => [0.0; 2],
    }
}

/// Returns what limits the times: a sentence each, which the terminal, `cost.png`, `heatmap.pvsm` and
/// the summary show. Empty if nothing does, or if there are no times.
pub fn time_notes(rendering: &RenderingView) -> Vec<String> {
    let Some(clock) = rendering.meter.clock() else {
        return Vec::new();
    };
    // The CPU time of a rendering, which the times of pixels should add up to.
    let on_pixels = |repeat: &Repeat| {
        let apart_ns: f64 = apart(rendering, repeat).iter().sum();
        repeat.busy_ns as f64 - repeat.warm_up_ns as f64 - apart_ns
    };
    let mut cpu_ns: Vec<f64> = rendering.repeats.iter().map(on_pixels).collect();
    let cpu_ns = median(&mut cpu_ns).unwrap_or_default();
    let waits = (!clock.has_cpu_time()).then(|| {
        "times include waits for a CPU: the system has no fine clock of CPU time".to_owned()
    });
    let film = rendering.film;
    let has_groups = matches!(rendering.meter, Meter::Time(_)) && film.n_grids < LEAST_GRIDS;
    let of_squares = has_groups.then(|| {
        let sides = group_sides(film.n_samples).map(|side| side.min(film.grid.tile_size));
        squares(sides, !film.counts_samples())
    });
    let notes = [
        doubt(rendering.survey.time_ns, cpu_ns),
        waits,
        of_squares.flatten(),
    ];
    notes.into_iter().flatten().collect()
}

/// Returns the sentence on times that do not add up to the CPU time that was spent on pixels.
fn doubt(pixels_ns: f64, cpu_ns: f64) -> Option<String> {
    let ratio = pixels_ns / cpu_ns;
    let is_doubtful = cpu_ns > 0.0 && (ratio - 1.0).abs() > TOLERANCE;
    is_doubtful.then(|| {
        let percent = 100.0 * ratio;
        format!("times are doubtful: they sum to {percent:.0} % of the threads' CPU time")
    })
}

/// Returns the sentence on groups with these sides, unless they are pixels.
fn squares([width, height]: [u32; 2], can_shrink: bool) -> Option<String> {
    let samples = can_shrink.then(|| format!(" or {} samples", count(GROUP_PATHS.into())));
    let remedies = format!("{N_GRIDS} repeats{}", samples.unwrap_or_default());
    (width * height > 1)
        .then(|| format!("timed in squares of {width} x {height} pixels; {remedies} avoid them"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_that_do_not_add_up_are_doubtful() {
        for ratio in [0.91, 1.0, 1.09] {
            assert_eq!(doubt(ratio * 2e6, 2e6), None);
        }
        let sum = |percent| {
            format!("times are doubtful: they sum to {percent} % of the threads' CPU time")
        };
        assert_eq!(doubt(1.14e6, 2e5), Some(sum(570)));
        assert_eq!(doubt(0.89e6, 1e6), Some(sum(89)));
        // Nothing was rendered.
        assert_eq!(doubt(0.0, 0.0), None);
    }

    #[test]
    fn squares_are_named_with_their_remedies() {
        let all = "timed in squares of 16 x 8 pixels; 5 repeats or 1,024 samples avoid them";
        assert_eq!(squares([16, 8], true).as_deref(), Some(all));
        let one = "timed in squares of 16 x 16 pixels; 5 repeats avoid them";
        assert_eq!(squares([16, 16], false).as_deref(), Some(one));
        assert_eq!(squares([1, 1], true), None);
    }
}
