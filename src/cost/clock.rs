//! A clock cheap enough to read twice a pixel.
//!
//! On x86-64 with an invariant time stamp counter (Intel SDM vol. 3, 19.17.1)
//! it reads that counter, calibrated once against the operating system's
//! clock; elsewhere it reads the operating system's clock itself.
//!
//! A reading also tells which CPU the thread is on: a time during which it
//! moved to another holds the move, cold caches included.

use std::time::Instant as OsInstant;

use super::cpu;

/// How long the calibration waits. The operating system's clock is good to
/// about 50 ns, so that 0.5 ms make the rate good to 0.01 %.
#[cfg(target_arch = "x86_64")]
const CALIBRATION: std::time::Duration = std::time::Duration::from_micros(500);

/// How many back-to-back readings the clock's own cost is the median of.
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
    /// The CPU that the thread was on; always 0 where that is not told.
    cpu: u32,
}

impl Instant {
    /// Whether both readings were made on the same CPU, as far as that is told.
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

    /// Nanoseconds from one reading to a later one, the cost of one reading
    /// taken off, never below 1.
    #[inline]
    pub fn elapsed_ns(&self, from: Instant, to: Instant) -> f32 {
        (self.raw_ns(from, to) - self.overhead_ns).max(1.0) as f32
    }

    /// The cost of one reading in nanoseconds.
    pub fn overhead_ns(&self) -> f64 {
        self.overhead_ns
    }

    /// What it reads: `"tsc"` or `"os"`.
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

    /// Median time between two readings with nothing in between.
    fn measured_overhead_ns(&self) -> f64 {
        let mut gaps: Vec<f64> = (0..N_READINGS)
            .map(|_| {
                let from = self.now();
                self.raw_ns(from, self.now())
            })
            .collect();
        gaps.sort_by(f64::total_cmp);
        gaps[N_READINGS / 2]
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
        let (start, (start_ticks, _)) = (OsInstant::now(), tsc::read());
        loop {
            let (elapsed, (ticks, _)) = (start.elapsed(), tsc::read());
            if elapsed >= CALIBRATION {
                let ns_per_tick = elapsed.as_nanos() as f64 / (ticks - start_ticks) as f64;
                return Self::Tsc { ns_per_tick };
            }
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn best() -> Self {
        Self::Os {
            start: OsInstant::now(),
        }
    }
}

#[cfg(target_arch = "x86_64")]
mod tsc {
    use std::arch::x86_64::{__cpuid, __rdtscp};

    /// Whether the counter runs at one rate on all cores, and can be read along
    /// with the CPU's number: CPUID leaf 0x80000007, EDX bit 8, and leaf
    /// 0x80000001, EDX bit 27.
    pub(super) fn is_usable() -> bool {
        let has = |leaf: u32, bit: u32| {
            __cpuid(0x8000_0000).eax >= leaf && __cpuid(leaf).edx & (1 << bit) != 0
        };
        has(0x8000_0007, 8) && has(0x8000_0001, 27)
    }

    /// The counter, and what the operating system keeps in IA32_TSC_AUX: on
    /// Linux, macOS and Windows a number of the CPU.
    ///
    /// RDTSCP waits for the instructions before it, so that no load of a pixel
    /// is charged to the next one. That costs a few nanoseconds more than RDTSC
    /// (`cargo bench --bench clock`).
    #[inline]
    #[expect(unsafe_code, reason = "the instruction has no safe wrapper")]
    pub(super) fn read() -> (u64, u32) {
        let mut cpu = 0;
        // SAFETY: `is_usable` has found RDTSCP, and it writes to `cpu` alone.
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
        let (from, os_from) = (clock.now(), OsInstant::now());
        std::thread::sleep(Duration::from_millis(20));
        let (to, os_ns) = (clock.now(), os_from.elapsed().as_nanos() as f32);
        let ns = clock.elapsed_ns(from, to);
        assert!(
            (ns / os_ns - 1.0).abs() < 0.05,
            "{ns} ns, should be {os_ns} ns"
        );
    }

    #[test]
    fn it_tells_the_cpu() {
        let clock = Clock::calibrated();
        // A test may be moved in between; not ten times in a row.
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
