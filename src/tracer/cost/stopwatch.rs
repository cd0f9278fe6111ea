//! The CPU time of a thread, and the time that a device works for it, lap by lap.
//!
//! The system's clock of a thread's CPU time stops while the thread waits for a CPU, but to read it
//! takes as long as a cheap pixel. So a fast clock times the laps, and the CPU clock is read only
//! where [`INTERVAL_NS`] have passed: what the fast clock has counted more is a wait, in the longest
//! of these laps. Laps and readings follow each other without a gap, so that each wait is either in
//! both or in neither, and the laps add up to the CPU time.

use cpu_time::ThreadTime;

use super::Clock;
use super::clock::Instant;

/// Nanoseconds between two readings of the CPU clock: many times the cost of a reading, and less
/// than the time for which the system gives a CPU to another thread.
const INTERVAL_NS: f64 = 1e5;

/// Times consecutive laps of the calling thread's work.
#[derive(Debug)]
pub struct Stopwatch {
    clock: Clock,
    /// The end of the last lap.
    end: Instant,
    /// The end of the last reading of the CPU clock.
    since: Instant,
    /// Number of laps since then.
    n_laps: usize,
    cpu: ThreadTime,
    /// The CPU time and the device's until `since`, in nanoseconds.
    cpu_ns: f64,
    /// The device's time since then.
    device_ns: f64,
}

impl Stopwatch {
    /// Starts on the calling thread.
    pub fn start(clock: Clock) -> Self {
        let cpu = ThreadTime::now();
        let now = clock.now();
        Self {
            clock,
            end: now,
            since: now,
            n_laps: 0,
            cpu,
            cpu_ns: 0.0,
            device_ns: 0.0,
        }
    }

    /// Ends a lap and starts the next one. Returns the nanoseconds that it took, waits included.
    #[inline]
    pub fn lap(&mut self) -> f32 {
        let end = self.clock.now();
        let ns = self.clock.raw_ns(self.end, end);
        self.end = end;
        self.n_laps += 1;
        ns as f32
    }

    /// Counts these nanoseconds, in which a device worked while the thread waited for it, as the
    /// thread's own.
    #[inline]
    pub fn add_device_ns(&mut self, ns: f64) {
        self.device_ns += ns;
    }

    /// Takes the waits for a CPU off the last laps, in nanoseconds: all since the last call, or as
    /// many as matter.
    #[inline]
    pub fn take_waits_off(&mut self, laps: &mut [f32]) {
        let wall_ns = self.clock.raw_ns(self.since, self.end);
        if wall_ns >= INTERVAL_NS && self.clock.has_cpu_time() {
            self.read_cpu_time(wall_ns, laps);
        }
    }

    /// Returns the CPU time of the thread until now, and the device's for it, in nanoseconds since
    /// the start.
    pub fn cpu_ns(&mut self) -> f64 {
        self.lap();
        self.take_waits_off(&mut []);
        self.cpu_ns + self.clock.raw_ns(self.since, self.end)
    }

    #[cold]
    fn read_cpu_time(&mut self, wall_ns: f64, laps: &mut [f32]) {
        let cpu = ThreadTime::now();
        let cpu_ns = cpu.duration_since(self.cpu).as_nanos() as f64;
        let cpu_ns = cpu_ns + std::mem::take(&mut self.device_ns);
        let n_before = laps.len().saturating_sub(self.n_laps);
        take_off((wall_ns - cpu_ns) as f32, &mut laps[n_before..]);
        self.cpu = cpu;
        self.cpu_ns += cpu_ns;
        self.n_laps = 0;
        self.end = self.clock.now();
        self.since = self.end;
    }
}

/// Takes a wait off laps, the longest first, which has it if it is longer than any other lap.
fn take_off(mut wait_ns: f32, laps: &mut [f32]) {
    while wait_ns > 0.0
        && let Some(longest) = laps.iter_mut().max_by(|a, b| a.total_cmp(b))
        && *longest > 0.0
    {
        let of_longest = wait_ns.min(*longest);
        *longest -= of_longest;
        wait_ns -= of_longest;
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn a_wait_is_in_the_longest_lap() {
        let mut laps = [900.0, 3_000_700.0, 1200.0];
        take_off(3_000_000.0, &mut laps);
        assert_eq!(laps, [900.0, 700.0, 1200.0]);
        // Noise of the clocks is not a wait.
        take_off(-500.0, &mut laps);
        assert_eq!(laps, [900.0, 700.0, 1200.0]);
    }

    #[test]
    fn laps_with_several_waits_keep_their_sum() {
        let mut laps = [4_000_100.0, 300.0, 3_000_200.0, 500.0];
        take_off(7_000_000.0, &mut laps);
        assert_eq!(laps.iter().sum::<f32>(), 1100.0);
        assert_eq!([laps[1], laps[3]], [300.0, 500.0]);
        take_off(1e9, &mut laps);
        assert_eq!(laps, [0.0; 4]);
    }

    #[test]
    fn the_time_of_a_device_is_not_a_wait() {
        let mut stopwatch = Stopwatch::start(Clock::system());
        if !stopwatch.clock.has_cpu_time() {
            return;
        }
        let begin = stopwatch.cpu_ns();
        let mut laps = [0.0; 2];
        std::thread::sleep(Duration::from_millis(5));
        laps[0] = stopwatch.lap();
        stopwatch.add_device_ns(4e6);
        laps[1] = stopwatch.lap();
        stopwatch.take_waits_off(&mut laps);
        let cpu_ns = stopwatch.cpu_ns() - begin;
        let sum: f32 = laps.iter().sum();
        assert!(sum >= 3.99e6, "{laps:?}");
        assert!(cpu_ns >= 4e6, "{cpu_ns}");
    }

    #[test]
    fn a_sleeping_thread_takes_no_cpu_time() {
        let mut stopwatch = Stopwatch::start(Clock::system());
        if !stopwatch.clock.has_cpu_time() {
            return;
        }
        let (begin, cpu) = (stopwatch.cpu_ns(), ThreadTime::now());
        let mut laps = [0.0; 3];
        for lap in &mut laps {
            std::thread::sleep(Duration::from_millis(2));
            *lap = stopwatch.lap();
        }
        let wall_ns: f32 = laps.iter().sum();
        stopwatch.take_waits_off(&mut laps);
        let cpu_ns = stopwatch.cpu_ns() - begin;
        let most = cpu.elapsed().as_nanos() as f64;
        assert!(wall_ns >= 6e6);
        assert!(cpu_ns <= most + INTERVAL_NS, "{cpu_ns} of {most}");
        let sum: f32 = laps.iter().sum();
        assert!(f64::from(sum) <= cpu_ns + INTERVAL_NS, "{sum} of {cpu_ns}");
    }
}
