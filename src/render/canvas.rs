//! Concurrent writes to a film.

use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::checkpoint::TileRecord;
use crate::color::Development;
use crate::film::{Film, PackedCounters, Pixel, Rendered, RenderedTile, STRIP_ROWS, Strip};
use crate::schedule::{Tile, TileRun};

/// A film whose strips and tiles each have a lock.
pub(super) struct Canvas<'a> {
    strips: Vec<Mutex<&'a mut Strip>>,
    tiles: Vec<Mutex<&'a mut RenderedTile>>,
    /// Pixels per row.
    width: usize,
    /// Pixels along a tile's side.
    tile_size: u32,
    development: Development,
}

impl<'a> Canvas<'a> {
    /// Writes to a film, which may hold an earlier rendering.
    pub(super) fn of(film: &'a mut Film) -> Self {
        Self {
            tile_size: film.grid.tile_size,
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
            let mut stored = lock(&self.tiles[tile.number as usize]);
            if tile.rows[0].is_multiple_of(self.tile_size) {
                // Those of an earlier rendering.
                stored.counters.clear();
            }
            stored.counters.push(packed);
        }
        let [left, _] = tile.columns;
        let [top, bottom] = tile.rows;
        for number in strips_of(tile) {
            // One lock at a time, so that threads cannot deadlock.
            let mut strip = lock(&self.strips[number]);
            let first_row = strip.first_row;
            for y in top.max(first_row)..bottom.min(first_row + strip.n_rows) {
                let first = (y - first_row) as usize * self.width + left as usize;
                let from = tile.index((left, y)) as usize;
                let row = from..from + tile.width();
                strip.put(first, rendered, row, &self.development);
            }
        }
    }

    /// Returns a finished tile as a record of this rendering.
    pub(super) fn record(&self, tile: &Tile, rendering: u8, run: TileRun) -> TileRecord {
        let mut pixels = Vec::new();
        for number in strips_of(tile) {
            lock(&self.strips[number]).append_pixels(tile, &mut pixels);
        }
        TileRecord {
            rendering,
            tile: tile.number,
            run,
            counters: lock(&self.tiles[tile.number as usize]).counters.clone(),
            pixels,
        }
    }

    /// Writes the pixels and counters of a record of this tile; false, with any pixels, if
    /// it shows none of so many objects and materials, or its size is wrong.
    pub(super) fn restore(&self, tile: &Tile, record: TileRecord, n_ids: [usize; 2]) -> bool {
        lock(&self.tiles[tile.number as usize]).counters = record.counters;
        let mut bytes = &record.pixels[..];
        for number in strips_of(tile) {
            let mut strip = lock(&self.strips[number]);
            let Some(rest) = strip.restore_pixels(tile, bytes) else {
                return false;
            };
            bytes = rest;
            if !strip.has_only(tile, n_ids) {
                return false;
            }
        }
        bytes.is_empty()
    }

    /// Makes the pixels of a tile, or of its next rows, black without a hit.
    pub(super) fn clear(&self, tile: &Tile) {
        let pixels = vec![Pixel::default(); tile.n_pixels()];
        self.store(
            tile,
            &Rendered {
                pixels: &pixels,
                counters: None,
                bounces: &[],
                times: &[],
                warm_up_ns: 0.0,
            },
        );
    }
}

/// The numbers of the strips that a tile crosses.
fn strips_of(tile: &Tile) -> std::ops::RangeInclusive<usize> {
    let [top, bottom] = tile.rows;
    (top / STRIP_ROWS) as usize..=((bottom - 1) / STRIP_ROWS) as usize
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
