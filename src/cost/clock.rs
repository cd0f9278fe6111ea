//! A clock cheap enough to be read for every pixel.
//!
//! On x86-64 with an invariant time stamp counter (Intel SDM vol. 3, 19.17.1)
//! it reads that counter, calibrated once against the operating system's
//! clock; elsewhere it reads the operating system's clock itself.
//!
//! A reading also holds the CPU of the thread: a time during which the thread
//! migrated to another CPU includes the migration and its cache misses.

use std::time::Instant as OsInstant;

use super::cpu;
use crate::statistics::median;

/// Duration of the calibration. The operating system's clock is accurate to
/// about 50 ns, so that the rate is accurate to 0.01 % after 0.5 ms.
#[cfg(target_arch = "x86_64")]
const CALIBRATION: std::time::Duration = std::time::Duration::from_micros(500);

/// Comparisons of both clocks at each end of the calibration. The one with the
/// least time between its readings is used: an interrupt may delay the others.
#[cfg(target_arch = "x86_64")]
const N_COMPARISONS: usize = 4;

/// Back-to-back readings whose median is the overhead of the clock.
const N_READINGS: usize = 1001;

/// A calibrated clock.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    source: Source,
    /// Cost of one reading.
    overhead_ns: f64,
}

#[derive(Debug, Clone, Copy)]
enum Source {
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
    /// The CPU that the thread ran on; always 0 where the system does not report
    /// it.
    cpu: u32,
}

impl Instant {
    /// Whether both readings were made on the same CPU; true where the system
    /// does not report CPUs.
    #[inline]
    pub fn is_on_cpu_of(self, other: Self) -> bool {
        self.cpu == other.cpu
    }
}

impl Clock {
    /// Chooses and calibrates the clock; takes about 0.5 ms.
    pub fn calibrated() -> Self {
        let mut clock = Self {
            source: Source::best(),
            overhead_ns: 0.0,
        };
        clock.overhead_ns = clock.measured_overhead_ns();
        clock
    }

    /// Reads the clock.
    #[inline]
    pub fn now(&self) -> Instant {
        match self.source {
            #[cfg(target_arch = "x86_64")]
            Source::Tsc { .. } => {
                let (ticks, cpu) = tsc::read();
                Instant { ticks, cpu }
            }
            Source::Os { start } => Instant {
                ticks: start.elapsed().as_nanos() as u64,
                cpu: cpu::current(),
            },
        }
    }

    /// Returns the nanoseconds from one reading to a later one, less the cost of
    /// one reading; at least 1.
    #[inline]
    pub fn elapsed_ns(&self, from: Instant, to: Instant) -> f32 {
        (self.raw_ns(from, to) - self.overhead_ns).max(1.0) as f32
    }

    /// The cost of one reading in nanoseconds.
    pub fn overhead_ns(&self) -> f64 {
        self.overhead_ns
    }

