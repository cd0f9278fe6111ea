//! The memory of a picture that is written in bands of rows.

use super::preview::Preview;
use crate::writers;
use render::checkpoint;
use render::film::{self, RenderedTile};
use render::schedule::{self, TileGrid, TileRun};
use render::tiles::{StoredPicture, least_repeats};
use scene::config::{Config, CostMode, Image};

/// Bytes copied to survey and write a pixel of a band, with and without counters: measured.
const COPIED: u64 = 20;
const COPIED_WITHOUT_COSTS: u64 = 12;

/// Maximum memory that is free after rendering and never used again: glibc returns larger blocks to
/// the system.
const MOST_UNUSED: u64 = 1 << 25;

/// Returns the bytes of tiles, and of a band of this many rows with the rows above it that are read
/// again and the copies made to write them.
pub(super) fn of_bands(config: &Config, preview: &Preview, n_rows: u32) -> u64 {
    let Image { width, height, .. } = config.image;
    let grid = TileGrid::new(width, height, config.tiles.size);
    let n_tiles = u64::from(grid.n_tiles());
    let n_repeats = usize::from(least_repeats(config));
    let kept = n_repeats * checkpoint::MEMORY_PER_TILE;
    let lasting = size_of::<RenderedTile>() + size_of::<TileRun>() + kept;
    let of_rendering = n_tiles * schedule::BYTES_PER_TILE as u64;
    let n_rows = height.min(n_rows + StoredPicture::row_unit(&grid));
    let n_pixels = u64::from(width) * u64::from(n_rows);
    let stored = film::stored_bytes_per_pixel(config.cost, config.extra_arrays())
        + (n_repeats - 1) * size_of::<f32>();
    let (of_packed, copied) = match config.cost {
        CostMode::None => (0, COPIED_WITHOUT_COSTS),
        _ => (film::BYTES_PER_TILE as u64, COPIED),
    };
    let of_band = (n_pixels as f64 * (stored as f64 + preview.counter_bytes)) as u64
        + n_pixels / u64::from(grid.tile_size).pow(2) * of_packed
        + n_tiles * size_of::<RenderedTile>() as u64;
    let of_writing = writers::expected_band_bytes(config, n_pixels) + n_pixels * copied;
    let later = of_rendering.min(MOST_UNUSED) + of_band + of_writing;
    n_tiles * lasting as u64 + of_rendering.max(later)
}
