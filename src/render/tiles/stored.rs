//! A picture that is larger than memory: its pixels are in files of tiles.

use std::ops::Range;

use rayon::prelude::*;

use super::canvas::Canvas;
use super::clear_missing;
use super::samples::Samples;
use crate::checkpoint::Checkpoint;
use crate::film::{Film, STRIP_ROWS};
use crate::schedule::{Schedule, TileGrid};
use world::scene::Scene;

/// A rendered picture whose pixels are read band by band.
#[derive(Debug, Clone, Copy)]
pub struct StoredPicture<'a> {
    /// The film without its pixels.
    pub film: &'a Film,
    schedule: &'a Schedule,
    checkpoint: &'a Checkpoint,
    /// Numbers of the scene's objects and of its materials.
    n_ids: [usize; 2],
}

impl<'a> StoredPicture<'a> {
    /// Creates the picture of a scene whose tiles are in the files of the checkpoint.
    pub fn new(
        scene: &Scene,
        film: &'a Film,
        schedule: &'a Schedule,
        checkpoint: &'a Checkpoint,
    ) -> Self {
        Self {
            film,
            schedule,
            checkpoint,
            n_ids: [scene.n_objects(), scene.materials.len()],
        }
    }

    /// Returns the least number of rows of a band: whole tiles, and whole strips as in a film with
    /// all rows. The rows of a band are a multiple of it.
    pub fn row_unit(grid: &TileGrid) -> u32 {
        let strips = [1, 2, STRIP_ROWS];
        let factor = strips
            .into_iter()
            .find(|n| (grid.tile_size * n).is_multiple_of(STRIP_ROWS));
        grid.tile_size * factor.unwrap_or(STRIP_ROWS)
    }

    /// Reads some rows on the current rayon pool, from a multiple of the [unit](Self::row_unit) to
    /// another one or the last row, and the sum of the times of each rendering, in nanoseconds.
    /// Returns `None` if a file cannot be read, which the checkpoint records.
    pub fn band(&self, rows: Range<u32>) -> Option<(Film, Vec<f64>)> {
        let mut film = self.film.clone().with_rows(rows.clone());
        let has_spread = film.cost.has_time() && film.repeats.has_spread();
        let mut samples = has_spread.then(|| Samples::new(&film));
        let mut sums_ns = Vec::new();
        for rendering in 0..film.n_repeats {
            self.read_tiles(rendering, &rows, &mut film);
            sums_ns.push(film.total_time_ns());
            if let Some(samples) = &mut samples {
                samples.take(&film);
            }
        }
        if let Some(samples) = samples {
            samples.summarize(&mut film);
        }
        (!self.checkpoint.has_failed()).then_some((film, sums_ns))
    }

    /// Writes the tiles of some rows to the film; missing ones are black.
    fn read_tiles(&self, rendering: u8, rows: &Range<u32>, film: &mut Film) {
        let grid = film.grid.for_rendering(rendering, film.cost);
        let canvas = Canvas::new(film, &grid);
        let last = grid.number_at(grid.width - 1, rows.end - 1);
        let numbers = grid.number_at(0, rows.start)..last + 1;
        numbers.clone().into_par_iter().for_each(|number| {
            let tile = grid.tile(number);
            let Some(record) = self.checkpoint.tile(rendering, number) else {
                return;
            };
            if !canvas.restore(&tile, record, self.n_ids) {
                self.checkpoint.refuse(rendering, number);
            }
        });
        if rendering == 0 {
            clear_missing(self.schedule, numbers, &canvas);
        }
    }
}
