//! Pixels → camera rays, and the colors of their paths → pixels, in lanes.

use std::ops::Range;

use super::view::View;
use crate::schedule::Tile;
use math::simd::{
    InstructionSet, Lanes, N_LANES, Real, SimdKernel, VectorColumn, grow, lanes, lanes_mut,
};
use tracer::shade::{PathWave, SampleIds};

/// The pixels that are rendered together, as a structure of arrays, in the order in which their
/// camera rays are traced.
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct Places {
    /// Number of pixels.
    n: usize,
    /// Columns and rows in the picture; after the last pixel, copies of it fill whole lanes.
    x: Vec<u32>,
    y: Vec<u32>,
    /// The index of each pixel among the pixels that are rendered together.
    pixels: Vec<u32>,
    /// The tile and the part of it whose pixels these are, if all belong to one tile.
    group: Option<[Tile; 2]>,
}

impl Places {
    /// Overwrites the pixels with the pixels of a part of a tile, by their indices in the tile.
    pub(super) fn fill_group(&mut self, tile: &Tile, group: &Tile) {
        match self.group {
            Some([tile_before, before])
                if before.has_size_of(group) && tile_before.width() == tile.width() =>
            {
                let first = tile_before.first_index(&before);
                self.shift(&before, group, [first, tile.first_index(group)]);
            }
            _ => self.fill((group.pixels()).map(|(x, y)| (tile.index(x, y), (x, y)))),
        }
        self.group = Some([*tile, *group]);
    }

    /// Moves the pixels of a group to another group of the same size, whose first pixel has another
    /// index.
    fn shift(&mut self, from: &Tile, to: &Tile, [from_index, to_index]: [u32; 2]) {
        let moves = [
            (&mut self.x, from.columns[0], to.columns[0]),
            (&mut self.y, from.rows[0], to.rows[0]),
            (&mut self.pixels, from_index, to_index),
        ];
        for (values, from, to) in moves {
            let by = to.wrapping_sub(from);
            for value in values {
                *value = value.wrapping_add(by);
            }
        }
    }

    /// Overwrites the pixels: index, column and row of each.
    pub(super) fn fill(&mut self, places: impl Iterator<Item = (u32, (u32, u32))>) {
        self.group = None;
        self.x.clear();
        self.y.clear();
        self.pixels.clear();
        // Not `for`: nested iterators are faster from inside.
        places.for_each(|(pixel, (x, y))| {
            self.x.push(x);
            self.y.push(y);
            self.pixels.push(pixel);
        });
        self.n = self.pixels.len();
        let last = self.n.saturating_sub(1);
        for values in [&mut self.x, &mut self.y, &mut self.pixels] {
            let repeated = values.get(last).copied().unwrap_or(0);
            values.resize(self.n.next_multiple_of(N_LANES), repeated);
        }
    }

    /// Returns the number of pixels.
    pub(super) fn len(&self) -> usize {
        self.n
    }

    /// Returns the number of blocks of eight pixels; the last one may have fewer.
    pub(super) fn n_blocks(&self) -> usize {
        self.n.div_ceil(N_LANES)
    }

    /// Returns the number of pixels in a block.
    #[inline(always)]
    pub(super) fn in_block(&self, block: usize) -> usize {
        N_LANES.min(self.n - N_LANES * block)
    }

    /// Returns the index of a pixel, and its column and row.
    #[inline(always)]
    pub(super) fn get(&self, i: usize) -> (usize, (u32, u32)) {
        (self.pixels[i] as usize, (self.x[i], self.y[i]))
    }

    /// Returns the column and row of each pixel of a block.
    #[inline(always)]
    fn coordinates<I: InstructionSet>(&self, set: I, block: usize) -> [I::Lanes; 2] {
        let [x, y] = [&self.x, &self.y].map(|values| lanes(values, N_LANES * block));
        // Below 2^31: as exact as the conversion of each.
        [
            I::Lanes::from_integer(set.load_integers(x)),
            I::Lanes::from_integer(set.load_integers(y)),
        ]
    }
}

