//! A clock cheap enough to be read for every pixel.
//!
//! On x86-64 with an invariant time stamp counter (Intel SDM vol. 3, 19.17.1) it reads that
//! counter, calibrated once against the operating system's clock; elsewhere it reads the operating
//! system's clock.

use std::time::{Duration, Instant as OsInstant};

use cpu_time::ThreadTime;

#[cfg(target_arch = "x86_64")]
use super::tsc;
use math::statistics::median;

/// Back-to-back readings whose median is the overhead of the clock.
const N_READINGS: usize = 1001;

/// Number of readings of a clock of CPU time, and the least number of its steps in them: with fewer it
/// is too coarse for pixels.
const N_CPU_READINGS: usize = 100;
const LEAST_STEPS: usize = 3;

/// A calibrated clock.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    source: ClockSource,
    /// Cost of one reading.
    overhead_ns: f64,
    has_cpu_time: bool,
}

#[derive(Debug, Clone, Copy)]
enum ClockSource {
    /// The x86-64 time stamp counter.
    #[cfg(target_arch = "x86_64")]
    Tsc { ns_per_tick: f64 },
    /// The operating system's clock, counted from this moment.
    Os { start: OsInstant },
}

/// A reading of the clock.
#[derive(Debug, Clone, Copy)]
pub struct Instant {
    ticks: u64,
}

impl Clock {
    /// Chooses and calibrates the clock; takes about 0.5 ms.
    pub fn calibrated() -> Self {
        let mut clock = Self {
            source: ClockSource::best(),
            ..Self::system()
        };
        clock.overhead_ns = clock.measured_overhead_ns();
        clock
    }

    /// Returns the operating system's clock, which needs no calibration.
    pub fn system() -> Self {
        Self {
            source: ClockSource::Os {
                start: OsInstant::now(),
            },
            overhead_ns: 0.0,
            has_cpu_time: has_cpu_time(),
        }
    }

    /// Reads the clock.
    #[inline]
    pub fn now(&self) -> Instant {
        match self.source {
            #[cfg(target_arch = "x86_64")]
            ClockSource::Tsc { .. } => Instant { ticks: tsc::read() },
            ClockSource::Os { start } => Instant {
                ticks: start.elapsed().as_nanos() as u64,
            },
        }
    }

    /// Returns the nanoseconds from one reading to a later one, less the cost of one reading; at
    /// least 1.
    #[inline]
    pub fn elapsed_ns(&self, from: Instant, to: Instant) -> f32 {
        (self.raw_ns(from, to) - self.overhead_ns).max(1.0) as f32
    }

    /// Returns true if the system has a clock of a thread's CPU time that is fine enough to take
    /// waits for a CPU off times.
    pub fn has_cpu_time(&self) -> bool {
        self.has_cpu_time
    }

    /// Returns the cost of one reading in nanoseconds.
    pub fn overhead_ns(&self) -> f64 {
        self.overhead_ns
    }

    /// Returns the name of the clock's source: `"tsc"` or `"os"`.
    pub fn source_name(&self) -> &'static str {
        match self.source {
            #[cfg(target_arch = "x86_64")]
            ClockSource::Tsc { .. } => "tsc",
            ClockSource::Os { .. } => "os",
        }
    }

    /// Returns the nanoseconds from one reading to a later one.
    #[inline]
    pub(super) fn raw_ns(&self, from: Instant, to: Instant) -> f64 {
        let ticks = to.ticks.saturating_sub(from.ticks) as f64;
        match self.source {
            #[cfg(target_arch = "x86_64")]
            ClockSource::Tsc { ns_per_tick } => ticks * ns_per_tick,
            ClockSource::Os { .. } => ticks,
        }
    }

    /// Returns the median time between two consecutive readings.
    fn measured_overhead_ns(&self) -> f64 {
        let mut gaps: Vec<f64> = (0..N_READINGS)
            .map(|_| {
                let from = self.now();
                self.raw_ns(from, self.now())
            })
            .collect();
        median(&mut gaps).unwrap_or_default()
    }
}

impl ClockSource {
    #[cfg(target_arch = "x86_64")]
    fn best() -> Self {
        if !tsc::is_usable() {
            return Self::Os {
                start: OsInstant::now(),
            };
        }
        Self::Tsc {
            ns_per_tick: tsc::ns_per_tick(),
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn best() -> Self {
        Self::Os {
            start: OsInstant::now(),
        }
    }
}

/// Returns true if the system's clock of this thread's CPU time advances within few readings.
fn has_cpu_time() -> bool {
    let mut last = ThreadTime::now();
    let steps = (0..N_CPU_READINGS).filter(|_| {
        let before = std::mem::replace(&mut last, ThreadTime::now());
        last.duration_since(before) > Duration::ZERO
    });
    steps.take(LEAST_STEPS).count() == LEAST_STEPS
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn it_agrees_with_the_operating_system() {
        let clock = Clock::calibrated();
        // Even if the test is interrupted, the span of the clock lies between the spans of the
        // inner and the outer readings.
        let os = OsInstant::now();
        let [outer_from, from, inner_from] = bracketed_ns(&clock, os);
        std::thread::sleep(Duration::from_millis(20));
        let [inner_to, to, outer_to] = bracketed_ns(&clock, os);
        let ns = to - from;
        let (least, most) = (inner_to - inner_from, outer_to - outer_from);
        assert!(
            0.95 * least < ns && ns < 1.05 * most,
            "{least} < {ns} < {most}"
        );
    }

    /// Reads the clock between two readings of the operating system's clock; in nanoseconds.
    fn bracketed_ns(clock: &Clock, os: OsInstant) -> [f64; 3] {
        let os_ns = || os.elapsed().as_nanos() as f64;
        let before = os_ns();
        let now = clock.now();
        let after = os_ns();
        let zero = Instant { ticks: 0 };
        [before, clock.raw_ns(zero, now), after]
    }

    #[test]
    fn no_time_is_one_nanosecond() {
        let clock = Clock::calibrated();
        let now = clock.now();
        assert_eq!(clock.elapsed_ns(now, now), 1.0);
    }
}
