//! The light of one light sample at the points of a wave, in lanes.

use super::numbers::WaveNumbers;
use super::paths::PathWave;
use crate::light::Illumination;
use crate::scene::{LightNumbers, Scene};
use crate::simd::{InstructionSet, Lanes, SimdKernel, VectorColumn, grow, lanes, lanes_mut};
use crate::trace::{PointGroup, Points};

/// The light that arrives at points unless it is occluded.
#[derive(Debug, Default)]
pub(super) struct ArrivingLight {
    direction: VectorColumn,
    distance: Vec<f32>,
    radiance: VectorColumn,
    density: Vec<f32>,
}

impl ArrivingLight {
    /// Makes room for this number of points.
    pub(super) fn grow(&mut self, n_points: usize) {
        self.direction.grow(n_points);
        self.radiance.grow(n_points);
        grow(&mut self.distance, n_points);
        grow(&mut self.density, n_points);
    }

    #[inline(always)]
    fn store<L: Lanes>(&mut self, first: usize, light: &Illumination<L>) {
        self.direction.store(first, light.direction);
        *lanes_mut(&mut self.distance, first) = light.distance.to_array();
        self.radiance.store(first, light.radiance);
        *lanes_mut(&mut self.density, first) = light.density.to_array();
    }

    /// The light at eight points.
    #[inline(always)]
    pub(super) fn load<I: InstructionSet>(&self, set: I, first: usize) -> Illumination<I::Lanes> {
        Illumination {
            direction: self.direction.load(set, first),
            distance: set.load(lanes(&self.distance, first)),
            radiance: self.radiance.load(set, first),
            density: set.load(lanes(&self.density, first)),
        }
    }
}

/// Computes the light at all points.
pub(super) struct SampleLights<'a> {
    pub(super) scene: &'a Scene,
    /// The number of the light sample.
    pub(super) sample: usize,
    pub(super) numbers: WaveNumbers<'a>,
    pub(super) wave: &'a PathWave,
    pub(super) points: &'a Points,
    pub(super) arriving: &'a mut ArrivingLight,
}

impl SimdKernel for SampleLights<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) {
        let lights = &self.scene.lights;
        for at in self.points.groups().iter().flat_map(PointGroup::lanes) {
            let point = self.points.shading(set, at);
            let numbers = if lights.are_random() {
                let rays = self.points.rays(at);
                self.numbers
                    .of_rays(set, self.wave, rays)
                    .light(self.sample)
            } else {
                LightNumbers::none(point.side)
            };
            let (light, _) =
                lights.illuminate(self.sample, [point.position, point.normal], &numbers);
            self.arriving.store(at.first, &light);
        }
    }
}
