//! The tiles of a picture and the order in which they are rendered.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::sample_plan::with_samples_planned;
use super::{MAX_PIXELS, prepass};
use crate::checkpoint::PicturePart;
use crate::film::Film;
use crate::schedule::{Tile, TileGrid, hilbert_curve};
use scene::build::Sensor;
use scene::config::{CostMode, Image, TileOrder, Tiling};
use tracer::trace::Tracer;
use world::scene::Scene;

/// A picture divided into tiles, which can be rendered any number of times.
#[derive(Debug, Clone)]
pub struct TilePlan {
    /// The sensor of the picture.
    pub sensor: Sensor,
    /// The tiles of the picture.
    pub grid: TileGrid,
    /// The order in which threads take them.
    pub order: TileOrder,
    /// The tiles' numbers in that order.
    sequence: Vec<u32>,
    /// The first row in the picture of each row of tiles; `None` if the grid covers the whole
    /// picture.
    first_rows: Option<Vec<u32>>,
    /// The estimated work of each tile of the grid; `None` if unknown.
    work: Option<Vec<u64>>,
    /// The estimated time of each tile of the grid; `None` if unknown.
    times: Option<Vec<f64>>,
    pixels_per_ns: f64,
}

impl TilePlan {
    /// Divides the picture into tiles and orders them. [`TileOrder::Cost`] traces a few rays
    /// through each tile on the current rayon pool, and efficiency that decides about samples
    /// through some pixels.
    pub fn new(tracer: Tracer, sensor: &Sensor, tiling: Tiling) -> Self {
        let sensor = &with_samples_planned(tracer, sensor);
        let image = &sensor.image;
        let grid = TileGrid::new(image.width, image.height, tiling.size);
        let mut work = None;
        let sequence = match tiling.order {
            TileOrder::Scanline => (0..grid.n_tiles()).collect(),
            TileOrder::Hilbert => grid.numbers(hilbert_curve(grid.n_columns, grid.n_rows)),
            TileOrder::Cost => most_work_first(work.insert(prepass::work(tracer, sensor, &grid))),
        };
        let this = Self {
            work,
            times: None,
            pixels_per_ns: 1.0,
            sensor: *sensor,
            grid,
            order: tiling.order,
            sequence,
            first_rows: None,
        };
        this.scaled()
    }

    /// Plans about `n_rows` rows of a picture, evenly spread and in whole tiles, as a separate
    /// picture; the whole picture if it has no more.
    pub fn with_rows(sensor: &Sensor, tile_size: u32, n_rows: u32) -> Self {
        let image = &sensor.image;
        let [n_all, n_rows_of_tiles] = [image.height, n_rows].map(|n| n / tile_size);
        let n_rows_of_tiles = n_rows_of_tiles.max(1);
        let first_row = |i: u32| {
            let place = (f64::from(i) + 0.5) / f64::from(n_rows_of_tiles);
            (place * f64::from(n_all)) as u32 * tile_size
        };
        let first_rows: Option<Vec<u32>> =
            (n_rows_of_tiles < n_all).then(|| (0..n_rows_of_tiles).map(first_row).collect());
        let height = match first_rows {
            Some(_) => n_rows_of_tiles * tile_size,
            None => image.height,
        };
        let grid = TileGrid::new(image.width, height, tile_size);
        Self {
            sensor: *sensor,
            grid,
            order: TileOrder::Scanline,
            sequence: (0..grid.n_tiles()).collect(),
            first_rows,
            work: None,
            times: None,
            pixels_per_ns: 1.0,
        }
    }

    /// Returns the plan for a later rendering of the picture or the part, given its number from 0:
    /// with the grid of that rendering, and about the same order. A tile belongs to the part that
    /// has its first pixel in the first rendering.
    pub(super) fn for_rendering(&self, number: u8, cost: CostMode) -> Self {
        let grid = self.grid.for_rendering(number, cost);
        let tiles = (0..grid.n_tiles()).map(|number| grid.tile(number));
        let first_pixels = tiles.map(|tile| (tile.columns[0], tile.rows[0]));
        let here: Vec<usize> = first_pixels
            .map(|(x, y)| self.grid.number_at(x, y) as usize)
            .collect();
        let mut positions = vec![None; self.grid.n_tiles() as usize];
        for (position, &number) in self.sequence.iter().enumerate() {
            positions[number as usize] = Some(position);
        }
        let mut sequence: Vec<u32> = (0..grid.n_tiles()).collect();
        sequence.retain(|&number| positions[here[number as usize]].is_some());
        sequence.sort_by_key(|&number| positions[here[number as usize]]);
        let times = self.times.as_ref();
        let this = Self {
            grid,
            sequence,
            work: None,
            times: times.map(|times| here.iter().map(|&number| times[number]).collect()),
            ..self.clone()
        };
        this.scaled()
    }

    /// Returns the position of a tile of the grid, or of some of its rows, in the picture.
    pub(super) fn in_picture(&self, tile: &Tile) -> Tile {
        let Some(first_rows) = &self.first_rows else {
            return *tile;
        };
        let size = self.grid.tile_size;
        let first_row = first_rows[(tile.rows[0] / size) as usize];
        let begin = tile.rows[0] - tile.rows[0] % size;
        Tile {
            rows: tile.rows.map(|y| y - begin + first_row),
            ..*tile
        }
    }

