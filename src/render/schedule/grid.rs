//! The tiles of an image.

use std::ops::Range;

use scene::config::CostMode;

/// Pixels along the side of a block within a tile: a block has 16 pixels, one for each ray of a
/// packet.
pub const BLOCK_SIDE: u32 = 4;

/// Greatest number of pixels rendered at a time: a larger tile is rendered in groups of rows, whose
/// pixels stay in the cache until they are written to the film.
pub const MAX_PIXELS: usize = 2048;

/// Paths of a group of pixels that are traced and timed together: enough to keep the kernel busy.
pub const GROUP_PATHS: u32 = 1024;

/// Greatest number of pixels of a group, and the side of a square with that number.
const GROUP_PIXELS: u32 = 256;
const GROUP_SIDE: u32 = 16;

/// Number of different grids of an image's renderings.
pub const N_GRIDS: u32 = 5;

/// An image divided into square tiles, numbered along rows from the top left. The tiles at the
/// edges may be smaller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TileGrid {
    /// Pixels along a tile's side.
    pub tile_size: u32,
    /// Number of tiles per row.
    pub n_columns: u32,
    /// Number of rows of tiles.
    pub n_rows: u32,
    /// Width of the image in pixels.
    pub width: u32,
    /// Height of the image in pixels.
    pub height: u32,
    /// Columns and rows of pixels that the first tile lacks.
    shift: [u32; 2],
}

/// A rectangle of pixels that one thread renders.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tile {
    /// Number of the tile in the grid.
    pub number: u32,
    /// The first column of pixels, and the one after the last.
    pub columns: [u32; 2],
    /// The first row of pixels, and the one after the last; row 0 is on top.
    pub rows: [u32; 2],
}

impl TileGrid {
    /// Divides an image of `width * height` pixels into tiles with sides of `tile_size` pixels;
    /// none of the three is 0.
    pub fn new(width: u32, height: u32, tile_size: u32) -> Self {
        Self {
            tile_size,
            n_columns: width.div_ceil(tile_size),
            n_rows: height.div_ceil(tile_size),
            width,
            height,
            shift: [0; 2],
        }
    }

    /// Returns the grid for a later rendering of the image, given its number from 0. If groups of
    /// pixels are timed, its tiles, and the groups in them, have other edges: five grids are moved
    /// by a lattice in which no two share a column or a row.
    pub fn for_rendering(self, number: u8, cost: CostMode) -> Self {
        if cost != CostMode::Time {
            return self;
        }
        let side = GROUP_SIDE.min(self.tile_size);
        let n = u32::from(number) % N_GRIDS;
        let shift = [n, 2 * n % N_GRIDS].map(|n| n * side / N_GRIDS);
        Self {
            n_columns: (self.width + shift[0]).div_ceil(self.tile_size),
            n_rows: (self.height + shift[1]).div_ceil(self.tile_size),
            shift,
            ..self
        }
    }

    /// Returns the number of tiles.
    pub fn n_tiles(&self) -> u32 {
        self.n_columns * self.n_rows
    }

    /// Returns the numbers of the tiles at these columns and rows of the grid.
    pub fn numbers(&self, cells: Vec<(u32, u32)>) -> Vec<u32> {
        let number = |(column, row)| row * self.n_columns + column;
        cells.into_iter().map(number).collect()
    }

    /// Returns the tiles that contain a row of pixels, from left to right.
    pub fn tiles_of_row(&self, y: u32) -> impl Iterator<Item = Tile> {
        let first = (y + self.shift[1]) / self.tile_size * self.n_columns;
        (first..first + self.n_columns).map(|number| self.tile(number))
    }

    /// Returns the tile with this number, less than [`n_tiles`](Self::n_tiles).
    pub fn tile(&self, number: u32) -> Tile {
        let [dx, dy] = self.shift;
        let span = |index: u32, shift: u32, end: u32| {
            let next = (index + 1) * self.tile_size - shift;
            [next.saturating_sub(self.tile_size), next.min(end)]
        };
        Tile {
            number,
            columns: span(number % self.n_columns, dx, self.width),
            rows: span(number / self.n_columns, dy, self.height),
        }
    }

