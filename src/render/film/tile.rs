//! The values that a film stores by tile.

use std::ops::Range;

use super::{Film, PackedCounters, Strip};
use crate::schedule::{MAX_PIXELS, TileGrid};
use tracer::cost::Counter;

/// The thread that rendered a tile, and the tile's counters.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RenderedTile {
    /// True if the tile was not rendered: its pixels are black and hit nothing.
    pub is_missing: bool,
    /// The thread that rendered the tile, from 0.
    pub thread: u32,
    /// The counters of the pixels, in parts of whole rows from top to bottom; empty if nothing was
    /// counted.
    pub counters: Vec<PackedCounters>,
}

impl Film {
    /// Overwrites `numbers` with the tiles of the pixels of a strip.
    pub fn tile_numbers(&self, strip: &Strip, numbers: &mut Vec<u32>) {
        self.by_tile(strip, numbers, |number| number);
    }

    /// Overwrites `threads` with the threads that rendered the pixels of a strip; -1, as 32 bits,
    /// for pixels that were not rendered.
    pub fn threads(&self, strip: &Strip, threads: &mut Vec<u32>) {
        self.by_tile(strip, threads, |number| {
            match &self.tiles[number as usize] {
                tile if tile.is_missing => u32::MAX,
                tile => tile.thread,
            }
        });
    }

    /// Overwrites `groups` with the groups that the pixels of a strip are timed in, each by the
    /// number of its first pixel.
    pub(super) fn groups(&self, strip: &Strip, groups: &mut Vec<u32>) {
        let width = self.grid.width;
        groups.clear();
        groups.resize((strip.n_rows * width) as usize, 0);
        let rows = strip.first_row..strip.first_row + strip.n_rows;
        let size = self.grid.tile_size;
        let rows_of_tiles = rows.start / size..rows.end.div_ceil(size);
        let n_columns = self.grid.n_columns;
        for number in rows_of_tiles.start * n_columns..rows_of_tiles.end * n_columns {
            let tile = self.grid.tile(number);
            let parts = tile.parts(MAX_PIXELS);
            for group in parts.flat_map(|part| part.groups(self.n_samples)) {
                let first = group.rows[0] * width + group.columns[0];
                for (x, y) in group.pixels().filter(|(_, y)| rows.contains(y)) {
                    groups[((y - strip.first_row) * width + x) as usize] = first;
                }
            }
        }
    }

    /// Returns the tiles of the film's rows.
    pub fn tiles_of_rows(&self) -> &[RenderedTile] {
        self.tiles_at(self.row_range())
    }

    /// Returns the tiles that have pixels in these rows of the grid.
    fn tiles_at(&self, rows: Range<u32>) -> &[RenderedTile] {
        let TileGrid {
            tile_size,
            n_columns,
            ..
        } = self.grid;
        let [first, end] = [rows.start / tile_size, rows.end.div_ceil(tile_size)];
        &self.tiles[(first * n_columns) as usize..(end * n_columns) as usize]
    }

    /// Returns the number of tiles that were not rendered.
    pub fn n_missing_tiles(&self) -> usize {
        self.tiles.iter().filter(|tile| tile.is_missing).count()
    }

    /// Returns true if the pixel in column `x` and row `y` was rendered.
    pub(crate) fn is_rendered(&self, x: u32, y: u32) -> bool {
        !self.tiles[self.grid.number_at(x, y) as usize].is_missing
    }

    /// Sets the numbers of a strip's pixels that were not rendered to 0.
    pub(super) fn clear_missing(&self, strip: &Strip, numbers: &mut [u32]) {
        let rows = strip.first_row..strip.first_row + strip.n_rows;
        if !self.tiles_at(rows).iter().any(|tile| tile.is_missing) {
            return;
        }
        let places = (strip.first_row..).flat_map(|y| (0..self.grid.width).map(move |x| (x, y)));
        for (number, (x, y)) in numbers.iter_mut().zip(places) {
            if !self.is_rendered(x, y) {
                *number = 0;
            }
        }
    }

    /// Adds one counter of the pixels of a strip to `sums`, tile by tile.
    pub(super) fn add_counts(&self, strip: &Strip, counter: Counter, sums: &mut [u32]) {
        let TileGrid {
            tile_size, width, ..
        } = self.grid;
        let end = strip.first_row + strip.n_rows;
        let mut y = strip.first_row;
        while y < end {
            // The rows that the strip shares with a row of tiles.
            let first = y % tile_size;
            let n_rows = (tile_size - first).min(end - y);
            let begin = (y - strip.first_row) as usize * width as usize;
            let rows = SharedRows {
                first: first as usize,
                n: n_rows as usize,
                stride: width as usize,
            };
            self.add_tiles(y / tile_size, counter, &rows, &mut sums[begin..]);
            y += n_rows;
        }
    }

    /// Adds one counter of a row of tiles to `sums`.
    fn add_tiles(&self, row: u32, counter: Counter, rows: &SharedRows, sums: &mut [u32]) {
        let [tile_size, width] = [self.grid.tile_size, self.grid.width].map(|n| n as usize);
        let n_columns = self.grid.n_columns as usize;
        let tiles = &self.tiles[row as usize * n_columns..][..n_columns];
        for (tile, left) in tiles.iter().zip((0..).step_by(tile_size)) {
            tile.add_rows(
                counter,
                tile_size.min(width - left),
                rows,
                &mut sums[left..],
            );
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

/// Some rows of a tile, and of the pixels that they belong to.
struct SharedRows {
    /// The first row in the tile.
    first: usize,
    /// Number of rows.
    n: usize,
    /// Distance of two rows of pixels.
    stride: usize,
}

impl RenderedTile {
    /// Adds one counter of these rows, each of `width` pixels, to rows of `sums`.
    fn add_rows(&self, counter: Counter, width: usize, rows: &SharedRows, sums: &mut [u32]) {
        let wanted = rows.first * width..(rows.first + rows.n) * width;
        let mut begin = 0;
        for part in &self.counters {
            let end = begin + part.n_pixels();
            // Parts have whole rows.
            let shared = wanted.start.max(begin)..wanted.end.min(end);
            if !shared.is_empty() {
                let row = (shared.start - wanted.start) / width;
                let pixels = shared.start - begin..shared.end - begin;
                let sums = &mut sums[row * rows.stride..];
                part.add_to(counter, pixels, [width, rows.stride], sums);
            }
            begin = end;
        }
    }
}
