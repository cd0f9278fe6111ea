//! Estimate of the time that a stage will still take.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use base::locked;

/// Multiple of the first work that must be done before its time can be left out early.
const MANY: f64 = 16.0;

/// Estimates the time left of a stage from the work done so far.
#[derive(Debug)]
pub struct TimeLeft {
    begin: Instant,
    work: f64,
    done: Mutex<WorkDone>,
}

/// The work that is done.
#[derive(Debug, Clone, Copy, Default)]
struct WorkDone {
    /// Work done by this run.
    here: f64,
    /// Work done by earlier runs.
    before: f64,
    /// The first work of this run, and when it was done.
    first: Option<(f64, Duration)>,
}

impl TimeLeft {
    /// Starts a stage of `work`, in any unit.
    pub fn begin(work: f64) -> Self {
        Self {
            begin: Instant::now(),
            work,
            done: Mutex::default(),
        }
    }

    /// Records that some work is done; if `is_restored`, by an earlier run, which took no time.
    /// Returns the fraction of the work that is done, from 0 to 1.
    pub fn advance(&self, work: f64, is_restored: bool) -> f64 {
        let mut done = locked(&self.done);
        if is_restored {
            done.before += work;
        } else {
            done.here += work;
            done.first.get_or_insert((work, self.begin.elapsed()));
        }
        ((done.here + done.before) / self.work).min(1.0)
    }

    /// Returns the time left if the rest takes as long per unit of work as this run has taken so
    /// far, without the first work, before which threads and memory were created; `None` before the
    /// first.
    pub fn left(&self) -> Option<Duration> {
        let done = *locked(&self.done);
        done.left(self.work, self.begin.elapsed())
    }
}

impl WorkDone {
    fn left(self, work: f64, elapsed: Duration) -> Option<Duration> {
        let rest = (work - self.here - self.before).max(0.0);
        let is_late = |(first, at): (f64, Duration)| {
            self.here > MANY * first || elapsed > 2 * at && self.here > first
        };
        let (first, at) = self
            .first
            .filter(|&first| is_late(first))
            .unwrap_or_default();
        let left = (elapsed - at).as_secs_f64() * rest / (self.here - first);
        Duration::try_from_secs_f64(left).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_takes_as_long_for_its_work() {
        let left = |here, before| {
            let done = WorkDone {
                here,
                before,
                first: None,
            };
            let left = done.left(100.0, Duration::from_secs(10));
            left.map(|left| left.as_secs_f64().round())
        };
        assert_eq!(left(10.0, 0.0), Some(90.0));
        assert_eq!(left(10.0, 40.0), Some(50.0));
        assert_eq!(left(25.0, 75.0), Some(0.0));
        assert_eq!(left(0.0, 50.0), None);
        // Rounding may add up to a little more.
        assert_eq!(left(100.1, 0.0), Some(0.0));
    }

    #[test]
    fn what_precedes_the_first_work_counts_once() {
        let done = WorkDone {
            here: 30.0,
            before: 0.0,
            first: Some((10.0, Duration::from_secs(4))),
        };
        let left = |seconds| done.left(100.0, Duration::from_secs(seconds));
        assert_eq!(left(10), Some(Duration::from_secs(21)));
        // Too early to leave the first out.
        assert_eq!(left(6), Some(Duration::from_secs(14)));
        let soon = WorkDone {
            here: 20.0,
            first: Some((1.0, Duration::from_secs(4))),
            ..done
        };
        let left = soon.left(39.0, Duration::from_secs(6));
        assert_eq!(left, Some(Duration::from_secs(2)));
    }

    #[test]
    fn all_work_adds_up() {
        let stage = TimeLeft::begin(4.0);
        assert_eq!(stage.left(), None);
        assert_eq!(stage.advance(1.0, true), 0.25);
        assert_eq!(stage.advance(2.0, false), 0.75);
        assert!(stage.left().is_some());
        assert_eq!(stage.advance(2.0, false), 1.0);
    }
}
