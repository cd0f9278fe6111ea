//! The picture in tiles: which there are, in which order threads take them, and
//! what became of that.
//!
//! A [`TileGrid`] cuts the picture; a [`Schedule`] is the record of a rendering:
//! when each tile was begun and done, and by whom.

mod grid;
mod hilbert;
mod load;

use std::time::{Duration, Instant};

pub use grid::{Tile, TileGrid};
pub use hilbert::hilbert_curve;
pub use load::Load;

use crate::config::TileOrder;
use crate::cost::Cost;

/// When each tile of a picture was rendered, and by which thread.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// The tiles.
    pub grid: TileGrid,
    /// The order in which threads took them.
    pub order: TileOrder,
    /// How many threads there were, those without a tile included.
    pub n_threads: u32,
    /// When the first tile was begun.
    pub begin: Instant,
    /// One a tile, in the order of the grid.
    pub runs: Vec<TileRun>,
}

/// The rendering of one tile.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct TileRun {
    /// The thread that rendered it, from 0.
    pub thread: u32,
    /// How many tiles were taken before it.
    pub position: u32,
    /// When it was begun, in nanoseconds since the first tile was.
    pub start_ns: u64,
    /// When all of its pixels were in the film, likewise.
    pub end_ns: u64,
    /// How long of that its pixels took into the film, in nanoseconds: first
    /// touches of memory, and other threads that write to the same rows.
    pub film_ns: u64,
    /// The counters of its pixels together; zero where nothing was counted.
    pub counted: Cost,
}

impl TileRun {
    /// How long it took, in nanoseconds.
    pub fn duration_ns(&self) -> u64 {
        self.end_ns - self.start_ns
    }
}

impl Schedule {
    /// The schedule of `runs`, which are a list a thread of tiles by their
    /// numbers, in nanoseconds since `begin`; each tile of the grid is in one.
    pub fn new(
        grid: TileGrid,
        order: TileOrder,
        begin: Instant,
        runs: Vec<Vec<(u32, TileRun)>>,
    ) -> Self {
        let n_threads = runs.len() as u32;
        let mut runs: Vec<(u32, TileRun)> = runs.into_iter().flatten().collect();
        runs.sort_unstable_by_key(|(number, _)| *number);
        let first_ns = runs.iter().map(|(_, run)| run.start_ns).min().unwrap_or(0);
        let since_first = |(_, run): (u32, TileRun)| TileRun {
            start_ns: run.start_ns - first_ns,
            end_ns: run.end_ns - first_ns,
            ..run
        };
        Self {
            grid,
            order,
            n_threads,
            begin: begin + Duration::from_nanos(first_ns),
            runs: runs.into_iter().map(since_first).collect(),
        }
    }

    /// The counters of all tiles together.
    pub fn counted(&self) -> Cost {
        let counted = self.runs.iter().map(|run| run.counted);
        counted.fold(Cost::default(), Cost::with)
    }

    /// How evenly the threads were at work.
    pub fn load(&self) -> Load {
        Load::of(&self.runs, self.n_threads)
    }
}
