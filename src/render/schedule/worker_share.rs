//! The number of tiles that a worker is dealt at a time, and the pauses of ranks between messages.

use std::time::Duration;

/// Time that a worker's threads should be able to render while they wait for the next tiles:
/// several times the sleep of either side between two polls for messages.
const AHEAD: Duration = Duration::from_millis(20);
/// Greatest number of tiles for each thread of a worker in that time.
const MAX_AHEAD: u64 = 1024;
/// The fraction of its share of the tiles that a worker has ahead before their duration is known.
const FIRST_PART: u64 = 32;
/// The last duration has a weight of one in this many in the expected duration of a tile, a moving
/// average: with the most expensive tiles first, later ones are shorter.
const WEIGHT: u64 = 8;

/// Sleep of a rank between two polls for messages: each poll takes some microseconds from a thread
/// that renders.
const PAUSE: Duration = Duration::from_millis(2);
/// Sleep while the threads wait for tiles, or rank 0 waits for the last ones.
const SHORT_PAUSE: Duration = Duration::from_micros(200);

/// Returns how long a rank without messages sleeps before it polls again; `has_tiles` is true if
/// there are tiles for its threads.
pub fn pause(has_tiles: bool) -> Duration {
    if has_tiles { PAUSE } else { SHORT_PAUSE }
}

/// The tiles given to a worker.
#[derive(Debug, Clone, Copy, Default)]
pub struct WorkerShare {
    /// Number of tiles that it has been dealt and has not returned.
    pub n_dealt: u64,
    /// Time that its threads take for a tile, in nanoseconds, where recently returned tiles count
    /// the most; 0 before the first one.
    tile_ns: u64,
}

impl WorkerShare {
    /// Records a returned tile that took `duration_ns` nanoseconds.
    pub fn returned(&mut self, duration_ns: u64) {
        self.n_dealt -= 1;
        let before = match self.tile_ns {
            0 => duration_ns,
            ns => ns,
        };
        self.tile_ns = ((WEIGHT - 1) * before + duration_ns)
            .div_ceil(WEIGHT)
            .max(1);
    }

    /// Returns the number of further tiles for a worker with `n_threads` threads, if `n_left` tiles
    /// are left for `n_ranks` ranks: tiles that its threads render now and some ahead, at most its
    /// share of the tiles left, so that no other rank waits for it at the end.
    pub fn n_wanted(&self, n_threads: u64, n_left: u64, n_ranks: u64) -> u64 {
        let share = n_left / n_ranks;
        let per_thread = match self.tile_ns {
            0 => share / (FIRST_PART * n_threads),
            ns => AHEAD.as_nanos() as u64 / ns,
        };
        let n_ahead = share.min(n_threads * per_thread.clamp(1, MAX_AHEAD));
        (n_threads + n_ahead).saturating_sub(self.n_dealt)
    }
}
