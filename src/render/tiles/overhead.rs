//! The overhead of cost measurement.
//!
//! The same picture is rendered by four variants in turn, so that a drift of the machine affects
//! all of them equally. Each variant adds one thing: first rays in streams without measurement,
//! then counters, then the clock of waves. The last one traces rays one by one, and reads the clock
//! for each pixel.
//!
//! CPU times are compared: other running programs may double the wall time, but hardly change the
//! CPU time.

use std::hint::black_box;

use cpu_time::ProcessTime;
use serde::{Deserialize, Serialize};

use super::{OnProgress, TilePlan, render};
use math::statistics::median;
use scene::config::CostMode;
use tracer::cost::Meter;
use tracer::trace::Tracer;

/// Rounds of four renderings: each variant has each position equally often.
pub const N_ROUNDS: usize = 8;

/// The number of renderings in [`Overhead::measure`].
pub const N_RENDERINGS: usize = 4 * N_ROUNDS;

/// The overhead of measurement: CPU time of one rendering in milliseconds, summed over all threads,
/// with the allocation of the film, and differences in percent. A percentage of zero time is null in
/// JSON.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Overhead {
    /// Rounds of renderings, whose medians follow.
    pub rounds: usize,
    /// Rays in streams, not measured.
    pub none_ms: f64,
    /// Rays in streams, counted.
    pub counters_ms: f64,
    /// Rays in streams, counted, and waves timed.
    pub time_ms: f64,
    /// Single rays, counted, and each pixel timed.
    pub single_ray_ms: f64,
    /// The overhead of counters in streams.
    pub counters_percent: Option<f64>,
    /// The additional overhead of timing waves.
    pub clock_percent: Option<f64>,
    /// The overhead of both.
    pub time_percent: Option<f64>,
    /// The overhead of tracing and timing single rays instead of counted streams; negative if streams
    /// are slower.
    pub single_ray_percent: Option<f64>,
}

/// The modes in the order of [`Overhead`]'s times.
const MODES: [CostMode; 4] = [
    CostMode::None,
    CostMode::Counters,
    CostMode::Time,
    CostMode::SingleRayTime,
];

impl Overhead {
    /// Renders the picture [`N_RENDERINGS`] times on the current rayon pool.
    pub fn measure(tracer: Tracer, plan: &TilePlan, report: OnProgress) -> Self {
        let meters = MODES.map(Meter::new);
        let mut times_ms: [Vec<f64>; 4] = Default::default();
        for round in 0..N_ROUNDS {
            for turn in 0..meters.len() {
                let mode = (round + turn) % meters.len();
                let begin = ProcessTime::now();
                let (film, _) = render(tracer, plan, &meters[mode], report);
                times_ms[mode].push(begin.elapsed().as_secs_f64() * 1e3);
                // Freed outside of the measured time.
                drop(black_box(film));
            }
        }
        Self::from_times(times_ms)
    }

    /// Computes the medians; `times_ms` has one entry per field, in order.
    fn from_times(times_ms: [Vec<f64>; 4]) -> Self {
        let [none_ms, counters_ms, time_ms, single_ray_ms] =
            times_ms.map(|mut times_ms| median(&mut times_ms).unwrap_or_default());
        Self {
            rounds: N_ROUNDS,
            none_ms,
            counters_ms,
            time_ms,
            single_ray_ms,
            counters_percent: percent_more(counters_ms, none_ms),
            clock_percent: percent_more(time_ms, counters_ms),
            time_percent: percent_more(time_ms, none_ms),
            single_ray_percent: percent_more(single_ray_ms, counters_ms),
        }
    }
}

fn percent_more(ms: f64, base_ms: f64) -> Option<f64> {
    Some(100.0 * (ms / base_ms - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_variant_has_its_own_median() {
        let row = |ms: f64| (0..N_ROUNDS).map(|round| ms + round as f64).collect();
        let overhead = Overhead::from_times([row(96.5), row(106.5), row(161.5), row(216.5)]);
        let times_ms = [
            overhead.none_ms,
            overhead.counters_ms,
            overhead.time_ms,
            overhead.single_ray_ms,
        ];
        assert_eq!(times_ms, [100.0, 110.0, 165.0, 220.0]);
        let percents = [
            (overhead.counters_percent, 10.0),
            (overhead.clock_percent, 50.0),
            (overhead.time_percent, 65.0),
            (overhead.single_ray_percent, 100.0),
        ];
        for (percent, expected) in percents {
            assert!((percent.unwrap() - expected).abs() < 1e-9, "{percent:?}");
        }
    }
}
