//! The pixels of a tile that adaptive sampling has not finished.

use std::ops::Range;

use super::camera_rays::Places;
use super::rounds::{Rounds, SampleSums};
use super::view::View;
use math::simd::{
    InstructionSet, N_LANES, SimdKernel, Vector, VectorColumn, lane_of, set_lane, to_arrays,
};

/// The pixels that get more samples, and statistics of all pixels. Columns have the order in which
/// the pixels started.
#[derive(Debug, Default)]
pub(super) struct NoisyPixels {
    all: Places,
    /// Position among all pixels of each pixel that gets more samples.
    positions: Vec<u32>,
    /// The first sample of each pixel.
    firsts: VectorColumn,
    /// The sums of the squares of the samples' differences from the first one.
    squares: VectorColumn,
    /// The number of samples of each pixel.
    n_samples: Vec<f32>,
}

impl NoisyPixels {
    /// Starts with all of these pixels.
    pub(super) fn begin(&mut self, places: &Places) {
        let n = places.len();
        self.all.clone_from(places);
        self.positions.clear();
        self.positions.extend(0..n as u32);
        self.firsts.reset(n);
        self.squares.reset(n);
        self.n_samples.clear();
        // After the last pixel, a number that makes no quotient infinite.
        self.n_samples.resize(n + N_LANES, 1.0);
    }

    /// Ends a round, after which the pixels of `places` have `n` samples with these sums of colors:
    /// removes finished pixels from `places`. If numbers of samples are planned, `planned` has them
    /// by pixel.
    pub(super) fn end_round(
        &mut self,
        places: &mut Places,
        colors: &VectorColumn,
        rounds: &Rounds,
        n: u32,
        planned: &[u32],
    ) {
        let Self {
            all,
            positions,
            firsts,
            squares,
            n_samples,
        } = self;
        positions.retain(|&position| {
            let position = position as usize;
            n_samples[position] = n as f32;
            let (number, _) = all.get(position);
            if let Some(&planned) = planned.get(number) {
                return n < planned;
            }
            let sums = sums_at(position, [colors, firsts, squares]);
            !rounds.next(&sums, n).is_empty()
        });
        places.fill(positions.iter().map(|&position| {
            let (number, at) = all.get(position as usize);
            (number as u32, at)
        }));
    }

    /// Ends with all pixels in `places`.
    pub(super) fn end(&mut self, places: &mut Places) {
        std::mem::swap(&mut self.all, places);
    }

    /// Returns the number of samples of each pixel, padded to whole lanes.
    pub(super) fn n_samples(&self) -> &[f32] {
        &self.n_samples
    }

    /// Returns the noise of the pixel that started at this position, with these sums of colors.
    pub(super) fn noise(&self, position: usize, colors: &VectorColumn) -> f32 {
        let sums = self.sums(position, colors);
        sums.noise(self.n_samples[position] as u32)
    }

    /// Returns the sums of the pixel that started at this position, of which `colors` has the
    /// sums of colors.
    pub(super) fn sums(&self, position: usize, colors: &VectorColumn) -> SampleSums<f32> {
        sums_at(position, [colors, &self.firsts, &self.squares])
    }

    /// Adds these samples of each pixel of `places` to the sums of their `colors`, by slot, and to
    /// the sums of the squares.
    pub(super) fn add<'a>(
        &'a mut self,
        view: &'a View<'a>,
        places: &'a Places,
        samples: Range<u32>,
        [colors, sums]: [&'a mut VectorColumn; 2],
    ) -> AddToPositions<'a> {
        AddToPositions {
            view,
            places,
            positions: &self.positions,
            samples,
            colors,
            sums,
            firsts: &mut self.firsts,
            squares: &mut self.squares,
        }
    }
}

/// See [`NoisyPixels::add`].
pub(super) struct AddToPositions<'a> {
    view: &'a View<'a>,
    places: &'a Places,
    positions: &'a [u32],
    samples: Range<u32>,
    colors: &'a VectorColumn,
    sums: &'a mut VectorColumn,
    firsts: &'a mut VectorColumn,
    squares: &'a mut VectorColumn,
}

impl SimdKernel for AddToPositions<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) {
        let n_samples = self.samples.len();
        for block in 0..self.places.n_blocks() {
            let positions = &self.positions[N_LANES * block..][..self.places.in_block(block)];
            let mut sums = SampleSums {
                colors: gathered(set, self.sums, positions),
                first: gathered(set, self.firsts, positions),
                squares: gathered(set, self.squares, positions),
            };
            for (i, sample) in self.samples.clone().enumerate() {
                let slot = N_LANES * (block * n_samples + i);
                let color = self.view.limited(self.colors.load(set, slot));
                sums.add(color, sample == 0);
            }
            scatter::<I>(sums.colors, self.sums, positions);
            scatter::<I>(sums.first, self.firsts, positions);
            scatter::<I>(sums.squares, self.squares, positions);
        }
    }
}

/// Returns the sums of the samples of the pixel at this position of the columns: of colors, first
/// samples and squares.
fn sums_at(position: usize, columns: [&VectorColumn; 3]) -> SampleSums<f32> {
    let [colors, first, squares] = columns.map(|column| Vector::from(column.get(position)));
    SampleSums {
        colors,
        first,
        squares,
    }
}

/// Returns the vectors at these positions, one per lane; zero in the other lanes.
#[inline(always)]
fn gathered<I: InstructionSet>(
    set: I,
    column: &VectorColumn,
    positions: &[u32],
) -> Vector<I::Lanes> {
    let mut numbers = [[0.0; N_LANES]; 3];
    for (lane, &position) in positions.iter().enumerate() {
        set_lane(&mut numbers, lane, column.get(position as usize));
    }
    set.load_vector(&numbers)
}

/// Overwrites the vectors at these positions with the vectors of the first lanes.
#[inline(always)]
fn scatter<I: InstructionSet>(
    vectors: Vector<I::Lanes>,
    column: &mut VectorColumn,
    positions: &[u32],
) {
    let numbers = to_arrays(vectors);
    for (lane, &position) in positions.iter().enumerate() {
        column.set(position as usize, lane_of(&numbers, lane));
    }
}
