//! The tiles of a film.

use crate::film::{Film, Pixel, STRIP_ROWS, Strip};

/// Pixels along a tile's side: small enough to share out evenly, large enough
/// that one tile's film is written at one go.
pub const TILE_SIDE: u32 = STRIP_ROWS;

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
    /// Its pixels (x, y), row by row.
    pub(super) fn pixels(&self) -> impl Iterator<Item = (u32, u32)> {
        let [[left, right], [top, bottom]] = [self.columns, self.rows];
        (top..bottom).flat_map(move |y| (left..right).map(move |x| (x, y)))
    }

    /// Puts the tile's pixels, in the order of [`pixels`](Self::pixels), into
    /// their strip.
    pub(super) fn store(&self, pixels: &[Pixel], strip: &mut Strip) {
        let width = strip.object.len() / strip.n_rows as usize;
        let [left, right] = self.columns.map(|column| column as usize);
        let first = (self.rows[0] - strip.first_row) as usize * width + left;
        for (row, pixels) in pixels.chunks_exact(right - left).enumerate() {
            strip.put(first + row * width, pixels);
        }
    }
}
