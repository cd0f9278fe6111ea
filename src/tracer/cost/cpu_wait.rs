//! The time that a thread spends without a CPU.

use std::time::{Duration, Instant};

use cpu_time::ThreadTime;

use super::Interruptions;

/// The clocks of wall time and of CPU time are assumed to agree for this long.
const MOST_AGE: Duration = Duration::from_millis(10);

/// Measures how long the calling thread is without a CPU, because other threads have it or because
/// it waits for one of them. The CPU clock, whose system call takes as long as a cheap pixel, is
/// read only after an interruption.
#[derive(Debug)]
pub struct CpuWait {
    interruptions: Interruptions,
    /// Wall and CPU time at a moment since which there was no interruption.
    since: (Instant, ThreadTime),
    waited_ns: u64,
}

impl CpuWait {
    /// Starts observing the calling thread.
    pub fn of_this_thread() -> Self {
        Self {
            interruptions: Interruptions::of_this_thread(),
            since: (Instant::now(), ThreadTime::now()),
            waited_ns: 0,
        }
    }

    /// Starts again with no time waited.
    pub fn begin(&mut self) {
        if self.interruptions.take() || self.since.0.elapsed() > MOST_AGE {
            self.since = (Instant::now(), ThreadTime::now());
        }
        self.waited_ns = 0;
    }

    /// Returns true if the thread was interrupted since the last call; always false where the
    /// system does not report it.
    #[inline]
    pub fn is_interrupted(&mut self) -> bool {
        let is_interrupted = self.interruptions.take();
        if is_interrupted {
            self.add();
        }
        is_interrupted
    }

    /// Returns the time since the start that the thread was without a CPU, as far as interruptions
    /// were noticed, in nanoseconds.
    #[inline]
    pub fn waited_ns(&self) -> u64 {
        self.waited_ns
    }

    #[cold]
    fn add(&mut self) {
        let (wall, cpu) = self.since;
        let waited = wall.elapsed().saturating_sub(cpu.elapsed());
        self.waited_ns += waited.as_nanos() as u64;
        self.since = (Instant::now(), ThreadTime::now());
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn sleep_is_time_without_a_cpu_and_work_is_not() {
        let mut wait = CpuWait::of_this_thread();
        wait.begin();
        let begin = Instant::now();
        std::thread::sleep(Duration::from_millis(5));
        let is_interrupted = wait.is_interrupted();
        if !wait.interruptions.is_reported() {
            return;
        }
        assert!(is_interrupted);
        let waited = Duration::from_nanos(wait.waited_ns());
        assert!(waited > Duration::from_millis(4) && waited <= begin.elapsed());
        // Working time never counts as waiting, however often the thread is interrupted.
        wait.begin();
        let (begin, cpu) = (Instant::now(), ThreadTime::now());
        while cpu.elapsed() < Duration::from_millis(2) {}
        wait.is_interrupted();
        let most = begin.elapsed() - Duration::from_millis(2);
        assert!(wait.waited_ns() <= most.as_nanos() as u64 + 1_000_000);
    }
}
