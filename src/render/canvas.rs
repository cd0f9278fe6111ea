//! A film that many threads write to.

use std::sync::{Mutex, PoisonError};

use crate::film::{Film, Pixel, STRIP_ROWS, Strip};
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

    /// Puts a tile's pixels, in the order of [`Tile::pixels`], into the film.
    pub(super) fn store(&self, tile: &Tile, pixels: &[Pixel]) {
        let [left, right] = tile.columns.map(|column| column as usize);
        let [top, bottom] = tile.rows;
        let mut rows = pixels.chunks_exact(right - left);
        for number in top / STRIP_ROWS..bottom.div_ceil(STRIP_ROWS) {
            let strip = &self.strips[number as usize];
            let mut strip = strip.lock().unwrap_or_else(PoisonError::into_inner);
            let first = top.max(strip.first_row) - strip.first_row;
            let end = (bottom - strip.first_row).min(strip.n_rows);
            for (row, pixels) in (first..end).zip(rows.by_ref()) {
                strip.put(row as usize * self.width + left, pixels);
            }
        }
    }
}
