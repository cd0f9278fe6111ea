//! The tiles of a rendering that no thread has started.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::Receiver;
use std::sync::{Mutex, OnceLock};
use std::time::Instant;

use super::canvas::Canvas;
use super::pass::Pass;
use super::tile_batch::{self, TileBatch, TileBatches};
use super::{OnProgress, Progress, TilePlan, TileRenderer, render_tile};
use crate::checkpoint::TileRecord;
use crate::film::Film;
use crate::ranks::{RankFailure, Team};
use crate::schedule::{Tile, TileGrid, TileRun};
use base::stop;

/// Tiles with their numbers that a thread has rendered or taken over.
pub(super) type TileRuns = Vec<(u32, TileRun)>;

/// The target that threads render tiles to.
pub(super) enum Target<'f> {
    /// The film of the picture.
    Film(Canvas<'f>),
    /// Films of one tile of the grid, one for each thread, like this one without rows: the pass
    /// keeps the tiles.
    Tiles(&'f Film, TileGrid),
}

impl<'f> Target<'f> {
    /// Returns the film for the tiles of a grid, which gets rows if it has none, or films of one tile
    /// if tiles are `stored` elsewhere.
    pub(super) fn new(film: &'f mut Film, grid: &TileGrid, stored: bool) -> Self {
        if stored {
            return Self::Tiles(film, *grid);
        }
        if !film.has_rows() {
            *film = film.clone().with_rows(0..film.grid.height);
        }
        Self::Film(Canvas::new(film, grid))
    }

    /// Does `work` with the canvas of the calling thread.
    fn with_canvas<T>(&self, work: impl FnOnce(&Canvas) -> T) -> T {
        match self {
            Self::Film(canvas) => work(canvas),
            Self::Tiles(film, grid) => work(&Canvas::one_tile(&mut film.empty_tile(), *grid)),
        }
    }
}

/// Tiles in the order of a plan, which threads take one by one.
pub(super) struct TileQueue<'a, 'f> {
    pub(super) plan: &'a TilePlan,
    pub(super) pass: &'a Pass<'a>,
    target: &'a OnceLock<Target<'f>>,
    pub(super) report: OnProgress<'a>,
    /// The moment when the rendering started.
    pub(super) begin: Instant,
    /// Number of tiles that were taken.
    n_taken: AtomicU32,
    /// Tiles that other ranks have returned.
    batches: TileBatches,
}

impl<'a, 'f> TileQueue<'a, 'f> {
    /// Queues all tiles of the plan; the target may be made meanwhile, and other ranks may return
    /// `batches` of tiles.
    pub(super) fn new(
        plan: &'a TilePlan,
        pass: &'a Pass<'a>,
        target: &'a OnceLock<Target<'f>>,
        report: OnProgress<'a>,
        batches: Receiver<TileBatch>,
    ) -> Self {
        Self {
            plan,
            pass,
            target,
            report,
            begin: Instant::now(),
            n_taken: AtomicU32::new(0),
            batches: TileBatches(Mutex::new(batches)),
        }
    }

    /// Waits for the target, and does `work` with the canvas of the calling thread.
    pub(super) fn with_canvas<T>(&self, work: impl FnOnce(&Canvas) -> T) -> T {
        self.target.wait().with_canvas(work)
    }

    /// Renders tiles on the calling thread, which has this number, until none is left, and stores
    /// those that other ranks return meanwhile and afterwards.
    pub(super) fn render(&self, thread: u32, renderer: &mut dyn TileRenderer) -> TileRuns {
        self.with_canvas(|canvas| self.render_on(canvas, thread, renderer))
    }

    fn render_on(&self, canvas: &Canvas, thread: u32, renderer: &mut dyn TileRenderer) -> TileRuns {
        let mut runs = TileRuns::new();
        while let Some((position, tile)) = self.next(&mut runs, Some(canvas)) {
            let run = render_tile(renderer, self.plan, &tile, canvas, self.begin);
            let run = self.pass.after_restored(TileRun {
                thread,
                position,
                ..run
            });
            self.add(&mut runs, tile, run, canvas);
            while let Some(batch) = self.batches.take() {
                self.store_timed(&batch, &mut runs, canvas);
            }
        }
        while let Some(batch) = self.batches.wait() {
            self.store_timed(&batch, &mut runs, canvas);
        }
        runs
    }

    /// Stores the next batch of tiles. Returns false if there is none now, or no target.
    pub(super) fn store_next(&self, runs: &mut TileRuns) -> bool {
        let Some(target) = self.target.get() else {
            return false;
        };
        let batch = self.batches.take();
        if let Some(batch) = &batch {
            target.with_canvas(|canvas| self.store(batch, runs, canvas));
        }
        batch.is_some()
    }

    /// Stores a batch of tiles, and adds the time to the communication of rank 0.
    fn store_timed(&self, batch: &TileBatch, runs: &mut TileRuns, canvas: &Canvas) {
        let begin = Instant::now();
        self.store(batch, runs, canvas);
        if let Some(team) = self.pass.limits.team {
            team.add_communication(begin);
        }
    }

    /// Writes a batch of tiles to the canvas, and records them; ends the rendering if one does not
    /// fit.
    pub(super) fn store(&self, batch: &TileBatch, runs: &mut TileRuns, canvas: &Canvas) {
        let Some(team) = self.pass.limits.team else {
            return;
        };
        for (bytes, &position) in tile_batch::split(&batch.bytes).zip(&batch.positions) {
            let record = bytes.and_then(|bytes| TileRecord::parse(bytes, &team.layout));
            let stored = record.and_then(|record| {
                let tile = self.plan.grid.tile(record.tile);
                let run = self.on_our_clock(team, batch.rank, record.run);
                let fits = self.pass.store(&tile, record, canvas);
                fits.then_some((tile, TileRun { position, ..run }))
            });
            let Some((tile, run)) = stored else {
                return team.fail(batch.rank, RankFailure::foreign_tile());
            };
            self.add(runs, tile, run, canvas);
        }
    }

    /// Returns a worker's run with the rank, the number of its thread among the threads of all
    /// ranks, and times since this rendering started.
    fn on_our_clock(&self, team: &Team, rank: u32, run: TileRun) -> TileRun {
        let member = &team.members[rank as usize];
        let begin_ns = self.begin - team.ranks.epoch;
        let begin_ns = begin_ns.as_nanos() as i64 + member.clock_ns;
        let start_ns = (run.start_ns as i64 - begin_ns).max(0) as u64;
        self.pass.after_restored(TileRun {
            rank,
            thread: member.first_thread + run.thread,
            start_ns,
            end_ns: start_ns + run.duration_ns(),
            ..run
        })
    }

    /// Returns the next tile that has to be rendered, and its position; takes over the tiles before
    /// it that other runs have rendered, if there is a canvas.
    pub(super) fn next(&self, runs: &mut TileRuns, canvas: Option<&Canvas>) -> Option<(u32, Tile)> {
        loop {
            let position = self.n_taken.fetch_add(1, Ordering::Relaxed);
            let tile = self.plan.tile(position);
            let tile = tile.filter(|_| !self.pass.is_canceled())?;
            let restored = canvas.and_then(|canvas| self.pass.restored(&tile, canvas));
            match restored {
                Some(run) => self.note(runs, &tile, TileRun { position, ..run }, true),
                None if self.pass.is_over() => {}
                None => return Some((position, tile)),
            }
        }
    }

    /// Records a tile that was rendered to the canvas.
    fn add(&self, runs: &mut TileRuns, tile: Tile, run: TileRun, canvas: &Canvas) {
        // A tile that was stopped is not whole.
        if !stop::is_requested() {
            self.pass.keep(&tile, run, canvas);
        }
        self.note(runs, &tile, run, false);
    }

    /// Returns the number of tiles that no thread has taken.
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
