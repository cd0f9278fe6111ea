//! Timing of consecutive pixels, or groups of them, on one thread, and again if their time was
//! disturbed.

use crate::film::PixelTime;
use base::stop;
use tracer::cost::{Clock, CpuWait, Instant};

/// Greatest number of times that a disturbed pixel is rendered again.
const N_TRIES: usize = 3;

/// A time is doubtful if it is this multiple of the expected time: an interrupt that returns to the
/// thread is not reported, nor is a pause of the virtual machine, nor are cold caches.
pub(super) const SPIKE: f32 = 2.0;

/// The caches are warm again after this time on a CPU.
const WARM_NS: f32 = 2e4;

/// The clocks of a thread.
pub(super) trait Timer {
    /// Reads the clock.
    fn now(&mut self) -> Instant;

    /// Returns the nanoseconds between two readings, at least 1.
    fn elapsed_ns(&self, from: Instant, to: Instant) -> f32;

    /// Returns true if the thread lost its CPU since the last call.
    fn is_interrupted(&mut self) -> bool;

    /// Returns the nanoseconds for which the thread was without a CPU, as of the last call of
    /// [`is_interrupted`](Self::is_interrupted).
    fn waited_ns(&self) -> u64;
}

/// The clocks of the calling thread.
pub(super) struct ThreadTimer<'a> {
    pub(super) clock: &'a Clock,
    pub(super) wait: &'a mut CpuWait,
}

impl Timer for ThreadTimer<'_> {
    #[inline]
    fn now(&mut self) -> Instant {
        self.clock.now()
    }

    #[inline]
    fn elapsed_ns(&self, from: Instant, to: Instant) -> f32 {
        self.clock.elapsed_ns(from, to)
    }

    #[inline]
    fn is_interrupted(&mut self) -> bool {
        self.wait.is_interrupted()
    }

    #[inline]
    fn waited_ns(&self) -> u64 {
        self.wait.waited_ns()
    }
}

/// Times work that consists of consecutive pixels.
pub(super) struct Stopwatch<T> {
    timer: T,
    /// The start of the pixel.
    begin: Instant,
    /// True if the previous pixel was disturbed, and too short to warm the caches again.
    was_disturbed: bool,
}

impl<T: Timer> Stopwatch<T> {
    pub(super) fn new(mut timer: T) -> Self {
        Self {
            begin: timer.now(),
            timer,
            was_disturbed: false,
        }
    }

    /// Runs `work`. Returns the nanoseconds that it took, without those in which the thread waited
    /// for a CPU.
    pub(super) fn time(&mut self, work: impl FnOnce(&mut Self)) -> f64 {
        self.timer.is_interrupted();
        let (begin, waited_ns) = (self.timer.now(), self.timer.waited_ns());
        work(self);
        let end = self.timer.now();
        self.timer.is_interrupted();
        let waited_ns = self.timer.waited_ns() - waited_ns;
        (f64::from(self.timer.elapsed_ns(begin, end)) - waited_ns as f64).max(1.0)
    }

    /// Times `render` of each pixel, one per entry of `times`, and ends early after a request to
    /// stop. Returns the number of pixels that were timed.
    pub(super) fn time_each(
        &mut self,
        times: &mut [PixelTime],
        mut render: impl FnMut(usize),
    ) -> usize {
        self.start();
        for (i, time) in times.iter_mut().enumerate() {
            if stop::is_requested() {
                return i;
            }
            render(i);
            *time = self.lap();
        }
        times.len()
    }

    /// Renders pixels of [`time_each`](Self::time_each) again whose times were disturbed for less
    /// than `longest_ns`, or are doubtful, each after the pixel before it, as the first time. A
    /// disturbed time is replaced by the first undisturbed one, or else by the median of the CPU
    /// times, and remains rejected; of a doubtful time and another one the smaller is right. The
    /// CPU time of a longer one is right, as cold caches are a small part of it, and the next one
    /// would be interrupted as well.
    pub(super) fn time_again(
        &mut self,
        times: &mut [PixelTime],
        longest_ns: f32,
        is_doubtful: impl Fn(&[PixelTime], usize) -> bool,
        mut render: impl FnMut(usize),
    ) {
        for i in 0..times.len() {
            let is_disturbed = times[i].is_rejected && times[i].ns < longest_ns;
            if !is_disturbed && !is_doubtful(times, i) {
                continue;
            }
            let mut tries = [f32::MAX; N_TRIES];
            for (number, of_try) in tries.iter_mut().enumerate() {
                if stop::is_requested() {
                    return;
                }
                if times[i].ns < WARM_NS {
                    render(i.saturating_sub(1));
                }
                self.start();
                render(i);
                let again = self.lap();
                *of_try = again.ns;
                let time = &mut times[i];
                if again.is_rejected && number + 1 < N_TRIES {
                    continue;
                }
                if !again.is_rejected {
                    let is_better = time.is_rejected || again.ns < time.ns;
                    *time = if is_better { again } else { *time };
                } else if time.is_rejected {
                    tries.sort_unstable_by(f32::total_cmp);
                    time.ns = tries[N_TRIES / 2];
                }
                break;
            }
        }
    }

    /// Starts the first pixel.
    #[inline]
    fn start(&mut self) {
        self.timer.is_interrupted();
        self.was_disturbed = false;
        self.begin = self.timer.now();
    }

    /// Ends a pixel; the same reading of the clock starts the next one.
    ///
    /// A pixel after a short disturbed one is rejected too: its caches are cold, and an interruption
    /// between the reading of the clock and the check falls into its time.
    #[inline]
    fn lap(&mut self) -> PixelTime {
        let end = self.timer.now();
        let waited_ns = self.timer.waited_ns();
        let is_disturbed = self.timer.is_interrupted() || !end.is_on_cpu_of(self.begin);
        let ns = self.timer.elapsed_ns(self.begin, end);
        let time = PixelTime {
            ns: (ns - (self.timer.waited_ns() - waited_ns) as f32).max(1.0),
            is_rejected: is_disturbed || self.was_disturbed,
        };
        self.begin = end;
        self.was_disturbed = is_disturbed && time.ns < WARM_NS;
        time
    }
}

/// Returns true if a pixel took much longer than the pixels before and after it.
pub(super) fn is_spike(times: &[PixelTime], i: usize) -> bool {
    let before = i.checked_sub(1).map(|before| times[before].ns);
    let after = times.get(i + 1).map(|after| after.ns);
    let neighbors = before.into_iter().chain(after);
    neighbors
        .reduce(f32::max)
        .is_some_and(|most| times[i].ns > SPIKE * most)
}

#[cfg(test)]
mod tests;
