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

use super::{Report, TilePlan, render};
use math::statistics::median;
use scene::config::CostMode;
use tracer::cost::Meter;
use tracer::trace::Tracer;

/// Rounds of four renderings: each variant has each position equally often.
pub const N_ROUNDS: usize = 8;

/// The number of renderings in [`Overhead::measure`].
pub const N_RENDERINGS: usize = 4 * N_ROUNDS;

/// CPU time of one rendering in milliseconds, summed over all threads, with the allocation of the
/// film: medians of [`N_ROUNDS`] renderings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overhead {
    /// Rays in streams, nothing measured.
    pub none_ms: f64,
    /// Rays in streams, counted.
    pub counters_ms: f64,
    /// Rays in streams, counted, and their waves timed.
    pub time_ms: f64,
    /// Rays one by one, counted, and each pixel timed.
    pub single_ray_ms: f64,
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
    pub fn measure(tracer: Tracer, plan: &TilePlan, report: Report) -> Self {
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
            none_ms,
            counters_ms,
            time_ms,
            single_ray_ms,
        }
    }

    /// Returns the overhead of counters in streams, in percent.
    pub fn counters_percent(&self) -> f64 {
        percent_more(self.counters_ms, self.none_ms)
    }

    /// Returns the overhead of the clock of waves on top of counters, in percent.
    pub fn clock_percent(&self) -> f64 {
        percent_more(self.time_ms, self.counters_ms)
    }

    /// Returns the overhead of both, in percent of streams without measurement.
    pub fn time_percent(&self) -> f64 {
        percent_more(self.time_ms, self.none_ms)
    }

    /// Returns the overhead of tracing and timing rays one by one instead of in counted streams, in
    /// percent; negative if streams are slower.
    pub fn single_ray_percent(&self) -> f64 {
        percent_more(self.single_ray_ms, self.counters_ms)
    }
}

fn percent_more(ms: f64, base_ms: f64) -> f64 {
    100.0 * (ms / base_ms - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_variant_has_its_own_median() {
        let row = |ms: f64| (0..N_ROUNDS).map(|round| ms + round as f64).collect();
        let overhead = Overhead::from_times([row(96.5), row(106.5), row(161.5), row(216.5)]);
        assert_eq!(
            overhead,
            Overhead {
                none_ms: 100.0,
                counters_ms: 110.0,
                time_ms: 165.0,
                single_ray_ms: 220.0,
            }
        );
        let percents = [
            (overhead.counters_percent(), 10.0),
            (overhead.clock_percent(), 50.0),
            (overhead.time_percent(), 65.0),
            (overhead.single_ray_percent(), 100.0),
        ];
        for (percent, expected) in percents {
            assert!((percent - expected).abs() < 1e-9, "{percent}");
        }
    }
}
