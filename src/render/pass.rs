//! One rendering of a picture: the tiles that it takes over and keeps, and its end.

use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

use super::canvas::Canvas;
use crate::checkpoint::{Checkpoint, TileRecord};
use crate::ranks::Team;
use crate::scene::Scene;
use crate::schedule::{Tile, TileRun};
use crate::stop;

/// How often finished tiles are given to the system.
const FLUSH_EVERY: Duration = Duration::from_millis(250);

/// What renderings of a picture take over and keep, and when they end.
#[derive(Debug, Clone, Copy, Default)]
pub struct Limits<'a> {
    /// Finished tiles, which are not rendered again, and where new ones are kept.
    pub checkpoint: Option<&'a Checkpoint>,
    /// When no further tile is begun.
    pub deadline: Option<Instant>,
    /// The other ranks that render, if this is rank 0 of several.
    pub team: Option<&'a Team>,
}

/// One of several renderings of a picture.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Pass<'a> {
    /// Its number, from 0.
    pub(super) number: u8,
    pub(super) limits: Limits<'a>,
    /// The number of the scene's objects, and of its materials.
    n_ids: [usize; 2],
    /// When its new tiles begin, in nanoseconds after the first of those taken over.
    elapsed_ns: u64,
}

/// Takes note of finished tiles.
pub(super) struct Finished(Option<Sender<(Tile, TileRun)>>);

impl<'a> Pass<'a> {
    /// The rendering with this number.
    pub(super) fn new(number: u8, scene: &Scene, limits: Limits<'a>) -> Self {
        let elapsed_ns = limits.checkpoint.map(|kept| kept.elapsed_ns(number));
        Self {
            number,
            limits,
            n_ids: [scene.n_objects(), scene.materials.len()],
            elapsed_ns: elapsed_ns.unwrap_or(0),
        }
    }

    /// Whether the result counts for nothing.
    pub(super) fn is_canceled(&self) -> bool {
        let Limits {
            checkpoint, team, ..
        } = self.limits;
        stop::is_requested()
            || checkpoint.is_some_and(Checkpoint::has_failed)
            || team.is_some_and(Team::has_failed)
    }

    /// Whether no further tile is begun.
    pub(super) fn is_over(&self) -> bool {
        let deadline = self.limits.deadline;
        self.is_canceled() || deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }

    /// Takes over a finished tile; `None` if it has to be rendered.
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

    /// Writes a tile that another run or another rank has rendered to the film; false if it
    /// does not fit the scene.
    pub(super) fn store(&self, tile: &Tile, record: TileRecord, canvas: &Canvas) -> bool {
        canvas.restore(tile, record, self.n_ids)
    }

    /// Number of threads of all ranks and all tiles.
    pub(super) fn n_threads(&self) -> u32 {
        let n_threads = self.n_threads_now();
        let checkpoint = self.limits.checkpoint;
        checkpoint.map_or(n_threads, |kept| kept.n_threads(n_threads))
    }

    /// Number of threads of all ranks.
    fn n_threads_now(&self) -> u32 {
        match self.limits.team {
            Some(team) => team.n_threads(),
            None => rayon::current_num_threads() as u32,
        }
    }

    /// The run of a new tile, after those that were taken over.
    pub(super) fn after_restored(&self, run: TileRun) -> TileRun {
        TileRun {
            start_ns: run.start_ns + self.elapsed_ns,
            end_ns: run.end_ns + self.elapsed_ns,
            ..run
        }
    }

    /// Does `work`, while a thread of its own keeps the tiles that are finished.
    pub(super) fn keeping<T>(&self, canvas: &Canvas, work: impl FnOnce(&Finished) -> T) -> T {
        let Some(checkpoint) = self.limits.checkpoint.filter(|kept| kept.keeps()) else {
            return work(&Finished(None));
        };
        checkpoint.begin(self.n_threads_now());
        std::thread::scope(|scope| {
            let (sender, receiver) = mpsc::channel();
            scope.spawn(move || self.keep(checkpoint, canvas, &receiver));
            work(&Finished(Some(sender)))
        })
    }

    /// Keeps tiles until the last of their senders ends.
    fn keep(&self, checkpoint: &Checkpoint, canvas: &Canvas, finished: &Receiver<(Tile, TileRun)>) {
        let mut flushed = Instant::now();
        loop {
            let left = FLUSH_EVERY.saturating_sub(flushed.elapsed());
            match finished.recv_timeout(left) {
                Ok((tile, run)) => checkpoint.keep(&canvas.record(&tile, self.number, run)),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            if flushed.elapsed() >= FLUSH_EVERY {
                checkpoint.flush();
                flushed = Instant::now();
            }
        }
        checkpoint.flush();
    }
}

impl Finished {
    /// The tile is in the film as a whole.
    pub(super) fn add(&self, tile: Tile, run: TileRun) {
        if let Some(sender) = &self.0 {
            // The receiver ends after all senders.
            let _ = sender.send((tile, run));
        }
    }
}
