//! The tiles of a picture and the order in which they are rendered.

use super::{MAX_PIXELS, prepass};
use crate::accel::Accel;
use crate::config::{CostMode, Image, TileOrder, Tiling};
use crate::film::Film;
use crate::scene::Scene;
use crate::schedule::{Tile, TileGrid, hilbert_curve};

/// A picture divided into tiles, which can be rendered any number of times.
#[derive(Debug, Clone)]
pub struct TilePlan {
    /// The picture.
    pub image: Image,
    /// Its tiles.
    pub grid: TileGrid,
    /// The order in which threads take them.
    pub order: TileOrder,
    /// The tiles' numbers in that order.
    sequence: Vec<u32>,
}

impl TilePlan {
    /// Divides the picture into tiles and orders them. [`TileOrder::Cost`] traces
    /// a few rays through each tile on the current rayon pool.
    pub fn new(scene: &Scene, accel: &Accel, image: &Image, tiling: Tiling) -> Self {
        let grid = TileGrid::new(image.width, image.height, tiling.size);
        let sequence = match tiling.order {
            TileOrder::Scanline => (0..grid.n_tiles()).collect(),
            TileOrder::Hilbert => grid.numbers(hilbert_curve(grid.n_columns, grid.n_rows)),
            TileOrder::Cost => most_work_first(&prepass::work(scene, accel, image, &grid)),
        };
        Self {
            image: *image,
            grid,
            order: tiling.order,
            sequence,
        }
    }

    /// Creates an empty film of the picture.
    pub(super) fn film(&self, scene: &Scene, cost: CostMode) -> Film {
        Film {
            development: scene.development,
            ..Film::with_extra(
                scene.extra_arrays,
                self.grid,
                self.image.uniform_samples(),
                cost,
            )
        }
    }

    /// Most pixels rendered at a time.
    pub(super) fn max_pixels(&self) -> usize {
        MAX_PIXELS.min(self.grid.tile_size.pow(2) as usize)
    }

    /// Returns the tile at a position of the order; `None` after the last.
    pub fn tile(&self, position: u32) -> Option<Tile> {
        let number = self.sequence.get(position as usize)?;
        Some(self.grid.tile(*number))
    }
}

/// Returns the tiles' numbers by decreasing work; ties keep their order.
fn most_work_first(work: &[u64]) -> Vec<u32> {
    let mut sequence: Vec<u32> = (0..work.len() as u32).collect();
    sequence.sort_by_key(|&number| std::cmp::Reverse(work[number as usize]));
    sequence
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_work_keeps_its_order() {
        assert_eq!(most_work_first(&[3, 9, 3, 0, 9]), [1, 4, 0, 2, 3]);
    }
}
