//! The order of rays in warps.

use super::launches::{LaneRay, PixelBlock};
use crate::schedule::{BLOCK_SIDE, TileGrid};
use scene::config::RayOrder;

/// Returns the rays of a launch, which are in the order of rows, in another order. Rays of one pixel
/// keep their order, and so do rays that are sorted by something and have the same.
pub(super) fn sorted(
    rays: &[LaneRay],
    order: RayOrder,
    grid: &TileGrid,
    block: &PixelBlock,
) -> Vec<LaneRay> {
    let mut sorted = rays.to_vec();
    sorted.sort_by_cached_key(|ray| {
        let (x, y) = block.place(ray.pixel);
        match order {
            RayOrder::Rows => [0, 0, 0, y, x],
            RayOrder::Tiles => in_tiles(0, x, y),
            RayOrder::Morton => [0, 0, 0, 0, spread(x) | (spread(y) << 1)],
            RayOrder::Waves => in_waves(grid, x, y),
            RayOrder::Octant => in_tiles(ray.octant.into(), x, y),
            RayOrder::Material => in_tiles(ray.material, x, y),
        }
    });
    sorted
}

/// What rays are sorted by, the most important first.
type Key = [u32; 5];

/// Columns and rows of a tile, the size of a warp of 32 lanes.
const TILE: [u32; 2] = [8, 4];

/// Returns the key of a pixel's rays in tiles that follow each other row by row, and so do their
/// pixels, if the rays are sorted by something else before.
fn in_tiles(before: u32, x: u32, y: u32) -> Key {
    let [columns, rows] = TILE;
    [before, y / rows, x / columns, y % rows, x % columns]
}

/// Returns the low eight bits of a number, each after a 0.
fn spread(n: u32) -> u32 {
    (0..8).fold(0, |bits, i| bits | (((n >> i) & 1) << (2 * i)))
}

/// Returns the key of a pixel's rays in the blocks of raycost's tiles.
fn in_waves(grid: &TileGrid, x: u32, y: u32) -> Key {
    let number = grid.number_at(x, y);
    let tile = grid.tile(number);
    let [x, y] = [x - tile.columns[0], y - tile.rows[0]];
    let side = BLOCK_SIDE;
    [number, y / side, x / side, y % side, x % side]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_hold_the_pixels_of_tiles_in_their_order() {
        for tile_size in [2, 5, 16, 256] {
            let grid = TileGrid::new(300, 270, tile_size);
            let tiles = (0..grid.n_tiles()).map(|number| grid.tile(number));
            let places = tiles.flat_map(|tile| tile.pixels());
            let keys: Vec<Key> = places.map(|(x, y)| in_waves(&grid, x, y)).collect();
            assert!(keys.is_sorted_by(|a, b| a < b), "{tile_size}");
        }
    }
}
