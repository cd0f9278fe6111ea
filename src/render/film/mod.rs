//! The film: the rendered image and the cost of each pixel.
//!
//! A [`Film`] is a stack of [`Strip`]s of a few rows each, and a strip is a structure of arrays. A
//! film may have only some rows of its picture, or none, if it does not fit into memory. A thread
//! renders a tile into separate buffers, then copies them to the strips that the tile crosses, with
//! one strip locked at a time. File writers read the strips in order. Counters stay with their tile
//! ([`RenderedTile`]), packed by the thread that counted. [`columns`] lists the arrays of the
//! output files, for all writers.

mod column;
mod metrics;
mod hottest;
mod packed;
mod rendered;
mod strip;
mod stored;
mod tile;

use std::ops::Range;

use rayon::prelude::*;
use vtkio::model::ScalarType;

use column::kept_columns;
pub use column::{Column, columns, written_columns};
pub use hottest::{HotPixel, Times, highest_counts};
pub use packed::PackedCounters;
pub use rendered::{Pixel, PixelColumns, Rendered};
pub use strip::Strip;
pub use tile::RenderedTile;

use crate::schedule::TileGrid;
use host::grow_heap;
use math::statistics::sum;
use scene::config::{CostMode, ExtraArrays, Repeats};
use tracer::cost::Cost;
use world::color::Development;
use world::geometry::RenderSpace;

/// Rows of a strip, except for the last one: fewer than a tile has by default, so that threads with
/// tiles side by side wait for each other only briefly, and enough for a large write to a file.
pub const STRIP_ROWS: u32 = 4;

/// Strips that a thread fills at a time.
const STRIPS_PER_TASK: usize = 8;

/// A rendered image: the color, geometry and cost of every pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    /// The tiles, the width and the height.
    pub grid: TileGrid,
    /// Samples of every pixel, each with a camera ray; 0 if they are counted by pixel, as
    /// [`Counter::Samples`](tracer::cost::Counter::Samples).
    pub n_samples: u32,
    /// The greatest number of samples of a pixel.
    pub most_samples: u32,
    /// The space of the hit positions.
    pub space: RenderSpace,
    /// The conversion of radiance to the colors of the picture.
    pub development: Development,
    /// The optional arrays that this film keeps.
    pub extra: ExtraArrays,
    /// The cost arrays of the film.
    pub cost: CostMode,
    /// Number of renderings requested.
    pub repeats: Repeats,
    /// Number of renderings made.
    pub n_repeats: u8,
    /// Number of these with other edges of groups.
    pub n_grids: u8,
    /// The sum of the counters of all pixels; zero if nothing was counted.
    pub totals: Cost,
    /// The rows, from top to bottom: all rows of the grid, some of them, or none.
    pub strips: Vec<Strip>,
    /// Threads and counters by tile, in the order of the grid.
    pub tiles: Vec<RenderedTile>,
}

/// Upper bound of a film's bytes per tile besides its counters: a list with a capacity of at least
/// four, a lock, and the overhead of the allocator for both.
pub const BYTES_PER_TILE: usize = size_of::<RenderedTile>() + 4 * size_of::<PackedCounters>() + 64;

/// Returns the bytes of a pixel in all arrays that a rendering writes to a film.
pub fn stored_bytes_per_pixel(cost: CostMode, extra: ExtraArrays) -> usize {
    let mut strip = Strip::reserve([0, 1, 1], cost, extra);
    strip.fill(1);
    strip.stored_bytes_per_pixel()
}

impl Film {
    /// Creates a film for the pixels of the grid, not rendered yet. `n_samples` is the number of
    /// samples of every pixel; 0 if they will be counted.
    pub fn new(grid: TileGrid, n_samples: u32, cost: CostMode) -> Self {
        Self::with_extra(ExtraArrays::default(), grid, n_samples, cost)
    }

    /// Creates a film with extra arrays.
    pub fn with_extra(extra: ExtraArrays, grid: TileGrid, n_samples: u32, cost: CostMode) -> Self {
        Self::without_rows(extra, grid, n_samples, cost).with_rows(0..grid.height)
    }

    /// Creates a film without pixels, which keeps only totals of the whole picture.
    pub fn without_rows(
        extra: ExtraArrays,
        grid: TileGrid,
        n_samples: u32,
        cost: CostMode,
    ) -> Self {
        Self {
            grid,
            n_samples,
            most_samples: n_samples,
            space: RenderSpace::default(),
            development: Development::default(),
            extra,
            cost,
            repeats: Repeats::ONCE,
            n_repeats: 1,
            n_grids: 1,
            totals: Cost::default(),
            strips: Vec::new(),
            tiles: vec![RenderedTile::default(); grid.n_tiles() as usize],
        }
    }

    /// Returns the film with these rows of the grid, not rendered yet, instead of its rows.
    pub fn with_rows(self, rows: Range<u32>) -> Self {
        let n_pixels = rows.len() * self.grid.width as usize;
        grow_heap(n_pixels * stored_bytes_per_pixel(self.cost, self.extra));
        let strip = |first_row| {
            let n_rows = STRIP_ROWS.min(rows.end - first_row);
            Strip::reserve([first_row, n_rows, self.grid.width], self.cost, self.extra)
        };
        let first_rows = rows.clone().step_by(STRIP_ROWS as usize);
        let mut strips: Vec<Strip> = first_rows.map(strip).collect();
        let tasks = strips.par_iter_mut().with_min_len(STRIPS_PER_TASK);
        tasks.for_each(|strip| strip.fill(self.grid.width));
        Self { strips, ..self }
    }

