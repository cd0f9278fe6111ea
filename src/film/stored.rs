//! The pixels of a tile as bytes, bit for bit.

use super::Strip;
use crate::schedule::Tile;

/// Number of arrays that a rendering writes.
const N_ARRAYS: usize = 13;

/// The arrays of a strip that a rendering writes, as bytes, shared or for writing. The
/// spread of repeated times is none of them: it is computed after all renderings.
macro_rules! arrays {
    ($cast:ident, $strip:ident, $($reference:tt)+) => {
        [
            bytemuck::$cast($($reference)+ $strip.rgb[..]),
            bytemuck::$cast($($reference)+ $strip.radiance[..]),
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
            bytemuck::$cast($($reference)+ $strip.n_rejected[..]),
        ]
    };
}

impl Strip {
    /// Bytes of a pixel in all arrays that a rendering writes.
    pub(crate) fn stored_bytes_per_pixel(&self) -> usize {
        let n_pixels = self.rgb.len().max(1);
        let n_bytes = self.arrays().map(<[u8]>::len).iter().sum::<usize>();
        n_bytes / n_pixels
    }

    /// Appends the bytes of the strip's pixels in a tile, array by array and row by row,
    /// in native order.
    pub(crate) fn append_pixels(&self, tile: &Tile, bytes: &mut Vec<u8>) {
        let width = self.width();
        for array in self.arrays() {
            let stride = array.len() / self.rgb.len().max(1);
            for row in self.rows_of(tile) {
                let first = (row * width + tile.columns[0] as usize) * stride;
                bytes.extend_from_slice(&array[first..first + tile.width() * stride]);
            }
        }
    }

    /// Overwrites the strip's pixels in a tile with bytes of
    /// [`append_pixels`](Self::append_pixels), and returns those behind them; `None`
    /// if they are too few.
    pub(crate) fn restore_pixels<'b>(
        &mut self,
        tile: &Tile,
        mut bytes: &'b [u8],
    ) -> Option<&'b [u8]> {
        let (width, n_pixels) = (self.width(), self.rgb.len().max(1));
        let rows = self.rows_of(tile);
        for array in self.arrays_mut() {
            let stride = array.len() / n_pixels;
            for row in rows.clone() {
                let first = (row * width + tile.columns[0] as usize) * stride;
                let (stored, rest) = bytes.split_at_checked(tile.width() * stride)?;
                array[first..first + stored.len()].copy_from_slice(stored);
                bytes = rest;
            }
        }
        Some(bytes)
    }

    /// Whether all pixels of a tile show one of so many objects and materials, or none.
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

    /// The rows of the strip that a tile crosses, counted from the uppermost.
    fn rows_of(&self, tile: &Tile) -> std::ops::Range<usize> {
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
