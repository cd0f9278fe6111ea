//! The sizes of records.

use serde::{Deserialize, Serialize};

use crate::schedule::TileGrid;
use scene::config::{CostMode, MAX_SIDE, Tiling};

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
    /// The cost mode: if groups of pixels are timed, each rendering has another grid.
    pub cost: CostMode,
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

    /// Returns the tiles of a rendering, given its number from 0.
    pub fn grid(&self, rendering: u8) -> TileGrid {
        let grid = TileGrid::new(self.width, self.height, self.tile_size);
        grid.for_rendering(rendering, self.cost)
    }

    /// Returns the numbers of all tiles, each after the number of its rendering.
    pub fn tiles(&self) -> impl Iterator<Item = (u8, u32)> {
        let of_rendering = |rendering| {
            let numbers = 0..self.grid(rendering).n_tiles();
            numbers.map(move |number| (rendering, number))
        };
        (0..self.n_renderings).flat_map(of_rendering)
    }
}
