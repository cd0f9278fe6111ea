//! Concurrent writes to a film.

use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::color::Development;
use crate::film::{Film, PackedCounters, Rendered, RenderedTile, STRIP_ROWS, Strip};
use crate::schedule::Tile;

/// A film whose strips and tiles each have a lock.
pub(super) struct Canvas<'a> {
    strips: Vec<Mutex<&'a mut Strip>>,
    tiles: Vec<Mutex<&'a mut RenderedTile>>,
    /// Pixels per row.
    width: usize,
    development: Development,
}

impl<'a> Canvas<'a> {
    /// Clears the tiles, as the film may hold an earlier rendering.
    pub(super) fn of(film: &'a mut Film) -> Self {
        film.tiles.fill(RenderedTile::default());
        Self {
            width: film.grid.width as usize,
            development: film.development,
            strips: film.strips.iter_mut().map(Mutex::new).collect(),
            tiles: film.tiles.iter_mut().map(Mutex::new).collect(),
        }
    }

    /// Writes the pixels of a tile, or of its next rows, to the film.
    pub(super) fn store(&self, tile: &Tile, rendered: &Rendered) {
        if let Some(counters) = rendered.counters {
            let packed = PackedCounters::new(counters);
            lock(&self.tiles[tile.number as usize])
                .counters
                .push(packed);
        }
        let [left, _] = tile.columns;
        let [top, bottom] = tile.rows;
        for number in top / STRIP_ROWS..=(bottom - 1) / STRIP_ROWS {
            // One lock at a time, so that threads cannot deadlock.
            let mut strip = lock(&self.strips[number as usize]);
            let first_row = strip.first_row;
            for y in top.max(first_row)..bottom.min(first_row + strip.n_rows) {
                let first = (y - first_row) as usize * self.width + left as usize;
                let from = tile.index((left, y)) as usize;
                let row = from..from + tile.width();
                strip.put(first, rendered, row, &self.development);
            }
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
