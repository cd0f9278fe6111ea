//! The environment map as a light.

use std::f32::consts::{FRAC_1_PI, PI};

use glam::Vec3;

use super::emitter::luminance;
use crate::background::EnvironmentMap;
use crate::light::Illumination;
use crate::picture::Picture;
use math::sampling::EquirectangularDistribution;
use math::simd::{Real, Vector};

/// An environment map that is sampled in proportion to its luminance.
#[derive(Debug, Clone)]
pub struct EnvironmentLight {
    map: EnvironmentMap,
    distribution: EquirectangularDistribution,
    /// The mean luminance over all directions.
    mean_luminance: f32,
}

/// Maximum number of texels of the distribution: enough for pictures of 2048 x 1024 texels, and a
/// fraction of the memory of larger ones.
const MAX_TEXELS: usize = 1 << 21;

impl EnvironmentLight {
    /// Returns an upper bound of the memory of a picture's light in bytes, besides the picture.
    pub fn n_bytes(picture: &Picture) -> u64 {
        let ([width, height], _) = picture.reduced(MAX_TEXELS);
        // Each texel has its density and a cumulative share.
        2 * size_of::<f32>() as u64 * u64::from(width + 1) * u64::from(height)
    }

    /// Creates the light of a map; `None` if it is black.
    pub(super) fn new(map: &EnvironmentMap) -> Option<Self> {
        let ([width, _], texels) = map.picture.reduced(MAX_TEXELS);
        let brightness = |[r, g, b, _]: [f32; 4]| map.brightness(luminance(Vec3::new(r, g, b)));
        let texels: Vec<f32> = texels.map(brightness).collect();
        let width = width as usize;
        let mean_luminance = mean(width, &texels);
        Some(Self {
            distribution: EquirectangularDistribution::new(width, &texels)?,
            map: map.clone(),
            mean_luminance,
        })
    }

    /// Samples a direction with two numbers in [0, 1), and returns the light that arrives from it
    /// at any point, unless it is occluded.
    #[inline(always)]
    pub(super) fn illuminate<R: Real>(&self, numbers: [R; 2]) -> Illumination<R> {
        let [column, height, density] = R::look_up(&self.distribution, numbers);
        let direction = self.map.direction(column, height);
        let least = density.splat(f32::MIN_POSITIVE);
        let weight = density.splat(FRAC_1_PI) / density.max(least);
        Illumination {
            direction,
            distance: density.splat(f32::INFINITY),
            radiance: self.map.radiance(direction) * weight,
            density,
        }
    }

    /// Returns the probability density of a direction, per steradian.
    #[inline(always)]
    pub fn density<R: Real>(&self, direction: Vector<R>) -> R {
        let [u, v] = self.map.place(direction);
        let [density] = R::look_up(&self.distribution, [u, v, direction.y]);
        density
    }

    /// Returns the mean luminance over all directions.
    pub(super) fn mean_luminance(&self) -> f32 {
        self.mean_luminance
    }

    /// Returns the power that a sphere of this radius receives.
    pub(super) fn power(&self, radius: f32) -> f64 {
        4.0 * f64::from(PI * radius).powi(2) * f64::from(self.mean_luminance)
    }
}

/// Returns the mean of a map of all directions, row by row.
fn mean(width: usize, texels: &[f32]) -> f32 {
    let n_rows = texels.len() / width;
    let (mut sum, mut n) = (0.0, 0.0);
    for (row, texels) in texels.chunks_exact(width).enumerate() {
        let area = (std::f64::consts::PI * (row as f64 + 0.5) / n_rows as f64).sin();
        sum += area * texels.iter().map(|&texel| f64::from(texel)).sum::<f64>();
        n += area * width as f64;
    }
    (sum / n) as f32
}
