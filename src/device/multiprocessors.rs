//! Times at which each multiprocessor of a device followed paths, by the device's clock.

use std::mem;
use std::time::{Duration, Instant};

use crate::paths::N_RESULTS;
use crate::program::NONE;
use tracer::cost::MultiprocessorRun;

/// Greatest number of runs that are kept: timelines of more cannot be shown.
const MAX_RUNS: usize = 1 << 17;
/// Shorter pauses do not end a run, in nanoseconds.
const LEAST_PAUSE_NS: u64 = 10_000;

/// The runs of all launches so far.
#[derive(Debug)]
pub(crate) struct MultiprocessorTimes {
    runs: Vec<DeviceSpan>,
    least_pause_ns: u64,
    /// A moment before all others.
    begin: Instant,
    /// Lower bound of the device's clock at `begin`, in nanoseconds: the end of a launch is seen late,
    /// so the greatest bound is the nearest.
    begin_ns: u64,
}

/// The paths of a multiprocessor, in nanoseconds of the device's clock.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DeviceSpan {
    number: u32,
    paths: u64,
    begin_ns: u64,
    end_ns: u64,
}

impl DeviceSpan {
    /// Returns true if both are of one multiprocessor, and overlap or are divided by a shorter pause.
    fn continues(&self, other: &Self, least_pause_ns: u64) -> bool {
        let pause_ns =
            (self.begin_ns.max(other.begin_ns)).saturating_sub(self.end_ns.min(other.end_ns));
        self.number == other.number && pause_ns < least_pause_ns
    }

    /// Adds the paths of another run of the same multiprocessor.
    fn add(&mut self, other: &Self) {
        self.paths += other.paths;
        self.begin_ns = self.begin_ns.min(other.begin_ns);
        self.end_ns = self.end_ns.max(other.end_ns);
    }
}

impl MultiprocessorTimes {
    /// Creates a list without runs; `begin` is a moment before all of them.
    pub(crate) fn new(begin: Instant) -> Self {
        Self {
            runs: Vec::new(),
            least_pause_ns: LEAST_PAUSE_NS,
            begin,
            begin_ns: 0,
        }
    }

    /// Adds the runs of a launch that had ended at the moment `seen`.
    pub(crate) fn add(&mut self, runs: Vec<DeviceSpan>, seen: Instant) {
        let end_ns = runs.iter().map(|run| run.end_ns).max().unwrap_or(0);
        let since_begin = (seen - self.begin).as_nanos() as u64;
        self.begin_ns = self.begin_ns.max(end_ns.saturating_sub(since_begin));
        self.runs.extend(runs);
        while self.runs.len() > MAX_RUNS {
            join(&mut self.runs, self.least_pause_ns);
            self.least_pause_ns *= 2;
        }
    }

    /// Returns the runs since the last call; no two of a multiprocessor overlap.
    pub(crate) fn take(&mut self) -> Vec<MultiprocessorRun> {
        let mut runs = mem::take(&mut self.runs);
        join(&mut runs, self.least_pause_ns);
        let moment = |ns: u64| self.begin + Duration::from_nanos(ns.saturating_sub(self.begin_ns));
        let runs = runs.into_iter().map(|run| MultiprocessorRun {
            number: run.number,
            paths: run.paths,
            begin: moment(run.begin_ns),
            end: moment(run.end_ns),
        });
        runs.collect()
    }
}

/// Returns the runs of a launch, given the results of its paths; none if the device does not say.
pub(crate) fn runs_of(results: &[[u32; N_RESULTS]]) -> Vec<DeviceSpan> {
    let runs = results.iter().map_while(|&[.., low, high, ns, _, number]| {
        let begin_ns = u64::from(high) << 32 | u64::from(low);
        (number != NONE).then_some(DeviceSpan {
            number,
            paths: 1,
            begin_ns,
            end_ns: begin_ns + u64::from(ns),
        })
    });
    let mut runs = runs.collect();
    join(&mut runs, LEAST_PAUSE_NS);
    runs
}