    /// Creates an empty film of one tile of the grid, at its top left.
    pub(crate) fn empty_tile(&self) -> Self {
        let side = self.grid.tile_size;
        let grid = TileGrid::new(side, side, side);
        Self {
            development: self.development,
            ..Self::with_extra(self.extra, grid, self.n_samples, self.cost)
        }
    }

    /// Returns the first row, and the row after the last.
    pub fn row_range(&self) -> Range<u32> {
        let first = self.strips.first().map_or(0, |strip| strip.first_row);
        let end = |strip: &Strip| strip.first_row + strip.n_rows;
        first..self.strips.last().map_or(first, end)
    }

    /// Returns true if there are any pixels.
    pub fn has_rows(&self) -> bool {
        !self.strips.is_empty()
    }

    /// Returns true if the samples of the pixels were counted.
    pub fn counts_samples(&self) -> bool {
        self.n_samples == 0
    }

    /// Returns the arrays of the film's VTK files, in their order.
    pub fn columns(&self) -> impl Iterator<Item = Column> + use<> {
        let written = self.extra.written;
        self.kept_columns()
            .filter(move |column| written.has(column.name))
    }

    /// Returns the same arrays, and the arrays that VTK files leave out.
    pub fn kept_columns(&self) -> impl Iterator<Item = Column> + use<> {
        kept_columns(self.cost, self.repeats, self.counts_samples(), self.extra)
    }

    /// Overwrites `words` with the columns or the rows (`axis` 1) of a strip's pixels, as numbers of
    /// 16 bits.
    fn pixel_coordinates(&self, strip: &Strip, axis: usize, words: &mut Vec<u32>) {
        let (n_rows, width) = (strip.n_rows as usize, self.grid.width as usize);
        words.clear();
        words.resize((n_rows * width).div_ceil(2), 0);
        let numbers: &mut [u16] = bytemuck::cast_slice_mut(words);
        for (y, row) in (strip.first_row..)
            .zip(numbers.chunks_exact_mut(width))
            .take(n_rows)
        {
            match axis {
                0 => (0_u32..)
                    .zip(row)
                    .for_each(|(x, number)| *number = x as u16),
                _ => row.fill(y as u16),
            }
        }
    }

    /// Overwrites `words` with the positions of a strip's hits in world space, as numbers of 64
    /// bits or of 32.
    fn world_positions(&self, strip: &Strip, scalar: ScalarType, words: &mut Vec<u32>) {
        words.clear();
        for position in &strip.position {
            let in_world = self.space.world_point(*position);
            match scalar {
                ScalarType::F64 => {
                    words.extend_from_slice(bytemuck::cast_slice(&in_world.to_array()))
                }
                _ => words.extend_from_slice(bytemuck::cast_slice(&in_world.as_vec3().to_array())),
            }
        }
    }

    /// Returns the number of pixels with a hit.
    pub fn n_hits(&self) -> usize {
        let hits = |strip: &Strip| strip.object.iter().filter(|&&object| object >= 0).count();
        self.strips.iter().map(hits).sum()
    }

    /// Returns the sum of `time_ns` over all pixels; 0 if no time was measured.
    pub fn total_time_ns(&self) -> f64 {
        self.strips.iter().map(|strip| sum(&strip.time_ns)).sum()
    }

    /// Returns the sum of `time_mad_ns` over all pixels; 0 if not measured.
    pub fn total_time_mad_ns(&self) -> f64 {
        self.strips
            .iter()
            .map(|strip| sum(&strip.time_mad_ns))
            .sum()
    }

    /// Returns the rows of an array, from top to bottom, each as a slice of its strip.
    pub fn rows<'a, T: 'a>(
        &'a self,
        array: fn(&Strip) -> &Vec<T>,
    ) -> impl DoubleEndedIterator<Item = &'a [T]> {
        let width = self.grid.width as usize;
        self.strips
            .iter()
            .flat_map(move |strip| array(strip).chunks_exact(width))
    }

    /// Returns an array, row-major, `width * height`; row 0 is on top.
    pub fn values<'a, T: Copy + 'a>(
        &'a self,
        array: fn(&Strip) -> &Vec<T>,
    ) -> impl DoubleEndedIterator<Item = T> + 'a {
        self.rows(array).flatten().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_cover_every_row_once() {
        for height in [1, 15, 16, 17, 40] {
            let film = Film::new(TileGrid::new(3, height, 2), 1, CostMode::Time);
            let rows: Vec<u32> = film
                .strips
                .iter()
                .flat_map(|strip| strip.first_row..strip.first_row + strip.n_rows)
                .collect();
            assert_eq!(rows, (0..height).collect::<Vec<_>>());
            let numbers = |strip| {
                let mut numbers = Vec::new();
                film.tile_numbers(strip, &mut numbers);
                numbers
            };
            let tiles = film.strips.iter().flat_map(numbers);
            let expected = (0..height).flat_map(|y| [0, 0, 1].map(|tile| y / 2 * 2 + tile));
            assert!(tiles.eq(expected));
        }
    }
}
