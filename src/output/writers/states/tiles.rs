//! The values of `schedule.pvsm`.

use serde::{Deserialize, Serialize};

use crate::chart::Range;
use crate::paraview::{Axis, ColorScale, StateValue};
use render::schedule::Schedule;

/// The values of the keys that begin with `tiles.`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct TileValues {
    n_threads: usize,
    duration: Axis,
    thread: Axis,
    start: Axis,
}

impl TileValues {
    pub(super) fn new(schedule: &Schedule, n_labels: usize) -> Self {
        let runs = &schedule.runs;
        let durations: Vec<f32> = runs.iter().map(|run| run.duration_ns() as f32).collect();
        // Without outliers, which are interrupted threads.
        let Range { low, high, .. } = Range::spanning(&durations);
        let last_start = runs.iter().map(|run| run.start_ns).max();
        let last_start = last_start.unwrap_or(0).max(1) as f64;
        let last_thread = f64::from(schedule.n_threads - 1).max(1.0);
        let axis =
            |array, name, scale, ends| Axis::new(array, name, scale, ends).with_labels(n_labels);
        Self {
            n_threads: schedule.n_threads as usize,
            duration: axis(
                "duration_ns",
                "Time per tile",
                ColorScale::Logarithmic,
                [low, high],
            )
            .in_time_unit(),
            thread: axis("thread", "Thread", ColorScale::Linear, [0.0, last_thread]),
            start: axis(
                "start_ns",
                "Begun after",
                ColorScale::Linear,
                [0.0, last_start],
            )
            .in_time_unit(),
        }
    }

    /// Returns the values of both schedules.
    pub(super) fn spanning(&self, other: &Self) -> Self {
        Self {
            n_threads: self.n_threads.max(other.n_threads),
            duration: self.duration.spanning(&other.duration),
            thread: self.thread.spanning(&other.thread),
            start: self.start.spanning(&other.start),
        }
    }

    /// Returns the value of a key without the prefix `tiles.`.
    pub(super) fn value(&self, key: &str) -> Option<StateValue> {
        let is_alone = self.n_threads == 1;
        let (name, rest) = key.split_once('.')?;
        match (name, rest) {
            // Without an array, all tiles have the same light gray.
            ("thread", "array") if is_alone => Some("".into()),
            ("thread", "bar") => Some(if is_alone { "0" } else { "1" }.into()),
            ("thread", "caption") if is_alone => Some("Thread: one rendered all tiles".into()),
            ("thread", _) => self.thread.value(rest),
            ("duration", _) => self.duration.value(rest),
            ("start", _) => self.start.value(rest),
            _ => None,
        }
    }
}
