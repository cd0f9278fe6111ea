//! The tiles of a rendering that no thread has begun.

use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;

use super::canvas::Canvas;
use super::pass::{Finished, Pass};
use super::{Progress, TilePlan, TileRenderer, render_tile};
use crate::cost::Interruptions;
use crate::schedule::{Tile, TileRun};
use crate::stop;

/// Tiles with their numbers that a thread has rendered or taken over.
pub(super) type TileRuns = Vec<(u32, TileRun)>;

/// Tiles in the order of a plan, which threads take one by one.
pub(super) struct TileQueue<'a, 'f, F> {
    pub(super) plan: &'a TilePlan,
    pub(super) pass: &'a Pass<'a>,
    pub(super) canvas: &'a Canvas<'f>,
    pub(super) finished: &'a Finished,
    pub(super) report: &'a F,
    /// When the rendering begins.
    pub(super) begin: Instant,
    /// The number of tiles that were taken.
    n_taken: AtomicU32,
}

impl<'a, 'f, F: Fn(Progress) + Sync> TileQueue<'a, 'f, F> {
    /// All tiles of the plan.
    pub(super) fn new(
        plan: &'a TilePlan,
        pass: &'a Pass<'a>,
        (canvas, finished): (&'a Canvas<'f>, &'a Finished),
        report: &'a F,
    ) -> Self {
        Self {
            plan,
            pass,
            canvas,
            finished,
            report,
            begin: Instant::now(),
            n_taken: AtomicU32::new(0),
        }
    }

    /// Renders tiles on the calling thread, which has this number, until none is left.
    pub(super) fn render(&self, thread: u32, mut renderer: impl TileRenderer) -> TileRuns {
        let mut interruptions = Interruptions::of_this_thread();
        let mut runs = TileRuns::new();
        while let Some((position, tile)) = self.next(&mut runs) {
            interruptions.take();
            let run = render_tile(&mut renderer, &tile, self.canvas, self.begin);
            let run = self.pass.after_restored(TileRun {
                thread,
                position,
                is_interrupted: interruptions.take(),
                ..run
            });
            self.add(&mut runs, tile, run);
        }
        runs
    }

    /// The next tile that has to be rendered, and its position; takes over the tiles before
    /// it that other runs have rendered.
    pub(super) fn next(&self, runs: &mut TileRuns) -> Option<(u32, Tile)> {
        loop {
            let position = self.n_taken.fetch_add(1, Ordering::Relaxed);
            let tile = self.plan.tile(position);
            let tile = tile.filter(|_| !self.pass.is_canceled())?;
            match self.pass.restored(&tile, self.canvas) {
                Some(run) => self.note(runs, &tile, TileRun { position, ..run }, true),
                None if self.pass.is_over() => {}
                None => return Some((position, tile)),
            }
        }
    }

    /// Takes note of a tile that was rendered into the film.
    pub(super) fn add(&self, runs: &mut TileRuns, tile: Tile, run: TileRun) {
        // A tile that was stopped is not whole.
        if !stop::is_requested() {
            self.finished.add(tile, run);
        }
        self.note(runs, &tile, run, false);
    }

    /// Number of tiles that no thread has taken.
    pub(super) fn n_left(&self) -> u32 {
        let n_taken = self.n_taken.load(Ordering::Relaxed);
        self.plan.n_tiles().saturating_sub(n_taken)
    }

    fn note(&self, runs: &mut TileRuns, tile: &Tile, run: TileRun, is_restored: bool) {
        runs.push((tile.number, run));
        (self.report)(Progress {
            n_pixels: tile.n_pixels() as u64,
            n_rays: run.counted.n_rays(),
            work: self.plan.work(tile),
            is_restored,
        });
    }
}
