//! The samples of pixels.

use super::hash::{hash, mixed, unit};
use super::sobol;
use super::stratified::Strata;
use crate::simd::{Integer, Real};
use base::keywords;

keywords! {
    /// A pattern of the samples' positions in a pixel. Each pattern contains the pixel's center.
    #[derive(Default)]
    pub enum PixelPattern {
        /// Strata of equal area with one jittered point each
        #[default]
        Stratified = "stratified",
        /// Owen-scrambled Sobol' points, evenly spread from the first one on
        Sobol = "sobol",
    }
}

/// The decision that two numbers of a sample are used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dimension(pub u32);

impl Dimension {
    /// The position in the pixel.
    const PIXEL: Self = Self(0);
    /// The point on the lens.
    pub const LENS: Self = Self(1);

    /// Returns the dimension of choice `choice`, less than 2^20, after this number of bounces, up
    /// to 255.
    #[inline]
    pub const fn after_bounces(depth: u32, choice: u32) -> Self {
        Self(2 + (depth << 20 | choice))
    }
}

/// Generates the numbers of a picture's samples.
///
/// They depend only on the seed, the pixel, the sample and the [`Dimension`]. Hashes decorrelate
/// pixels and dimensions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampler {
    /// `None` for Sobol' points.
    strata: Option<Strata>,
    /// The lower half of the seed.
    seed: u32,
    /// The hash of the upper half of the seed.
    mixed: [u32; 4],
}

impl Sampler {
    /// Creates a sampler of `n_samples` per pixel, at least 1.
    pub fn new(pattern: PixelPattern, n_samples: u32, seed: u64) -> Self {
        Self {
            strata: match pattern {
                PixelPattern::Stratified => Some(Strata::new(n_samples, seed)),
                PixelPattern::Sobol => None,
            },
            seed: seed as u32,
            // Distinct from the keys of the strata.
            mixed: mixed([(seed >> 32) as u32, 0, 1]),
        }
    }

    /// Returns the index of the sample at the pixel's center.
    #[inline]
    pub fn center(&self) -> u32 {
        self.strata.as_ref().map_or(0, Strata::center)
    }

    /// Returns the position of a sample in one pixel, or one per lane: both coordinates in [-0.5,
    /// 0.5), relative to the pixel's center. Pixels are numbered row by row.
    #[inline(always)]
    pub fn position<R: Real>(&self, pixel: R::Integer, sample: u32) -> [R; 2] {
        if let Some(strata) = &self.strata {
            return strata.point(pixel, sample);
        }
        let [x, y, ..] = self.seeds(pixel, pixel.splat(Dimension::PIXEL.0));
        let [x, y] = sobol::centered_point(pixel.splat(sample), [x, y]);
        let (x, y) = (unit::<R>(x), unit::<R>(y));
        let half = x.splat(0.5);
        [x - half, y - half]
    }

    /// Returns two numbers in [0, 1) for one sample, or one per lane: Owen-scrambled Sobol' points,
    /// whatever the pattern. `dimension` is the number of a [`Dimension`].
    #[inline(always)]
    pub fn pair<R: Real>(
        &self,
        pixel: R::Integer,
        sample: R::Integer,
        dimension: R::Integer,
    ) -> [R; 2] {
        let [x, y, order, _] = self.seeds(pixel, dimension);
        let [x, y] = sobol::point(sobol::shuffled(sample, order), [x, y]);
        [unit::<R>(x), unit::<R>(y)]
    }

    /// Returns the seeds of a pixel in a dimension.
    #[inline(always)]
    fn seeds<N: Integer>(&self, pixel: N, dimension: N) -> [N; 4] {
        let key = [pixel.splat(self.seed), pixel, dimension];
        hash(key, self.mixed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{InstructionSet, Lanes, N_LANES, Simd, SimdKernel};

    /// Positions and pairs of eight pixels.
    struct Sampled(Sampler, [u32; N_LANES], u32);

    impl SimdKernel for Sampled {
        type Output = [[f32; N_LANES]; 4];

        #[inline(always)]
        fn run<I: InstructionSet>(self, set: I) -> Self::Output {
            let Self(sampler, pixels, sample) = self;
            let pixels = set.load_integers(&pixels);
            let [x, y] = sampler.position::<I::Lanes>(pixels, sample);
            let sample = pixels.splat(sample);
            let [u, v] = sampler.pair::<I::Lanes>(pixels, sample, sample.splat(3));
            [x, y, u, v].map(Lanes::to_array)
        }
    }

    #[test]
    fn lanes_have_the_bits_of_single_pixels_on_every_path() {
        let pixels = [0, 1, 2, 77, 1 << 20, u32::MAX, 12345, 8];
        for pattern in [PixelPattern::Stratified, PixelPattern::Sobol] {
            let sampler = Sampler::new(pattern, 16, 0x0123_4567_89ab_cdef);
            for sample in 0..16 {
                for simd in Simd::available() {
                    let found = simd.run(Sampled(sampler, pixels, sample));
                    for (lane, &pixel) in pixels.iter().enumerate() {
                        let [x, y] = sampler.position::<f32>(pixel, sample);
                        let [u, v] = sampler.pair::<f32>(pixel, sample, 3);
                        assert_eq!(found.map(|row| row[lane]), [x, y, u, v], "{simd}");
                    }
                }
            }
        }
    }

    #[test]
    fn every_pattern_contains_the_center() {
        for pattern in [PixelPattern::Stratified, PixelPattern::Sobol] {
            for n in [1, 2, 5, 16] {
                let sampler = Sampler::new(pattern, n, 3);
                assert_eq!(sampler.position::<f32>(9, sampler.center()), [0.0; 2]);
            }
        }
    }
}
