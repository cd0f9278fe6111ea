//! How many tiles a worker is dealt at a time.

use std::time::Duration;

/// How long a worker's threads should be able to render while they wait for the next tiles:
/// several times as long as either side sleeps between two looks for messages.
const AHEAD: Duration = Duration::from_millis(4);
/// Most tiles for each thread of a worker in that time.
const MAX_AHEAD: u64 = 64;
/// As many before the duration of a tile is known.
const FIRST_AHEAD: u64 = 2;

/// What a worker was given.
#[derive(Debug, Clone, Copy, Default)]
pub struct WorkerShare {
    /// Number of tiles that it has been dealt and has not returned.
    pub n_dealt: u64,
    /// Number of tiles that it has returned.
    n_done: u64,
    /// How long its threads took for these, in nanoseconds.
    done_ns: u64,
}

impl WorkerShare {
    /// Takes note of a returned tile that took so many nanoseconds.
    pub fn returned(&mut self, duration_ns: u64) {
        self.n_dealt -= 1;
        self.n_done += 1;
        self.done_ns += duration_ns;
    }

    /// How many further tiles a worker with so many threads is given, if so many tiles are
    /// left for so many ranks: those that its threads render, and some ahead, of which it has
    /// at most half of its share of those left, so that no one waits for it in the end.
    pub fn n_wanted(&self, n_threads: u64, n_left: u64, n_ranks: u64) -> u64 {
        let per_thread = match self.done_ns {
            0 => FIRST_AHEAD,
            ns => (AHEAD.as_nanos() as u64 * self.n_done / ns).clamp(1, MAX_AHEAD),
        };
        let n_ahead = (n_threads * per_thread).min(n_left / (2 * n_ranks));
        (n_threads + n_ahead).saturating_sub(self.n_dealt)
    }
}
