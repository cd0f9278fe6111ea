//! The time stamp counter of x86-64 and its calibration.

use std::arch::x86_64::{__cpuid, __rdtscp};
use std::time::{Duration, Instant};

/// Duration of the calibration. The operating system's clock is accurate to about 50 ns, so the
/// rate is accurate to 0.01 % after 0.5 ms.
const CALIBRATION: Duration = Duration::from_micros(500);

/// Comparisons of both clocks at each end of the calibration. The comparison with the least time
/// between its readings is used: an interrupt may delay the others.
const N_COMPARISONS: usize = 4;

/// Returns true if the counter is invariant and RDTSCP is available: CPUID leaf 0x80000007, EDX bit
/// 8, and leaf 0x80000001, EDX bit 27.
pub(super) fn is_usable() -> bool {
    let has = |leaf: u32, bit: u32| {
        __cpuid(0x8000_0000).eax >= leaf && __cpuid(leaf).edx & (1 << bit) != 0
    };
    has(0x8000_0007, 8) && has(0x8000_0001, 27)
}

/// Reads the counter.
///
/// RDTSCP waits for all earlier instructions, so that no load of a pixel adds to the time of the
/// next one. This takes a few nanoseconds more than RDTSC (`cargo bench --bench clock`).
#[inline]
#[expect(unsafe_code, reason = "the instruction has no safe wrapper")]
pub(super) fn read() -> u64 {
    let mut aux = 0;
    // SAFETY: `is_usable` has found RDTSCP, which only writes to `aux`.
    unsafe { __rdtscp(&mut aux) }
}

/// Measures the counter's period in nanoseconds; takes about 0.5 ms.
pub(super) fn ns_per_tick() -> f64 {
    let start = Instant::now();
    period_ns(|| Comparison {
        before: read(),
        os: start.elapsed(),
        after: read(),
    })
}

/// A reading of the operating system's clock between two readings of the counter.
#[derive(Debug, Clone, Copy)]
struct Comparison {
    before: u64,
    os: Duration,
    after: u64,
}

impl Comparison {
    /// Returns the comparison with the smallest gap, each made right after a tick of the operating
    /// system's clock, which may be coarse.
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

/// Measures the counter's period in nanoseconds with `compare` for about [`CALIBRATION`].
fn period_ns(mut compare: impl FnMut() -> Comparison) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Simulates a counter of 3 GHz and a coarse clock of the operating system, read by a thread
    /// that is interrupted for 10 ms now and then.
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
            let found = period_ns(|| Comparison {
                before: 3 * read(),
                os: Duration::from_nanos(read() / step_ns * step_ns),
                after: 3 * read(),
            });
            assert!((3.0 * found - 1.0).abs() < 1e-2, "{step_ns}: {found}");
        }
    }
}
