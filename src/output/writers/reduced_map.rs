//! The cost map of a picture that does not fit into memory.

/// Maximum side of a map, in pixels.
const MAX_SIDE: u32 = 4096;

/// The map of a picture as means of square blocks of pixels.
#[derive(Debug, Clone)]
pub(super) struct ReducedMap {
    /// Pixels along the side of a block.
    pub(super) side: u32,
    /// Columns and rows.
    pub(super) size: [u32; 2],
    /// Columns of the picture.
    width: u32,
    pub(super) values: Vec<f32>,
}

impl ReducedMap {
    /// Creates the map of a picture of this size, with sums of zero.
    pub(super) fn new(picture: [u32; 2]) -> Self {
        Self::of_blocks(picture, Self::side(picture))
    }

    /// Returns the side in pixels of a block for a picture of this size.
    pub(super) fn side(picture: [u32; 2]) -> u32 {
        picture[0].max(picture[1]).div_ceil(MAX_SIDE)
    }

    /// Returns the map of a picture's values for blocks with this side.
    pub(super) fn of_pixels(picture: [u32; 2], side: u32, values: &[f32]) -> Self {
        let mut map = Self::of_blocks(picture, side);
        map.add(0, values);
        map.means()
    }

    fn of_blocks(picture: [u32; 2], side: u32) -> Self {
        let size = picture.map(|n| (n / side).max(1));
        Self {
            side,
            size,
            width: picture[0],
            values: vec![0.0; size[0] as usize * size[1] as usize],
        }
    }

    /// Adds rows of values, starting at this row of the picture. Rows and columns past the last
    /// whole block are left out.
    pub(super) fn add(&mut self, first_row: u32, values: &[f32]) {
        let [n_columns, n_rows] = self.size.map(|n| n as usize);
        let side = self.side as usize;
        for (row, y) in values.chunks_exact(self.width as usize).zip(first_row..) {
            let block_row = y as usize / side;
            if block_row >= n_rows {
                return;
            }
            let sums = &mut self.values[block_row * n_columns..][..n_columns];
            for (sum, block) in sums.iter_mut().zip(row.chunks_exact(side)) {
                *sum += block.iter().sum::<f32>();
            }
        }
    }

    /// Turns the sums into means.
    pub(super) fn means(mut self) -> Self {
        let n = (self.side * self.side) as f32;
        self.values.iter_mut().for_each(|value| *value /= n);
        self
    }
}
