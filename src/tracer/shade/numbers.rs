//! The random numbers of points of paths.

use super::paths::PathWave;
use math::sampling::{Dimension, Sampler};
use math::simd::{InstructionSet, Integer, N_LANES, Real, lanes_mut};
use world::scene::{LightNumbers, Lights};

/// The sample of a picture that a path belongs to, or one per lane.
#[derive(Debug, Clone, Copy)]
pub struct SampleId<N> {
    /// Number of the pixel in the picture.
    pub pixel: N,
    /// Number of the sample in its pixel.
    pub sample: N,
}

/// The random numbers at the point that a path reaches after some bounces, or at one point per
/// lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct PointNumbers<N> {
    pub(super) sampler: Sampler,
    pub(super) id: SampleId<N>,
    /// The number of the first [`Dimension`] of the point.
    dimension: N,
}

/// The samples of the paths, by slot.
#[derive(Debug, Default)]
pub struct SampleIds {
    pixels: Vec<u32>,
    samples: Vec<u32>,
}

impl SampleIds {
    /// Makes room for this number of slots.
    pub fn resize(&mut self, n_slots: usize) {
        self.pixels.resize(n_slots, 0);
        self.samples.resize(n_slots, 0);
    }

    /// Sets the sample of eight slots from `first` on: the same sample of eight pixels.
    #[inline(always)]
    pub fn set(&mut self, first: usize, pixels: &[u32; N_LANES], sample: u32) {
        *lanes_mut(&mut self.pixels, first) = *pixels;
        *lanes_mut(&mut self.samples, first) = [sample; N_LANES];
    }

    /// Overwrites `samples` with the pixel and the sample of the paths in these slots; empty if
    /// there are no numbers.
    pub fn write(&self, slots: &[u32], samples: &mut Vec<[u32; 2]>) {
        samples.clear();
        if !self.pixels.is_empty() {
            let of_slot = |&slot: &u32| {
                let SampleId { pixel, sample } = self.sample_id(slot);
                [pixel, sample]
            };
            samples.extend(slots.iter().map(of_slot));
        }
    }

    /// Returns the sample of the path in this slot.
    pub(super) fn sample_id(&self, slot: u32) -> SampleId<u32> {
        SampleId {
            pixel: self.pixels[slot as usize],
            sample: self.samples[slot as usize],
        }
    }

    /// Returns the samples of the paths of eight rays of a wave.
    #[inline(always)]
    fn sample_ids<I: InstructionSet>(
        &self,
        set: I,
        wave: &PathWave,
        rays: &[u32; N_LANES],
    ) -> SampleId<<I::Lanes as Real>::Integer> {
        let (mut pixels, mut samples) = ([0; N_LANES], [0; N_LANES]);
        for (lane, &ray) in rays.iter().enumerate() {
            let slot = wave.slots()[ray as usize] as usize;
            (pixels[lane], samples[lane]) = (self.pixels[slot], self.samples[slot]);
        }
        SampleId {
            pixel: set.load_integers(&pixels),
            sample: set.load_integers(&samples),
        }
    }
}

/// The random numbers of the points of a wave.
#[derive(Clone, Copy)]
pub(super) struct WaveNumbers<'a> {
    pub(super) sampler: Sampler,
    pub(super) ids: &'a SampleIds,
}

impl WaveNumbers<'_> {
    /// Returns the numbers of the points that eight rays have hit.
    #[inline(always)]
    pub(super) fn point_numbers<I: InstructionSet>(
        &self,
        set: I,
        wave: &PathWave,
        rays: &[u32; N_LANES],
    ) -> PointNumbers<<I::Lanes as Real>::Integer> {
        PointNumbers::new(
            self.sampler,
            self.ids.sample_ids(set, wave, rays),
            wave.depth,
        )
    }
}

/// Choices at a point, each of which gets a pair of numbers.
const DIRECTION: u32 = 0;
const LOBE: u32 = 1;
/// For light sample `i`: pair `FIRST_LIGHT + 2 * i` chooses the light and its shape, the next pair
/// the point on the shape; pair `FURTHER_BITS + i` continues the bits of the first one.
const FIRST_LIGHT: u32 = 2;
const FURTHER_BITS: u32 = 1 << 19;

/// Distance at which a ray in fog meets a particle.
const FLIGHT: u32 = (1 << 20) - 1;

/// Number of light samples with separate numbers; further ones repeat them.
const N_LIGHTS: u32 = (1 << 18) - 1;

impl<N: Integer> PointNumbers<N> {
    /// Returns the numbers of the point of a sample after this number of bounces.
    #[inline(always)]
    pub(super) fn new(sampler: Sampler, id: SampleId<N>, depth: u32) -> Self {
        let dimension = id.pixel.splat(Dimension::after_bounces(depth, 0).0);
        Self::from_dimension(sampler, id, dimension)
    }

    /// Returns the numbers of a point, given the number of its first dimension.
    #[inline(always)]
    pub(super) fn from_dimension(sampler: Sampler, id: SampleId<N>, dimension: N) -> Self {
        Self {
            sampler,
            id,
            dimension,
        }
    }

    /// Returns the numbers that choose a direction.
    #[inline(always)]
    pub(super) fn direction<R: Real<Integer = N>>(&self) -> [R; 2] {
        self.pair(DIRECTION)
    }

    /// Returns the numbers that choose how light is scattered, and if the path ends.
    #[inline(always)]
    pub(super) fn lobe<R: Real<Integer = N>>(&self) -> [R; 2] {
        self.pair(LOBE)
    }

    /// Returns the number that chooses where the ray to the point meets a particle of fog.
    #[inline(always)]
    pub(super) fn flight<R: Real<Integer = N>>(&self) -> R {
        let [number, _] = self.pair(FLIGHT);
        number
    }

    /// Returns the numbers that choose the light of sample `i`.
    #[inline(always)]
    pub(super) fn light<R: Real<Integer = N>>(&self, lights: &Lights, i: usize) -> LightNumbers<R> {
        let i = i as u32 % N_LIGHTS;
        let first = FIRST_LIGHT + 2 * i;
        let point: [R; 2] = self.pair(first + 1);
        let [[source, shape], [more_of_source, more_of_shape]] = if lights.need_choices() {
            [self.pair(first), self.pair(FURTHER_BITS + i)]
        } else {
            [point; 2]
        };
        LightNumbers {
            source: [source, more_of_source],
            shape: [shape, more_of_shape],
            point,
        }
    }

    #[inline(always)]
    fn pair<R: Real<Integer = N>>(&self, choice: u32) -> [R; 2] {
        let SampleId { pixel, sample } = self.id;
        // A dimension has room for all choices: the sum is what `after_bounces` returns.
        let dimension = self.dimension.plus(pixel.splat(choice));
        self.sampler.pair(pixel, sample, dimension)
    }
}