    /// The name of its source: `"tsc"` or `"os"`.
    pub fn source_name(&self) -> &'static str {
        match self.source {
            #[cfg(target_arch = "x86_64")]
            Source::Tsc { .. } => "tsc",
            Source::Os { .. } => "os",
        }
    }

    fn raw_ns(&self, from: Instant, to: Instant) -> f64 {
        let ticks = to.ticks.saturating_sub(from.ticks) as f64;
        match self.source {
            #[cfg(target_arch = "x86_64")]
            Source::Tsc { ns_per_tick } => ticks * ns_per_tick,
            Source::Os { .. } => ticks,
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

impl Source {
    #[cfg(target_arch = "x86_64")]
    fn best() -> Self {
        if !tsc::is_usable() {
            return Self::Os {
                start: OsInstant::now(),
            };
        }
        let start = OsInstant::now();
        let ns_per_tick = ns_per_tick(|| {
            let (before, _) = tsc::read();
            let os = start.elapsed();
            let (after, _) = tsc::read();
            Comparison { before, os, after }
        });
        Self::Tsc { ns_per_tick }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn best() -> Self {
        Self::Os {
            start: OsInstant::now(),
        }
    }
}

/// A reading of the operating system's clock between two of the counter.
#[cfg(target_arch = "x86_64")]
#[derive(Debug, Clone, Copy)]
struct Comparison {
    before: u64,
    os: std::time::Duration,
    after: u64,
}

#[cfg(target_arch = "x86_64")]
impl Comparison {
    /// Returns the comparison with the smallest gap, each made right after a tick
    /// of the operating system's clock, which may be coarse.
    fn closest(compare: &mut impl FnMut() -> Self) -> Self {
        let mut after_tick = || {
            let first = compare();
            loop {
                let next = compare();
                if next.os > first.os {
                    return next;
                }
            }
        };
        let mut best = after_tick();
        for _ in 1..N_COMPARISONS {
            let next = after_tick();
            if next.gap() < best.gap() {
                best = next;
            }
        }
        best
    }

    fn gap(self) -> u64 {
        self.after.saturating_sub(self.before)
    }

    fn middle(self) -> u64 {
        self.before + self.gap() / 2
    }
}

/// Measures the counter's period with `compare` for about [`CALIBRATION`].
#[cfg(target_arch = "x86_64")]
fn ns_per_tick(mut compare: impl FnMut() -> Comparison) -> f64 {
    let start = Comparison::closest(&mut compare);
    loop {
        let end = Comparison::closest(&mut compare);
        let elapsed = end.os.saturating_sub(start.os);
        if elapsed >= CALIBRATION {
            let n_ticks = end.middle().saturating_sub(start.middle());
            return elapsed.as_nanos() as f64 / n_ticks.max(1) as f64;
        }
    }
}

#[cfg(target_arch = "x86_64")]
mod tsc {
    use std::arch::x86_64::{__cpuid, __rdtscp};

    /// Whether the counter is invariant and RDTSCP is available: CPUID leaf
    /// 0x80000007, EDX bit 8, and leaf 0x80000001, EDX bit 27.
    pub(super) fn is_usable() -> bool {
        let has = |leaf: u32, bit: u32| {
            __cpuid(0x8000_0000).eax >= leaf && __cpuid(leaf).edx & (1 << bit) != 0
        };
        has(0x8000_0007, 8) && has(0x8000_0001, 27)
    }

    /// Reads the counter and IA32_TSC_AUX, which on Linux, macOS and Windows
    /// identifies the CPU.
    ///
    /// RDTSCP waits for all earlier instructions, so that no load of a pixel
    /// adds to the time of the next one. This takes a few nanoseconds more than
    /// RDTSC (`cargo bench --bench clock`).
    #[inline]
    #[expect(unsafe_code, reason = "the instruction has no safe wrapper")]
    pub(super) fn read() -> (u64, u32) {
        let mut cpu = 0;
        // SAFETY: `is_usable` has found RDTSCP, which only writes to `cpu`.
        let ticks = unsafe { __rdtscp(&mut cpu) };
        (ticks, cpu)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn it_agrees_with_the_operating_system() {
        let clock = Clock::calibrated();
        // Even if the test is interrupted, the span of the clock lies between
        // those of the inner and the outer readings.
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

    /// Reads the clock between two readings of the operating system's; in
    /// nanoseconds.
    fn bracketed_ns(clock: &Clock, os: OsInstant) -> [f64; 3] {
        let os_ns = || os.elapsed().as_nanos() as f64;
        let before = os_ns();
        let now = clock.now();
        let after = os_ns();
        let zero = Instant { ticks: 0, ..now };
        [before, clock.raw_ns(zero, now), after]
    }

    /// Simulates a counter of 3 GHz and a coarse clock of the operating system,
    /// read by a thread that is interrupted for 10 ms now and then.
    #[cfg(target_arch = "x86_64")]
    #[test]
    fn calibration_is_robust_to_interrupts_and_coarse_clocks() {
        for (step_ns, n_undisturbed) in [(1, 7), (1, 1000), (1000, 5), (1_000_000, u64::MAX)] {
            let (mut ns, mut n_readings) = (0_u64, 0_u64);
            let mut read = || {
                n_readings += 1;
                let is_interrupted = n_readings.is_multiple_of(n_undisturbed);
                ns += if is_interrupted { 10_000_000 } else { 25 };
                ns
            };
            let found = ns_per_tick(|| Comparison {
                before: 3 * read(),
                os: Duration::from_nanos(read() / step_ns * step_ns),
                after: 3 * read(),
            });
            assert!((3.0 * found - 1.0).abs() < 1e-2, "{step_ns}: {found}");
        }
    }

    #[test]
    fn readings_hold_the_cpu() {
        let clock = Clock::calibrated();
        // The thread may migrate in between, but not ten times in a row.
        let stays = || clock.now().is_on_cpu_of(clock.now());
        assert!((0..10).any(|_| stays()));
        let here = Instant { ticks: 1, cpu: 0 };
        let there = Instant { ticks: 2, cpu: 1 };
        assert!(here.is_on_cpu_of(here) && !here.is_on_cpu_of(there));
    }

    #[test]
    fn no_time_is_one_nanosecond() {
        let clock = Clock::calibrated();
        let now = clock.now();
        assert_eq!(clock.elapsed_ns(now, now), 1.0);
    }
}
