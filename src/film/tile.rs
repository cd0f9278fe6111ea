//! What a film stores by tile.

use super::{Film, PackedCounters, Strip};
use crate::cost::Counter;

/// The thread that rendered a tile, and the tile's counters.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RenderedTile {
    /// The thread that rendered it, from 0.
    pub thread: u32,
    /// The counters of its pixels, in parts of whole rows from top to bottom; empty
    /// if nothing was counted.
    pub counters: Vec<PackedCounters>,
}

impl Film {
    /// Overwrites `numbers` with the tiles of the pixels of a strip.
    pub fn tile_numbers(&self, strip: &Strip, numbers: &mut Vec<u32>) {
        self.by_tile(strip, numbers, |number| number);
    }

    /// Overwrites `threads` with the threads that rendered the pixels of a strip.
    pub fn threads(&self, strip: &Strip, threads: &mut Vec<u32>) {
        self.by_tile(strip, threads, |number| self.tiles[number as usize].thread);
    }

    /// Adds one counter of the pixels of a strip to `sums`.
    pub(super) fn add_counts(&self, strip: &Strip, counter: Counter, sums: &mut [u32]) {
        let width = self.grid.width as usize;
        let rows = sums.chunks_exact_mut(width).zip(strip.first_row..);
        for (sums, y) in rows {
            for tile in self.grid.tiles_of_row(y) {
                let first = (y - tile.rows[0]) as usize * tile.width();
                let [left, right] = tile.columns.map(|column| column as usize);
                self.tiles[tile.number as usize].add_to(counter, first, &mut sums[left..right]);
            }
        }
    }

    /// Overwrites `numbers` with a value per tile, for the pixels of a strip.
    fn by_tile(&self, strip: &Strip, numbers: &mut Vec<u32>, of: impl Fn(u32) -> u32) {
        numbers.clear();
        for y in strip.first_row..strip.first_row + strip.n_rows {
            for tile in self.grid.tiles_of_row(y) {
                numbers.resize(numbers.len() + tile.width(), of(tile.number));
            }
        }
    }
}

impl RenderedTile {
    /// Adds one counter of the pixels from index `first` on, all in the same row, to
    /// `sums`.
    fn add_to(&self, counter: Counter, mut first: usize, sums: &mut [u32]) {
        for part in &self.counters {
            if first < part.n_pixels() {
                part.add_to(counter, first, sums);
                return;
            }
            first -= part.n_pixels();
        }
    }
}
