//! One rendering of a picture: the tiles that it takes over and keeps, and its end.

use std::time::Instant;

use super::canvas::Canvas;
use crate::checkpoint::{Checkpoint, TileRecord};
use crate::ranks::Team;
use crate::schedule::{Tile, TileRun};
use base::stop;
use world::scene::Scene;

/// The tiles that renderings of a picture take over and keep, and when they end.
#[derive(Debug, Clone, Copy, Default)]
pub struct Limits<'a> {
    /// Finished tiles, which are not rendered again, and the sink of new ones.
    pub checkpoint: Option<&'a Checkpoint>,
    /// The moment after which no further tile is started.
    pub deadline: Option<Instant>,
    /// The other ranks that render, if this is rank 0 of several.
    pub team: Option<&'a Team<'a>>,
    /// True if pixels are kept only in the files of the checkpoint: the film has none.
    pub is_stored: bool,
}

/// One of several renderings of a picture.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Pass<'a> {
    /// Number of the rendering, from 0.
    pub(super) number: u8,
    pub(super) limits: Limits<'a>,
    /// Numbers of the scene's objects and of its materials.
    n_ids: [usize; 2],
    /// The moment when its new tiles start, in nanoseconds after the first tile taken over.
    elapsed_ns: u64,
}

impl<'a> Pass<'a> {
    /// Creates the rendering with this number.
    pub(super) fn new(number: u8, scene: &Scene, limits: Limits<'a>) -> Self {
        let elapsed_ns = limits.checkpoint.map(|kept| kept.elapsed_ns(number));
        Self {
            number,
            limits,
            n_ids: [scene.n_objects(), scene.materials.len()],
            elapsed_ns: elapsed_ns.unwrap_or(0),
        }
    }

    /// Returns true if the result is discarded.
    pub(super) fn is_canceled(&self) -> bool {
        let Limits {
            checkpoint, team, ..
        } = self.limits;
        stop::is_requested()
            || checkpoint.is_some_and(Checkpoint::has_failed)
            || team.is_some_and(Team::has_failed)
    }

    /// Returns true if no further tile is started.
    pub(super) fn is_over(&self) -> bool {
        let deadline = self.limits.deadline;
        self.is_canceled() || deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }

    /// Takes over a finished tile. Returns `None` if it has to be rendered.
    pub(super) fn restored(&self, tile: &Tile, canvas: &Canvas) -> Option<TileRun> {
        let checkpoint = self.limits.checkpoint?;
        let record = checkpoint.restore(self.number, tile.number)?;
        let run = record.run;
        if self.store(tile, record, canvas) {
            return Some(run);
        }
        checkpoint.refuse(self.number, tile.number);
        None
    }

    /// Writes a tile that another run or another rank has rendered to the film. Returns false if it
    /// does not fit the scene.
    pub(super) fn store(&self, tile: &Tile, record: TileRecord, canvas: &Canvas) -> bool {
        canvas.restore(tile, record, self.n_ids)
    }

    /// Returns the number of threads of all ranks and all tiles.
    pub(super) fn n_threads(&self) -> u32 {
        let n_threads = self.n_threads_now();
        let checkpoint = self.limits.checkpoint;
        checkpoint.map_or(n_threads, |kept| kept.n_threads(n_threads))
    }

    /// Returns the number of threads of all ranks.
    fn n_threads_now(&self) -> u32 {
        match self.limits.team {
            Some(team) => team.n_threads(),
            None => rayon::current_num_threads() as u32,
        }
    }

    /// Returns the run of a new tile, moved after the tiles that were taken over.
    pub(super) fn after_restored(&self, run: TileRun) -> TileRun {
        TileRun {
            start_ns: run.start_ns + self.elapsed_ns,
            end_ns: run.end_ns + self.elapsed_ns,
            ..run
        }
    }

    /// Does `work`, and flushes the kept tiles to the system.
    pub(super) fn keeping<T>(&self, work: impl FnOnce() -> T) -> T {
        let Some(checkpoint) = self.limits.checkpoint.filter(|kept| kept.keeps()) else {
            return work();
        };
        checkpoint.begin(self.n_threads_now());
        let done = work();
        checkpoint.flush();
        done
    }

    /// Keeps a finished tile, if tiles are kept.
    pub(super) fn keep(&self, tile: &Tile, run: TileRun, canvas: &Canvas) {
        if let Some(checkpoint) = self.limits.checkpoint.filter(|kept| kept.keeps()) {
            checkpoint.keep(&canvas.record(tile, self.number, run));
        }
    }
}
