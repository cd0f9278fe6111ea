//! A film that many threads write to.

use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::film::{Film, Rendered, STRIP_ROWS, Strip};
use crate::schedule::Tile;

/// A film's strips, each behind a lock of its own.
pub(super) struct Canvas<'a> {
    strips: Vec<Mutex<&'a mut Strip>>,
    /// Pixels of a row.
    width: usize,
}

impl<'a> Canvas<'a> {
    pub(super) fn of(film: &'a mut Film) -> Self {
        Self {
            width: film.width as usize,
            strips: film.strips.iter_mut().map(Mutex::new).collect(),
        }
    }

    /// Puts a tile's pixels into the film.
    pub(super) fn store(&self, tile: &Tile, rendered: &Rendered) {
        let [left, right] = tile.columns;
        let width = (right - left) as usize;
        let [top, bottom] = tile.rows;
        for number in top / STRIP_ROWS..=(bottom - 1) / STRIP_ROWS {
            // One at a time, so that no thread waits for another's.
            let mut strip = self.strip(number);
            let first_row = strip.first_row;
            for y in top.max(first_row)..bottom.min(first_row + strip.n_rows) {
                let first = (y - first_row) as usize * self.width + left as usize;
                let from = tile.index((left, y)) as usize;
                strip.put(first, rendered, from..from + width);
            }
        }
    }

    fn strip(&self, number: u32) -> MutexGuard<'_, &'a mut Strip> {
        let strip = self.strips[number as usize].lock();
        strip.unwrap_or_else(PoisonError::into_inner)
    }
}
