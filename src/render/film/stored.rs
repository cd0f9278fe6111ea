//! The pixels of a tile as bytes, bit for bit.

use std::ops::Range;

use super::Strip;
use crate::schedule::Tile;

/// Number of arrays that a rendering writes.
const N_ARRAYS: usize = 13;

/// The arrays of a strip that a rendering writes, as bytes, shared or for writing. The spread of
/// repeated times is not among them: it is computed after all renderings.
macro_rules! arrays {
    ($cast:ident, $strip:ident, $($reference:tt)+) => {
        [
            bytemuck::$cast($($reference)+ $strip.rgb[..]),
            bytemuck::$cast($($reference)+ $strip.radiance[..]),
            bytemuck::$cast($($reference)+ $strip.noise[..]),
            bytemuck::$cast($($reference)+ $strip.albedo[..]),
            bytemuck::$cast($($reference)+ $strip.bounces[..]),
            bytemuck::$cast($($reference)+ $strip.instance[..]),
            bytemuck::$cast($($reference)+ $strip.position[..]),
            bytemuck::$cast($($reference)+ $strip.normal[..]),
            bytemuck::$cast($($reference)+ $strip.distance[..]),
            bytemuck::$cast($($reference)+ $strip.footprint[..]),
            bytemuck::$cast($($reference)+ $strip.object[..]),
            bytemuck::$cast($($reference)+ $strip.material[..]),
            bytemuck::$cast($($reference)+ $strip.time_ns[..]),
        ]
    };
}

/// The rows that a strip shares with a tile.
#[derive(Clone, Copy)]
struct TileRows {
    /// The first row and the one after the last, counted from the strip's uppermost.
    rows: [usize; 2],
    /// The first row, counted from the tile's uppermost.
    first_in_tile: usize,
    /// The tile's first column.
    left: usize,
    /// Pixels in a row of the strip, and of the tile.
    widths: [usize; 2],
}

impl Strip {
    /// Returns the bytes of a pixel in all arrays that a rendering writes.
    pub fn stored_bytes_per_pixel(&self) -> usize {
        self.arrays().map(|array| self.stride(array)).iter().sum()
    }

    /// Writes the strip's pixels in a tile to the bytes of the tile, which are in native order: all
    /// pixels of one array after the other, row by row.
    pub(crate) fn store_pixels(&self, tile: &Tile, bytes: &mut [u8]) {
        let mut rest = bytes;
        for array in self.arrays() {
            let stride = self.stride(array);
            let (of_array, others) = rest.split_at_mut(tile.n_pixels() * stride);
            for (place, row) in self.rows_in(tile).bytes(stride) {
                of_array[row].copy_from_slice(&array[place]);
            }
            rest = others;
        }
    }

    /// Overwrites the strip's pixels in a tile with the bytes from
    /// [`store_pixels`](Self::store_pixels).
    pub(crate) fn restore_pixels(&mut self, tile: &Tile, bytes: &[u8]) {
        let strides = self.arrays().map(|array| self.stride(array));
        let rows = self.rows_in(tile);
        let mut rest = bytes;
        for (array, stride) in self.arrays_mut().into_iter().zip(strides) {
            let (of_array, others) = rest.split_at(tile.n_pixels() * stride);
            for (place, row) in rows.bytes(stride) {
                array[place].copy_from_slice(&of_array[row]);
            }
            rest = others;
        }
    }

    /// Returns the bytes of a pixel in an array of the strip.
    fn stride(&self, array: &[u8]) -> usize {
        array.len() / self.rgb.len().max(1)
    }

    fn rows_in(&self, tile: &Tile) -> TileRows {
        let rows = self.rows_of(tile);
        TileRows {
            first_in_tile: (rows.start + self.first_row as usize)
                .saturating_sub(tile.rows[0] as usize),
            rows: [rows.start, rows.end],
            left: tile.columns[0] as usize,
            widths: [self.width(), tile.width()],
        }
    }

    /// Returns true if all pixels of a tile show one of these numbers of objects and materials, or
    /// none.
    pub(crate) fn has_only(&self, tile: &Tile, [n_objects, n_materials]: [usize; 2]) -> bool {
        let width = self.width();
        let in_range = |ids: &[i32], n: usize| ids.iter().all(|&id| id >= -1 && id < n as i32);
        self.rows_of(tile).all(|row| {
            let first = row * width + tile.columns[0] as usize;
            let row = first..first + tile.width();
            in_range(&self.object[row.clone()], n_objects)
                && in_range(&self.material[row], n_materials)
        })
    }

    /// Returns the rows of the strip that a tile crosses, counted from the uppermost.
    fn rows_of(&self, tile: &Tile) -> Range<usize> {
        let end = self.first_row + self.n_rows;
        let [top, bottom] = tile
            .rows
            .map(|y| y.clamp(self.first_row, end) - self.first_row);
        top as usize..bottom as usize
    }

    fn width(&self) -> usize {
        self.rgb.len() / self.n_rows.max(1) as usize
    }

    fn arrays(&self) -> [&[u8]; N_ARRAYS] {
        arrays!(cast_slice, self, &)
    }

    fn arrays_mut(&mut self) -> [&mut [u8]; N_ARRAYS] {
        arrays!(cast_slice_mut, self, &mut)
    }
}

impl TileRows {
    /// Returns the bytes of each row in an array of the strip and in an array of the tile, with
    /// `stride` bytes per pixel.
    fn bytes(self, stride: usize) -> impl Iterator<Item = (Range<usize>, Range<usize>)> {
        let ([first, end], [width, in_tile]) = (self.rows, self.widths);
        let n_bytes = in_tile * stride;
        (first..end).map(move |row| {
            let place = (row * width + self.left) * stride;
            let of_tile = (self.first_in_tile + row - first) * n_bytes;
            (place..place + n_bytes, of_tile..of_tile + n_bytes)
        })
    }
}
