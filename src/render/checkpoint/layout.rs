//! The sizes of records.

use serde::{Deserialize, Serialize};

use crate::schedule::TileGrid;
use scene::config::{MAX_SIDE, Tiling};

/// The quantities that determine the sizes of the records of a rendering.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecordLayout {
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
    pub height: u32,
    /// Pixels along a tile's side.
    pub tile_size: u32,
    /// Number of renderings of the picture.
    pub n_renderings: u8,
    /// Bytes of a pixel in all arrays of the film.
    pub bytes_per_pixel: u32,
}

/// Greatest number of bytes of a pixel in all arrays.
const MAX_BYTES_PER_PIXEL: u32 = 1 << 10;

impl RecordLayout {
    /// Returns true if a scene can have these sizes.
    pub fn is_possible(&self) -> bool {
        let sides = 1..=MAX_SIDE;
        sides.contains(&self.width)
            && sides.contains(&self.height)
            && (Tiling::MIN_SIZE..=Tiling::MAX_SIZE).contains(&self.tile_size)
            && self.n_renderings > 0
            && (1..=MAX_BYTES_PER_PIXEL).contains(&self.bytes_per_pixel)
    }

    /// Returns the tiles.
    pub fn grid(&self) -> TileGrid {
        TileGrid::new(self.width, self.height, self.tile_size)
    }
}
