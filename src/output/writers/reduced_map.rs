//! The cost map of a picture that does not fit into memory.

/// Maximum side of a map, in pixels.
const MAX_SIDE: u32 = 4096;

/// The map of a picture as means of blocks of pixels: of squares, unless the picture is narrower.
#[derive(Debug, Clone)]
pub(super) struct ReducedMap {
    /// Columns and rows of a block.
    pub(super) block: [u32; 2],
    /// Columns and rows.
    pub(super) size: [u32; 2],
    /// Columns of the picture.
    width: u32,
    pub(super) values: Vec<f32>,
}

/// Returns the side in pixels of a block for a picture of this size.
pub(crate) fn side(picture: [u32; 2]) -> u32 {
    picture[0].max(picture[1]).div_ceil(MAX_SIDE)
}

impl ReducedMap {
    /// Creates the map of a picture of this size, with sums of zero.
    pub(super) fn new(picture: [u32; 2]) -> Self {
        Self::with_side(picture, side(picture))
    }

    /// Returns the map of a picture's values for blocks with this side.
    pub(super) fn reduce(picture: [u32; 2], side: u32, values: &[f32]) -> Self {
        let mut map = Self::with_side(picture, side);
        map.add(0, values);
        map.means()
    }

    fn with_side(picture: [u32; 2], side: u32) -> Self {
        let block = picture.map(|n| side.min(n));
        let size = [0, 1].map(|axis| picture[axis] / block[axis]);
        Self {
            block,
            size,
            width: picture[0],
            values: vec![0.0; size[0] as usize * size[1] as usize],
        }
    }

    /// Adds rows of values, starting at this row of the picture. Rows and columns past the last
    /// whole block are left out.
    pub(super) fn add(&mut self, first_row: u32, values: &[f32]) {
        let [n_columns, n_rows] = self.size.map(|n| n as usize);
        let [width, height] = self.block.map(|n| n as usize);
        for (row, y) in values.chunks_exact(self.width as usize).zip(first_row..) {
            let block_row = y as usize / height;
            if block_row >= n_rows {
                return;
            }
            let sums = &mut self.values[block_row * n_columns..][..n_columns];
            for (sum, block) in sums.iter_mut().zip(row.chunks_exact(width)) {
                *sum += block.iter().sum::<f32>();
            }
        }
    }

    /// Turns the sums into means.
    pub(super) fn means(mut self) -> Self {
        let n = (self.block[0] * self.block[1]) as f32;
        self.values.iter_mut().for_each(|value| *value /= n);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thin_pictures_have_the_means_of_thin_blocks() {
        let values: Vec<f32> = (0..12).map(|i| i as f32).collect();
        for picture in [[1, 12], [12, 1]] {
            let map = ReducedMap::reduce(picture, 4, &values);
            assert_eq!(map.size, picture.map(|n| n.div_ceil(4)));
            assert_eq!(map.values, [1.5, 5.5, 9.5]);
        }
    }
}
