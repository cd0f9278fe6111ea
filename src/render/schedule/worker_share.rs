//! The number of tiles that a worker is dealt at a time, and the pauses of ranks between messages.

use std::time::Duration;

/// How long a worker's threads should be able to render while they wait for the next tiles:
/// several times as long as either side sleeps between two looks for messages.
const AHEAD: Duration = Duration::from_millis(20);
/// Most tiles for each thread of a worker in that time.
const MAX_AHEAD: u64 = 1024;
/// The part of its share of the tiles that a worker has ahead before their duration is known.
const FIRST_PART: u64 = 32;
/// The expected duration of a tile is the mean of the last ones, with a weight of one in so many
/// for the last: with the most expensive tiles first, later ones are shorter.
const WEIGHT: u64 = 8;

/// How long a rank without any message sleeps before it looks for the next one: each time takes
/// some microseconds from a thread that renders.
const PAUSE: Duration = Duration::from_millis(2);
/// The same while its threads wait for tiles, or rank 0 waits for the last ones.
const SHORT_PAUSE: Duration = Duration::from_micros(200);

/// How long a rank without any message sleeps before it looks for the next one, if tiles wait
/// for its threads or not.
pub fn pause(has_tiles: bool) -> Duration {
    if has_tiles { PAUSE } else { SHORT_PAUSE }
}

/// What a worker was given.
#[derive(Debug, Clone, Copy, Default)]
pub struct WorkerShare {
    /// Number of tiles that it has been dealt and has not returned.
    pub n_dealt: u64,
    /// How long its threads take for a tile, in nanoseconds, of which those that it returned
    /// last count the most; 0 before the first one.
    tile_ns: u64,
}

impl WorkerShare {
    /// Takes note of a returned tile that took so many nanoseconds.
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

    /// How many further tiles a worker with so many threads is given, if so many tiles are
    /// left for so many ranks: those that its threads render, and some ahead, at most its
    /// share of those left, so that no other rank waits for it in the end.
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
