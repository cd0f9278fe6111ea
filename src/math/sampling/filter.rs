//! Pixel filters by importance sampling: sample positions are distributed as the filter, so that
//! all samples have the same weight and pixels stay independent.
//!
//! After Ernst, Stamminger and Greiner, "Filter Importance Sampling", IEEE Symposium on Interactive
//! Ray Tracing, 2006.

use std::f64::consts::PI;

use crate::simd::{DeviceTable, LookupTable, Real};
use base::keywords;

keywords! {
    /// The weight of light by its distance from the pixel's center, separately in x and y.
    #[derive(Default)]
    pub enum PixelFilter {
        /// The same weight everywhere
        #[default]
        Box = "box",
        /// Linear, from the center to 0 at the radius
        Tent = "tent",
        /// The window of Blackman and Harris, close to a Gaussian
        BlackmanHarris = "blackman_harris",
    }
}

impl PixelFilter {
    /// Returns the usual radius in pixels.
    pub fn usual_radius(self) -> f32 {
        match self {
            Self::Box => 0.5,
            Self::Tent => 1.0,
            Self::BlackmanHarris => 1.5,
        }
    }
}

/// Number of steps of the table.
const N_STEPS: usize = 64;

/// The terms of the window of Blackman and Harris: `sum of a_k cos(k pi x)` from -1 to 1
/// (Harris, "On the Use of Windows", Proc. IEEE 66(1), 1978).
const TERMS: [f64; 4] = [0.35875, 0.48829, 0.14128, 0.01168];

/// Distributes positions as a filter of some radius.
#[derive(Debug, Clone, Copy)]
pub struct FilterSampler {
    filter: PixelFilter,
    /// Radius in pixels.
    radius: f32,
    /// For the window of Blackman and Harris: the distance from the center, from 1 to 0, beyond
    /// which the share `q^4` of the light lies, at equal steps of `q`. The fourth root makes the
    /// nearly flat tail as accurate as the rest.
    distances: [f32; N_STEPS + 1],
}

impl FilterSampler {
    /// Creates a sampler of a filter with this radius in pixels.
    pub fn new(filter: PixelFilter, radius: f32) -> Self {
        let distance = |step: usize| {
            let outside = (step as f64 / N_STEPS as f64).powi(4);
            distance_with_inside(1.0 - outside) as f32
        };
        let distances = match filter {
            PixelFilter::BlackmanHarris => std::array::from_fn(distance),
            PixelFilter::Box | PixelFilter::Tent => [0.0; N_STEPS + 1],
        };
        Self {
            filter,
            radius,
            distances,
        }
    }

    /// Maps the position of an evenly distributed sample, in [-0.5, 0.5) in x and y, to a filtered
    /// position in pixels, relative to the pixel's center.
    #[inline(always)]
    pub fn position<R: Real>(&self, [x, y]: [R; 2]) -> [R; 2] {
        [self.coordinate(x), self.coordinate(y)]
    }

    #[inline(always)]
    fn coordinate<R: Real>(&self, even: R) -> R {
        let radius = even.splat(self.radius);
        if self.filter == PixelFilter::Box {
            return even * (radius + radius);
        }
        let one = even.splat(1.0);
        // The share of the light farther from the center.
        let outside = (one - even.splat(2.0) * even.abs()).max(even.splat(0.0));
        let distance = match self.filter {
            PixelFilter::Box | PixelFilter::Tent => one - outside.sqrt(),
            PixelFilter::BlackmanHarris => {
                let [distance] = R::look_up(self, [outside.sqrt().sqrt()]);
                distance
            }
        };
        (radius * distance).flip_sign_by(even)
    }
}

/// Interpolates the distance at a value of `q` from 0 to 1.
impl LookupTable<1, 1> for FilterSampler {
    #[inline(always)]
    fn values_at(&self, [root]: [f32; 1]) -> [f32; 1] {
        let step = f64::from(root) * N_STEPS as f64;
        let i = (step as usize).min(N_STEPS - 1);
        let [from, to] = [self.distances[i], self.distances[i + 1]].map(f64::from);
        [(from + (step - i as f64) * (to - from)) as f32]
    }

    fn on_device(&self) -> Result<DeviceTable, &'static str> {
        Err("a pixel filter")
    }
}

/// Returns the share of the window's light within this distance from the center.
fn inside(distance: f64) -> f64 {
    let [mean, waves @ ..] = TERMS;
    let wave = |(term, k): (f64, f64)| term * libm::sin(k * PI * distance) / (k * PI);
    let waves: f64 = waves.into_iter().zip([1.0, 2.0, 3.0]).map(wave).sum();
    distance + waves / mean
}

/// Finds the distance within which this share of the light lies, by bisection.
fn distance_with_inside(share: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    // A few more steps than an f32 has bits.
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if inside(middle) < share {
            low = middle;
        } else {
            high = middle;
        }
    }
    if share <= 0.0 { 0.0 } else { high }
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: u32 = 100_000;

    /// Even positions of one coordinate.
    fn evenly() -> impl Iterator<Item = f32> {
        (0..N).map(|i| (i as f32 + 0.5) / N as f32 - 0.5)
    }

    /// The filter's weight at a distance in radii; the integral from -1 to 1 is 1.
    fn weight(filter: PixelFilter, x: f64) -> f64 {
        match filter {
            PixelFilter::Box => 0.5,
            PixelFilter::Tent => 1.0 - x.abs(),
            PixelFilter::BlackmanHarris => {
                let window = |(k, term): (usize, f64)| term * (k as f64 * PI * x).cos();
                TERMS.into_iter().enumerate().map(window).sum::<f64>() / (2.0 * TERMS[0])
            }
        }
    }

    #[test]
    fn positions_are_distributed_as_the_weights_which_integrate_to_one() {
        for filter in [
            PixelFilter::Box,
            PixelFilter::Tent,
            PixelFilter::BlackmanHarris,
        ] {
            let sampler = FilterSampler::new(filter, 2.5);
            let mut counts = [0; 50];
            for even in evenly() {
                let [x, y] = sampler.position([even, -even]);
                assert!(x == -y && x.abs() <= 2.5, "{x} {y}");
                counts[(x * 10.0 + 25.0).clamp(0.0, 49.0) as usize] += 1;
            }
            let mut whole = 0.0;
            for (i, n) in counts.into_iter().enumerate() {
                let from = i as f64 / 25.0 - 1.0;
                // The midpoint rule with many steps.
                let steps = (0..100).map(|step| from + (f64::from(step) + 0.5) / 2500.0);
                let expected: f64 = steps.map(|x| weight(filter, x) / 2500.0).sum();
                whole += expected;
                let found = f64::from(n) / f64::from(N);
                assert!(
                    (found - expected).abs() < 2e-4,
                    "{filter:?} {i}: {found}, {expected}"
                );
            }
            assert!((whole - 1.0).abs() < 1e-4, "{filter:?}: {whole}");
            assert_eq!(sampler.position([0.0_f32; 2]), [0.0; 2]);
        }
    }

    #[test]
    fn the_usual_box_is_the_pixel() {
        let sampler = FilterSampler::new(PixelFilter::Box, PixelFilter::Box.usual_radius());
        assert!(evenly().all(|even| sampler.position([even; 2]) == [even; 2]));
    }
}