    /// Returns the number of the tile with the pixel in column `x` and row `y`.
    pub fn number_at(&self, x: u32, y: u32) -> u32 {
        let [dx, dy] = self.shift;
        (y + dy) / self.tile_size * self.n_columns + (x + dx) / self.tile_size
    }
}

impl Tile {
    /// Creates the tile of one pixel.
    pub fn one_pixel(x: u32, y: u32) -> Self {
        Self {
            number: 0,
            columns: [x, x + 1],
            rows: [y, y + 1],
        }
    }

    /// Returns the tile's pixels (x, y), block by block: consecutive rays are coherent, so the
    /// kernel can trace them as packets.
    pub fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let columns = self.columns;
        blocks(self.rows).flat_map(move |rows| {
            blocks(columns).flat_map(move |columns| {
                let pixels = move |y| columns.clone().map(move |x| (x, y));
                rows.clone().flat_map(pixels)
            })
        })
    }

    /// Returns the row-major index of a pixel in the tile, from 0 at the top left.
    pub fn index(&self, x: u32, y: u32) -> u32 {
        let [left, right] = self.columns;
        (y - self.rows[0]) * (right - left) + x - left
    }

    /// Returns the index in the tile of the first pixel of a part of it.
    pub fn first_index(&self, part: &Tile) -> u32 {
        self.index(part.columns[0], part.rows[0])
    }

    /// Returns the indices in the tile of each row of a part of it.
    pub fn rows_of(&self, part: &Tile) -> impl Iterator<Item = Range<usize>> + use<> {
        let [top, bottom] = part.rows;
        let (tile, left, width) = (*self, part.columns[0], part.width());
        (top..bottom).map(move |y| {
            let first = tile.index(left, y) as usize;
            first..first + width
        })
    }

    /// Divides the tile into parts of whole rows, with at most `n_pixels` pixels or one row each.
    /// If a part can consist of whole rows of blocks, it does.
    pub fn parts(&self, n_pixels: usize) -> impl Iterator<Item = Tile> + use<> {
        let tile = *self;
        let [top, bottom] = tile.rows;
        let width = tile.columns[1] - tile.columns[0];
        let n_rows = (n_pixels as u32 / width).max(1);
        let n_rows = if n_rows < BLOCK_SIDE {
            n_rows
        } else {
            n_rows - n_rows % BLOCK_SIDE
        };
        (top..bottom)
            .step_by(n_rows as usize)
            .map(move |first| Tile {
                rows: [first, (first + n_rows).min(bottom)],
                ..tile
            })
    }

    /// Divides a part of the tile into the groups of pixels whose paths are traced and timed
    /// together, if each pixel has `n_samples` samples (0 if that differs): groups of 256 pixels at
    /// one sample, of one pixel at 1024.
    pub fn groups(&self, n_samples: u32) -> impl Iterator<Item = Tile> + use<> {
        let part = *self;
        let cells = |[first, end]: [u32; 2], side: u32| {
            let starts = (first..end).step_by(side as usize);
            starts.map(move |start| [start, (start + side).min(end)])
        };
        let sides = group_sides(n_samples);
        cells(part.rows, sides[1]).flat_map(move |rows| {
            cells(part.columns, sides[0]).map(move |columns| Tile {
                columns,
                rows,
                ..part
            })
        })
    }

    /// Returns true if the tile has this pixel.
    pub fn has(&self, x: u32, y: u32) -> bool {
        let [left, right] = self.columns;
        let [top, bottom] = self.rows;
        (left..right).contains(&x) && (top..bottom).contains(&y)
    }

    /// Returns the number of pixels.
    pub fn n_pixels(&self) -> usize {
        let [top, bottom] = self.rows;
        self.width() * (bottom - top) as usize
    }

    /// Returns true if both have the same numbers of columns and rows.
    pub fn has_size_of(&self, other: &Tile) -> bool {
        self.width() == other.width() && self.n_pixels() == other.n_pixels()
    }

    /// Returns the number of columns of pixels.
    pub fn width(&self) -> usize {
        let [left, right] = self.columns;
        (right - left) as usize
    }
}