/// Starts a path for each of these samples of all pixels: for each block of eight pixels its first
/// samples, then its second ones and so on, so that consecutive rays are coherent. The slot of
/// sample `s` in lane `l` of block `b` is `8 * (b * n_samples + s) + l`.
pub(super) struct StartPaths<'a> {
    pub(super) view: &'a View<'a>,
    pub(super) places: &'a Places,
    pub(super) samples: Range<u32>,
    pub(super) wave: &'a mut PathWave,
    /// The samples by slot, in a scene that needs random numbers.
    pub(super) ids: Option<&'a mut SampleIds>,
}

impl SimdKernel for StartPaths<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(mut self, set: I) {
        let mut slot = 0;
        for block in 0..self.places.n_blocks() {
            let n = self.places.in_block(block);
            let [x, y] = self.places.coordinates(set, block);
            let numbers = self.numbers(block);
            let pixels = lanes(&self.places.pixels, N_LANES * block);
            for sample in self.samples.clone() {
                if let Some(ids) = &mut self.ids {
                    ids.set(slot as usize, &numbers, sample);
                }
                let numbers = set.load_integers(&numbers);
                let rays = self.view.camera_rays([x, y], numbers, sample);
                self.wave.start(set, rays, pixels, slot, n);
                slot += N_LANES as u32;
            }
        }
    }
}

impl StartPaths<'_> {
    /// Returns the numbers of a block's pixels in the picture.
    #[inline(always)]
    fn numbers(&self, block: usize) -> [u32; N_LANES] {
        std::array::from_fn(|lane| {
            let (_, (x, y)) = self.places.get(N_LANES * block + lane);
            self.view.pixel_number(x, y)
        })
    }
}

/// Adds the colors of the paths that [`StartPaths`] started to the colors of their pixels.
pub(super) struct AddSamples<'a> {
    pub(super) view: &'a View<'a>,
    pub(super) places: &'a Places,
    pub(super) n_samples: usize,
    /// The color of each path, by slot.
    pub(super) colors: &'a VectorColumn,
    /// The sum of each pixel's samples.
    pub(super) sums: &'a mut VectorColumn,
}

impl SimdKernel for AddSamples<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) {
        for block in 0..self.places.n_blocks() {
            let mut sum = self.sums.load(set, N_LANES * block);
            for sample in 0..self.n_samples {
                let slot = N_LANES * (block * self.n_samples + sample);
                sum = sum + self.view.limited(self.colors.load(set, slot));
            }
            self.sums.store(N_LANES * block, sum);
        }
    }
}

/// Divides sums of colors by the number of samples, and computes the footprints of pixels at their
/// distances; NaN without a hit.
pub(super) struct FinishPixels<'a> {
    pub(super) view: &'a View<'a>,
    pub(super) places: &'a Places,
    /// Number of samples of each pixel, padded to whole lanes; `None` if all have the same.
    pub(super) n_samples: Option<&'a [f32]>,
    /// Sums of colors, replaced by their means.
    pub(super) colors: &'a mut VectorColumn,
    pub(super) distances: &'a [f32],
    pub(super) footprints: &'a mut Vec<f32>,
}

impl SimdKernel for FinishPixels<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) {
        grow(self.footprints, self.places.len());
        let n_uniform = set.splat(self.view.rounds.n_most() as f32);
        for block in 0..self.places.n_blocks() {
            let first = N_LANES * block;
            let n_samples = match self.n_samples {
                None => n_uniform,
                Some(n_samples) => set.load(lanes(n_samples, first)),
            };
            let mean = self.colors.load(set, first) / n_samples;
            self.colors.store(first, mean);
            let at = self.places.coordinates(set, block);
            let distance = set.load(lanes(self.distances, first));
            let footprint = self.view.footprints(at, distance);
            *lanes_mut(self.footprints, first) = footprint.to_array();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::TileGrid;

    #[test]
    fn places_of_a_tile_do_not_depend_on_those_before() {
        let grid = TileGrid::new(50, 39, 16);
        let mut reused = Places::default();
        // There and back again: tiles at the edges are smaller.
        let numbers = 0..grid.n_tiles();
        for number in numbers.clone().chain(numbers.rev()) {
            for part in grid.tile(number).parts(100) {
                for group in [part].into_iter().chain(part.groups(32)) {
                    let mut new = Places::default();
                    new.fill_group(&part, &group);
                    reused.fill_group(&part, &group);
                    assert_eq!(reused, new);
                }
            }
        }
    }
}
