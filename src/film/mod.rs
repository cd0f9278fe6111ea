//! What was rendered, pixel by pixel.
//!
//! A [`Film`] is a stack of [`Strip`]s of a few rows each, and a strip is a
//! structure of arrays. Strips let threads write side by side without a copy,
//! and writers walk them in order. What was counted stays tile by tile, packed
//! by the thread that counted it. [`columns`] lists the arrays that go into
//! files, in one place for all writers.

mod column;
mod packed;
mod rendered;
mod strip;
mod tile;

use glam::Vec3;

pub use column::{Column, columns};
pub use packed::PackedCounters;
pub use rendered::{Pixel, PixelTime, Rendered};
pub use strip::Strip;
pub(crate) use strip::to_rgb8;
pub use tile::RenderedTile;

use crate::config::CostMode;
use crate::cost::Cost;
use crate::schedule::TileGrid;

/// Rows in a strip but the last: fewer than a tile's, so that threads whose
/// tiles stand side by side do not wait for one another for long, and enough to
/// be written into a file at one go.
pub const STRIP_ROWS: u32 = 4;

/// A rendered picture: colours, geometry and cost of every pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    /// The tiles that it is rendered in, and how wide and high it is.
    pub grid: TileGrid,
    /// Samples of each pixel, each with a camera ray of its own.
    pub n_samples: u32,
    /// Which of the cost arrays are there.
    pub cost: CostMode,
    /// How often it was rendered.
    pub n_repeats: u8,
    /// The counters of all pixels together; zero where nothing was counted.
    pub totals: Cost,
    /// The rows, top strip first.
    pub strips: Vec<Strip>,
    /// What is kept tile by tile, in the order of the grid.
    pub tiles: Vec<RenderedTile>,
}

/// Bytes of memory that a film takes for each pixel, at most.
pub fn bytes_per_pixel(cost: CostMode) -> usize {
    let kept = columns(cost, 1).filter(|column| column.is_kept);
    let rejected = if cost.has_time() { size_of::<u8>() } else { 0 };
    size_of::<Vec3>() + rejected + kept.map(Column::stride).sum::<usize>()
}

impl Film {
    /// An empty film of the grid's pixels.
    pub fn new(grid: TileGrid, n_samples: u32, cost: CostMode) -> Self {
        let TileGrid { width, height, .. } = grid;
        let strip = |first_row| {
            let n_rows = STRIP_ROWS.min(height - first_row);
            Strip::new(first_row, n_rows, width, cost)
        };
        Self {
            grid,
            n_samples,
            cost,
            n_repeats: 1,
            totals: Cost::default(),
            strips: (0..height)
                .step_by(STRIP_ROWS as usize)
                .map(strip)
                .collect(),
            tiles: vec![RenderedTile::default(); grid.n_tiles() as usize],
        }
    }

    /// How many pixels have a hit.
    pub fn n_hits(&self) -> usize {
        let hits = |strip: &Strip| strip.object.iter().filter(|&&object| object >= 0).count();
        self.strips.iter().map(hits).sum()
    }

    /// The sum of `time_ns` over all pixels; 0 where no time was measured.
    pub fn total_time_ns(&self) -> f64 {
        self.values(|strip| &strip.time_ns).map(f64::from).sum()
    }

    /// The sum of `time_mad_ns` over all pixels; 0 unless rendered more than
    /// once.
    pub fn total_time_mad_ns(&self) -> f64 {
        let deviations = self.strips.iter().flat_map(|strip| &strip.time_mad_ns);
        deviations.map(|&ns| f64::from(ns)).sum()
    }

    /// How many samples of all pixels were rejected: times during which the
    /// thread changed its CPU.
    pub fn n_rejected(&self) -> u64 {
        self.values(|strip| &strip.n_rejected).map(u64::from).sum()
    }

    /// One array's rows, the film's uppermost first, each a slice of its strip.
    pub fn rows<'a, T: 'a>(
        &'a self,
        array: fn(&Strip) -> &Vec<T>,
    ) -> impl DoubleEndedIterator<Item = &'a [T]> {
        let width = self.grid.width as usize;
        self.strips
            .iter()
            .flat_map(move |strip| array(strip).chunks_exact(width))
    }

    /// One array, row-major, `width * height`, row 0 on top.
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
