//! The image as tiles: their grid, their order, and the record of their rendering.
//!
//! A [`TileGrid`] divides the image into tiles. A [`Schedule`] is the record of a rendering: the
//! thread, the start and the end of each tile.

mod grid;
mod hilbert;
mod load;
mod worker_share;

use std::time::{Duration, Instant};

pub use grid::{BLOCK_SIDE, GROUP_PATHS, MAX_PIXELS, N_GRIDS, Tile, TileGrid, group_sides};
pub use hilbert::hilbert_curve;
pub use load::Load;
pub use worker_share::{WorkerShare, pause};

use scene::config::TileOrder;
use tracer::cost::Cost;

/// Upper bound of the bytes per tile in the order of tiles and in the schedule: the lists of the
/// threads grow by doubling, and exist until it is complete.
pub const BYTES_PER_TILE: usize = 4 + 3 * size_of::<(u32, TileRun)>();

/// The time span and the thread of each tile of an image.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// The tiles.
    pub grid: TileGrid,
    /// The order in which the threads took them.
    pub order: TileOrder,
    /// Number of threads, including those without a tile.
    pub n_threads: u32,
    /// The moment when the first tile started.
    pub begin: Instant,
    /// One entry per tile, in the order of the grid.
    pub runs: Vec<TileRun>,
}

/// The rendering of one tile.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct TileRun {
    /// True if the tile was not rendered: then everything else is 0.
    pub is_missing: bool,
    /// The rank that rendered the tile, from 0; 0 where one process renders.
    pub rank: u32,
    /// The thread that rendered the tile, from 0 among the threads of all ranks.
    pub thread: u32,
    /// Number of tiles that were taken before this one.
    pub position: u32,
    /// Start in nanoseconds since the start of the first tile.
    pub start_ns: u64,
    /// The moment when all of its pixels were in the film, in nanoseconds since the start of the
    /// first tile.
    pub end_ns: u64,
    /// The part of the duration that the write to the film took, in nanoseconds: first touches of
    /// memory, and contention with other threads for its rows.
    pub film_ns: u64,
    /// The part of the duration that warmed up the thread, in nanoseconds: discarded renderings of
    /// pixels, and the first writes to memory.
    pub warm_up_ns: u64,
    /// The part of the duration in which the thread waited for a CPU, in nanoseconds: it is in no
    /// other part.
    pub waiting_ns: u64,
    /// The sum of the counters of its pixels; zero if nothing was counted.
    pub counted: Cost,
}

impl TileRun {
    /// Returns the duration in nanoseconds.
    pub fn duration_ns(&self) -> u64 {
        self.end_ns - self.start_ns
    }

    /// Returns the part of the duration in which the thread had a CPU, in nanoseconds.
    pub fn busy_ns(&self) -> u64 {
        self.duration_ns().saturating_sub(self.waiting_ns)
    }
}

impl Schedule {
    /// Creates the schedule of `runs`: for each thread a list of its tiles with their numbers, in
    /// nanoseconds since `begin`. Tiles of the grid that are in no list are missing.
    pub fn new(
        grid: TileGrid,
        order: TileOrder,
        begin: Instant,
        runs: Vec<Vec<(u32, TileRun)>>,
    ) -> Self {
        let n_threads = runs.len() as u32;
        let first = runs.iter().flatten().map(|(_, run)| run.start_ns).min();
        let first_ns = first.unwrap_or(0);
        let missing = TileRun {
            is_missing: true,
            ..TileRun::default()
        };
        let mut of_tiles = vec![missing; grid.n_tiles() as usize];
        for (number, run) in runs.into_iter().flatten() {
            of_tiles[number as usize] = TileRun {
                start_ns: run.start_ns - first_ns,
                end_ns: run.end_ns - first_ns,
                ..run
            };
        }
        Self {
            grid,
            order,
            n_threads,
            begin: begin + Duration::from_nanos(first_ns),
            runs: of_tiles,
        }
    }

    /// Returns the tiles that were rendered, with their numbers.
    pub fn rendered(&self) -> impl Iterator<Item = (u32, &TileRun)> {
        (0..).zip(&self.runs).filter(|(_, run)| !run.is_missing)
    }

    /// Returns true if no tile is missing.
    pub fn is_whole(&self) -> bool {
        self.rendered().count() == self.runs.len()
    }

    /// Returns the time from the start of the first tile to the end of the last one.
    pub fn span(&self) -> Duration {
        let end_ns = self.runs.iter().map(|run| run.end_ns).max();
        Duration::from_nanos(end_ns.unwrap_or(0))
    }

    /// Returns the sum of the counters of all tiles.
    pub fn counted(&self) -> Cost {
        let counted = self.runs.iter().map(|run| run.counted);
        counted.fold(Cost::default(), Cost::with)
    }

    /// Returns the number of ranks up to the last one that rendered tiles.
    pub fn n_ranks(&self) -> u32 {
        let last = self.rendered().map(|(_, run)| run.rank).max();
        last.map_or(1, |last| last + 1)
    }

    /// Returns the load balance of the threads.
    pub fn load(&self) -> Load {
        Load::measure(&self.runs, self.n_threads)
    }
}