/// Sorts runs by multiprocessor and time, and joins runs that continue one another, as in launches of
/// several threads.
fn join(runs: &mut Vec<DeviceSpan>, least_pause_ns: u64) {
    let joins = |next: &mut DeviceSpan, last: &mut DeviceSpan| {
        let is_same = next.continues(last, least_pause_ns);
        if is_same {
            last.add(next);
        }
        is_same
    };
    // A group's paths follow each other: few runs are left to sort.
    runs.dedup_by(joins);
    runs.sort_unstable_by_key(|run| (run.number, run.begin_ns));
    runs.dedup_by(joins);
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    /// Returns the results of a path that begins at the millisecond `begin` and takes `ns`.
    fn path(number: u32, begin: u64, ns: u64) -> [u32; N_RESULTS] {
        let [low, high] = [begin * MS, (begin * MS) >> 32].map(|ns| ns as u32);
        let mut result = [0; N_RESULTS];
        result[N_RESULTS - 5..].copy_from_slice(&[low, high, ns as u32, 0, number]);
        result
    }

    #[test]
    fn the_device_ends_a_launch_before_that_is_seen() {
        let begin = Instant::now();
        let after = |ms| begin + Duration::from_millis(ms);
        let mut times = MultiprocessorTimes::new(begin);
        // A clock that started long ago, and launches that are seen 700 and 300 ms late.
        let now = 1 << 23;
        let paths = [
            path(3, now + 100, 50 * MS),
            path(0, now + 120, 180 * MS),
            path(3, now + 110, 90 * MS),
        ];
        times.add(runs_of(&paths), after(1000));
        times.add(runs_of(&[path(0, now + 1000, 500 * MS)]), after(1800));
        let run = |number, paths, [begin, end]: [u64; 2]| MultiprocessorRun {
            number,
            paths,
            begin: after(begin),
            end: after(end),
        };
        let expected = [
            run(0, 1, [420, 600]),
            run(0, 1, [1300, 1800]),
            run(3, 2, [400, 500]),
        ];
        assert_eq!(times.take(), expected);
        assert_eq!(times.take(), []);
        times.add(runs_of(&[path(NONE, 0, 0)]), after(2000));
        assert_eq!(times.take(), []);
    }

    #[test]
    fn runs_of_a_multiprocessor_do_not_overlap() {
        let begin = Instant::now();
        let mut times = MultiprocessorTimes::new(begin);
        let launches = [
            [path(1, 0, 5 * MS), path(2, 1, 5 * MS)],
            [path(1, 4, 5 * MS), path(2, 7, 5 * MS)],
            // A pause of 9 µs.
            [path(1, 9, MS), path(2, 13, MS - 9000)],
        ];
        for launch in launches {
            times.add(runs_of(&launch), begin + Duration::from_secs(1));
        }
        let runs = times.take();
        let runs = runs.iter().map(|run| {
            let us = (run.end - run.begin).as_micros();
            (run.number, run.paths, us)
        });
        let expected = [(1, 3, 10_000), (2, 1, 5000), (2, 1, 5000), (2, 1, 991)];
        assert_eq!(runs.collect::<Vec<_>>(), expected);
    }

    #[test]
    fn too_many_runs_become_longer() {
        let begin = Instant::now();
        let mut times = MultiprocessorTimes::new(begin);
        let n = MAX_RUNS as u64 + 1000;
        let paths: Vec<_> = (0..n).map(|i| path(7, i, MS / 2)).collect();
        times.add(runs_of(&paths), begin + Duration::from_secs(1000));
        let runs = times.take();
        assert!(runs.len() < MAX_RUNS, "{}", runs.len());
        assert_eq!(runs.iter().map(|run| run.paths).sum::<u64>(), n);
    }
}
