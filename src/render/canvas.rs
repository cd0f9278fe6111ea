//! A film that many threads write to.

use std::sync::{Mutex, MutexGuard, PoisonError};

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
        let mut pixels = pixels;
        let mut number = tile.rows[0] / STRIP_ROWS;
        let mut strip = self.strip(number);
        for (y, columns) in tile.block_rows() {
            if y / STRIP_ROWS != number {
                // One at a time, so that no thread waits for another's.
                drop(strip);
                number = y / STRIP_ROWS;
                strip = self.strip(number);
            }
            let (row, rest) = pixels.split_at(columns.len());
            let first = (y - strip.first_row) as usize * self.width + columns.start as usize;
            strip.put(first, row);
            pixels = rest;
        }
    }

    fn strip(&self, number: u32) -> MutexGuard<'_, &'a mut Strip> {
        let strip = self.strips[number as usize].lock();
        strip.unwrap_or_else(PoisonError::into_inner)
    }
}
