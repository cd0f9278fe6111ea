//! The tiles of a film.

use std::ops::Range;

use crate::film::{Film, Pixel, STRIP_ROWS, Strip};

/// Pixels along a tile's side: small enough to share out evenly, large enough
/// that one tile's film is written at one go.
pub const TILE_SIDE: u32 = STRIP_ROWS;

/// Pixels along the side of a block of a tile: the rays of a packet.
const BLOCK_SIDE: u32 = 4;

/// A film's tiles, numbered along rows from the top left.
pub(super) struct Tiles {
    /// How many.
    pub(super) n: u32,
    n_columns: u32,
    /// Pixels of the film.
    width: u32,
    height: u32,
}

impl Tiles {
    pub(super) fn of(film: &Film) -> Self {
        let n_columns = film.width.div_ceil(TILE_SIDE);
        Self {
            n: n_columns * film.height.div_ceil(TILE_SIDE),
            n_columns,
            width: film.width,
            height: film.height,
        }
    }

    pub(super) fn tile(&self, number: u32) -> Tile {
        let span = |index: u32, end: u32| {
            let first = index * TILE_SIDE;
            [first, (first + TILE_SIDE).min(end)]
        };
        Tile {
            number,
            columns: span(number % self.n_columns, self.width),
            rows: span(number / self.n_columns, self.height),
        }
    }
}

/// A rectangle of pixels that one thread renders.
pub(super) struct Tile {
    pub(super) number: u32,
    /// First column and the one after the last.
    pub(super) columns: [u32; 2],
    /// First row and the one after the last.
    pub(super) rows: [u32; 2],
}

impl Tile {
    /// Its pixels (x, y), block by block: rays that follow each other are close
    /// together, which the ray kernel makes use of.
    pub(super) fn pixels(&self) -> impl Iterator<Item = (u32, u32)> {
        self.block_rows()
            .flat_map(|(y, columns)| columns.map(move |x| (x, y)))
    }

    /// Puts the tile's pixels, in the order of [`pixels`](Self::pixels), into
    /// their strip.
    pub(super) fn store(&self, mut pixels: &[Pixel], strip: &mut Strip) {
        let width = strip.object.len() / strip.n_rows as usize;
        for (y, columns) in self.block_rows() {
            let (row, rest) = pixels.split_at(columns.len());
            let first = (y - strip.first_row) as usize * width + columns.start as usize;
            strip.put(first, row);
            pixels = rest;
        }
    }

    /// The rows of its blocks: y, and a span of x.
    fn block_rows(&self) -> impl Iterator<Item = (u32, Range<u32>)> {
        let blocks = |[first, end]: [u32; 2]| {
            let starts = (first..end).step_by(BLOCK_SIDE as usize);
            starts.map(move |start| start..(start + BLOCK_SIDE).min(end))
        };
        let (rows, columns) = (self.rows, self.columns);
        blocks(rows).flat_map(move |rows| {
            blocks(columns).flat_map(move |columns| rows.clone().map(move |y| (y, columns.clone())))
        })
    }
}