    /// Keeps only the tiles of one part of the picture, in order. All parts together have each tile
    /// once, and about the same work, whatever the machine and the order. Traces a few rays through
    /// each tile on the current rayon pool.
    pub fn into_part(mut self, tracer: Tracer, part: PicturePart) -> Self {
        let parts = dealt(self.estimated(tracer), part.of);
        (self.sequence).retain(|&number| parts[number as usize] == part.number - 1);
        self.scaled()
    }

    /// Orders the tiles by their work, the most expensive first, as ranks take them. Traces a few
    /// rays through each tile on the current rayon pool.
    pub fn most_expensive_first(mut self, tracer: Tracer) -> Self {
        self.sequence = most_work_first(self.estimated(tracer));
        self.order = TileOrder::Cost;
        self.scaled()
    }

    /// Returns the plan with the estimated times of the grid's tiles.
    pub(super) fn with_times(mut self, times: Vec<f64>) -> Self {
        self.times = Some(times);
        self.scaled()
    }

    /// Returns the tiles' numbers in order.
    pub(super) fn sequence(&self) -> &[u32] {
        &self.sequence
    }

    /// Returns true if the work or the time of each tile is known.
    pub fn is_estimated(&self) -> bool {
        self.work.is_some() || self.times.is_some()
    }

    /// Measures time in pixels of average cost.
    fn scaled(mut self) -> Self {
        if let Some(times) = &self.times {
            let of_tiles = self.sequence.iter().map(|&number| times[number as usize]);
            self.pixels_per_ns = self.n_pixels() as f64 / of_tiles.sum::<f64>().max(1.0);
        }
        self
    }

    fn estimated(&mut self, tracer: Tracer) -> &[u64] {
        let Self {
            sensor, grid, work, ..
        } = self;
        work.get_or_insert_with(|| prepass::work(tracer, sensor, grid))
    }

    /// Returns the work of a tile in pixels of average cost; over all tiles of the plan, it adds up
    /// to the number of their pixels.
    pub(super) fn work(&self, tile: &Tile) -> f64 {
        match &self.times {
            Some(times) => times[tile.number as usize] * self.pixels_per_ns,
            None => tile.n_pixels() as f64,
        }
    }

    /// Returns the number of tiles.
    pub fn n_tiles(&self) -> u32 {
        self.sequence.len() as u32
    }

    /// Returns the number of pixels of all tiles.
    pub fn n_pixels(&self) -> u64 {
        let tiles = self.sequence.iter().map(|&number| self.grid.tile(number));
        tiles.map(|tile| tile.n_pixels() as u64).sum()
    }

    /// Creates an empty film of the picture.
    pub(super) fn film(&self, scene: &Scene, cost: CostMode) -> Film {
        self.film_without_rows(scene, cost)
            .with_rows(0..self.grid.height)
    }

    /// Creates a film of the picture that has none of its pixels.
    pub(super) fn film_without_rows(&self, scene: &Scene, cost: CostMode) -> Film {
        Film {
            space: scene.space,
            development: self.sensor.development,
            most_samples: self.sensor.image.samples_per_pixel,
            ..Film::without_rows(
                self.sensor.extra_arrays,
                self.grid,
                self.sensor.image.uniform_samples(),
                cost,
            )
        }
    }

    /// Returns the greatest number of pixels rendered at a time, and their image.
    pub(super) fn room(&self) -> (usize, &Image) {
        let most = MAX_PIXELS.min(self.grid.tile_size.pow(2) as usize);
        (most, &self.sensor.image)
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
    sequence.sort_by_key(|&number| Reverse(work[number as usize]));
    sequence
}

/// Deals tiles to `n` parts, from 0: each tile, by decreasing work, to the part with the least work
/// so far, and among equal ones to the part with the fewest tiles.
///
/// Graham, "Bounds on Multiprocessing Timing Anomalies", SIAM J. Appl. Math. 17, 1969: the longest
/// part has at most 4/3 of the work of the shortest one possible.
fn dealt(work: &[u64], n: u32) -> Vec<u32> {
    let mut parts: BinaryHeap<_> = (0..n).map(|part| Reverse((0, 0, part))).collect();
    let mut part_of = vec![0; work.len()];
    for number in most_work_first(work) {
        if let Some(mut least) = parts.peek_mut() {
            let Reverse((sum, n_tiles, part)) = &mut *least;
            part_of[number as usize] = *part;
            (*sum, *n_tiles) = (*sum + work[number as usize], *n_tiles + 1);
        }
    }
    part_of
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_differ_by_no_more_than_one_tile() {
        let work: Vec<u64> = (0..997).map(|i| i * 7919 % 1009 / 3).collect();
        for n in [1, 2, 3, 16, 996, 2000] {
            let parts = dealt(&work, n);
            let mut sums = vec![0; n as usize];
            for (&part, work) in parts.iter().zip(&work) {
                sums[part as usize] += work;
            }
            let [least, most] = [sums.iter().min(), sums.iter().max()].map(Option::unwrap);
            assert!(most - least <= 1008 / 3, "{n} parts: {least} to {most}");
        }
        // Tiles without work are spread, too.
        let mut parts = dealt(&[0; 6], 3);
        parts.sort_unstable();
        assert_eq!(parts, [0, 0, 1, 1, 2, 2]);
    }

    #[test]
    fn equal_work_keeps_its_order() {
        assert_eq!(most_work_first(&[3, 9, 3, 0, 9]), [1, 4, 0, 2, 3]);
    }
}