/// Returns the columns and the rows of a group of pixels with `n_samples` samples each (0 if that
/// differs).
pub fn group_sides(n_samples: u32) -> [u32; 2] {
    let n_pixels = (GROUP_PATHS / n_samples.max(1)).clamp(1, GROUP_PIXELS);
    let log = n_pixels.ilog2();
    [1 << log.div_ceil(2), 1 << (log / 2)]
}

/// Returns the rows (or columns) of each block between the first one and the end.
fn blocks([first, end]: [u32; 2]) -> impl Iterator<Item = Range<u32>> {
    let starts = (first..end).step_by(BLOCK_SIDE as usize);
    starts.map(move |start| start..(start + BLOCK_SIDE).min(end))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_every_pixel_once() {
        for (width, height) in [(1, 1), (16, 16), (17, 33), (50, 7)] {
            for tile_size in [2, 3, 16, 256] {
                for number in 0..6 {
                    let grid = TileGrid::new(width, height, tile_size);
                    check(grid.for_rendering(number, CostMode::Time));
                    assert_eq!(grid.for_rendering(number, CostMode::SingleRayTime), grid);
                }
            }
        }
    }

    fn check(grid: TileGrid) {
        let (width, height) = (grid.width, grid.height);
        let mut pixels = Vec::new();
        for number in 0..grid.n_tiles() {
            let tile = grid.tile(number);
            assert!(tile.pixels().all(|(x, y)| grid.number_at(x, y) == number));
            assert_eq!(tile.pixels().count(), tile.n_pixels());
            let mut along_rows: Vec<_> = tile.pixels().collect();
            along_rows.sort_by_key(|&(x, y)| (y, x));
            let indices = along_rows.iter().map(|&(x, y)| tile.index(x, y));
            assert!(indices.eq(0..tile.n_pixels() as u32));
            // Parts of whole blocks have the order of the tile.
            let parts = tile.parts(4 * 256).flat_map(|part| part.pixels());
            assert!(parts.eq(tile.pixels()));
            let parts = tile.parts(100).flat_map(|part| part.pixels());
            assert_eq!(parts.count(), tile.n_pixels());
            for n_samples in [0, 1, 4, 31, 600, 5000] {
                let groups = tile.groups(n_samples);
                let mut grouped: Vec<_> = groups.flat_map(|it| it.pixels()).collect();
                grouped.sort_by_key(|&(x, y)| (y, x));
                assert_eq!(grouped, along_rows);
            }
            pixels.extend(tile.pixels().map(|(x, y)| y * width + x));
        }
        pixels.sort_unstable();
        assert!(pixels.into_iter().eq(0..width * height));
    }

    #[test]
    fn renderings_have_different_edges_of_tiles_and_groups() {
        for (n_samples, n_edges) in [(1, 5), (16, 5), (64, 4)] {
            let grid = TileGrid::new(100, 100, 32);
            for side in [0, 1] {
                let edges = (0..5).map(|number| {
                    let tile = grid.for_rendering(number, CostMode::Time).tile(4 + 1);
                    let edge = [tile.columns, tile.rows][side][0];
                    edge % group_sides(n_samples)[side]
                });
                let edges: std::collections::BTreeSet<u32> = edges.collect();
                assert_eq!(edges.len(), n_edges, "{edges:?}");
            }
        }
        assert_eq!(
            TileGrid::new(9, 9, 4).for_rendering(5, CostMode::Time),
            TileGrid::new(9, 9, 4)
        );
    }
}
