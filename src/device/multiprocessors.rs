//! When each multiprocessor of a device followed paths, by the device's clock.

use std::collections::BTreeMap;
use std::mem;
use std::time::{Duration, Instant};

use crate::paths::N_RESULTS;
use crate::program::NONE;
use tracer::cost::MultiprocessorRun;

/// Greatest number of runs that are kept: timelines of more cannot be shown.
const MAX_RUNS: usize = 1 << 17;

/// The runs of all launches so far.
#[derive(Debug)]
pub(crate) struct MultiprocessorTimes {
    runs: Vec<DeviceSpan>,
    /// A moment before all others.
    begin: Instant,
    /// Nanoseconds of the device's clock at that moment, at least: a launch is seen to have ended some
    /// time after its last path, so the least difference of both clocks is the nearest.
    begin_ns: u64,
}

/// The paths of a multiprocessor, in nanoseconds of the device's clock.
#[derive(Debug, Clone, Copy)]
struct DeviceSpan {
    number: u32,
    paths: u64,
    begin_ns: u64,
    end_ns: u64,
}

impl DeviceSpan {
    fn with(self, other: Self) -> Self {
        Self {
            number: self.number,
            paths: self.paths + other.paths,
            begin_ns: self.begin_ns.min(other.begin_ns),
            end_ns: self.end_ns.max(other.end_ns),
        }
    }
}

impl MultiprocessorTimes {
    /// Creates a list without runs; `begin` is a moment before all of them.
    pub(crate) fn new(begin: Instant) -> Self {
        Self {
            runs: Vec::new(),
            begin,
            begin_ns: 0,
        }
    }

    /// Adds a launch that had ended at the moment `seen`, given the results of its paths.
    pub(crate) fn add(&mut self, results: &[[u32; N_RESULTS]], seen: Instant) {
        let mut runs: BTreeMap<u32, DeviceSpan> = BTreeMap::new();
        for &[.., low, high, ns, _, number] in results {
            if number == NONE {
                return;
            }
            let begin_ns = u64::from(high) << 32 | u64::from(low);
            let run = DeviceSpan {
                number,
                paths: 1,
                begin_ns,
                end_ns: begin_ns + u64::from(ns),
            };
            (runs.entry(number))
                .and_modify(|one| *one = one.with(run))
                .or_insert(run);
        }
        let end_ns = runs.values().map(|run| run.end_ns).max().unwrap_or(0);
        let since_begin = (seen - self.begin).as_nanos() as u64;
        self.begin_ns = self.begin_ns.max(end_ns.saturating_sub(since_begin));
        self.runs.extend(runs.into_values());
        if self.runs.len() > MAX_RUNS {
            self.join();
        }
    }

    /// Joins the runs of each multiprocessor two by two.
    fn join(&mut self) {
        let mut open = BTreeMap::new();
        for run in mem::take(&mut self.runs) {
            match open.remove(&run.number) {
                Some(i) => self.runs[i] = DeviceSpan::with(self.runs[i], run),
                None => {
                    open.insert(run.number, self.runs.len());
                    self.runs.push(run);
                }
            }
        }
    }

    /// Returns the runs since the last call.
    pub(crate) fn take(&mut self) -> Vec<MultiprocessorRun> {
        let moment = |ns: u64| self.begin + Duration::from_nanos(ns.saturating_sub(self.begin_ns));
        let runs = self.runs.iter().map(|run| MultiprocessorRun {
            number: run.number,
            paths: run.paths,
            begin: moment(run.begin_ns),
            end: moment(run.end_ns),
        });
        let runs = runs.collect();
        self.runs.clear();
        runs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the results of a path.
    fn path(number: u32, begin_ns: u64, ns: u32) -> [u32; N_RESULTS] {
        let mut result = [0; N_RESULTS];
        let times = [begin_ns as u32, (begin_ns >> 32) as u32, ns, 0, number];
        result[N_RESULTS - 5..].copy_from_slice(&times);
        result
    }

    #[test]
    fn the_device_ends_a_launch_before_that_is_seen() {
        let begin = Instant::now();
        let after = |ns| begin + Duration::from_nanos(ns);
        let mut times = MultiprocessorTimes::new(begin);
        // A clock that started long ago, and launches that are seen 700 and 300 ns late.
        let now = 7 << 40;
        times.add(
            &[
                path(3, now + 100, 50),
                path(0, now + 120, 180),
                path(3, now + 110, 90),
            ],
            after(1000),
        );
        times.add(&[path(0, now + 1000, 500)], after(1800));
        let run = |number, paths, [begin, end]: [u64; 2]| MultiprocessorRun {
            number,
            paths,
            begin: after(begin),
            end: after(end),
        };
        let expected = [
            run(0, 1, [420, 600]),
            run(3, 2, [400, 500]),
            run(0, 1, [1300, 1800]),
        ];
        assert_eq!(times.take(), expected);
        assert_eq!(times.take(), []);
        times.add(&[path(NONE, 0, 0)], after(2000));
        assert_eq!(times.take(), []);
    }

    #[test]
    fn joined_runs_span_both() {
        let mut times = MultiprocessorTimes::new(Instant::now());
        for launch in 0..5 {
            let results = [0, 1].map(|number| path(number, 1000 * (launch + 1), 10));
            times.add(&results, times.begin + Duration::from_secs(1));
        }
        times.join();
        let runs = times.take();
        let spans = runs
            .iter()
            .map(|run| (run.number, run.paths, (run.end - run.begin).as_nanos()));
        let spans: Vec<_> = spans.collect();
        assert_eq!(
            spans,
            [
                (0, 2, 1010),
                (1, 2, 1010),
                (0, 2, 1010),
                (1, 2, 1010),
                (0, 1, 10),
                (1, 1, 10)
            ]
        );
    }
}
