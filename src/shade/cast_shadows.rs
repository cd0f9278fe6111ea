//! Surface points → shadow rays toward one light, in lanes.

use super::model::Model;
use super::paths::PathWave;
use crate::accel::ShadowRay;
use crate::geometry::Ray;
use crate::light::Light;
use crate::simd::{InstructionSet, Lanes, Mask, N_LANES, SimdKernel, lane_of, to_arrays};
use crate::trace::{PointLanes, Points};

/// Shadow rays toward one light.
#[derive(Debug, Default)]
pub struct ShadowWave {
    /// The rays.
    pub rays: Vec<ShadowRay>,
    /// The point that each ray leaves.
    pub points: Vec<u32>,
    /// The pixel of each ray.
    pub pixels: Vec<u32>,
}

impl ShadowWave {
    /// Removes all rays.
    pub(super) fn clear(&mut self) {
        self.rays.clear();
        self.points.clear();
        self.pixels.clear();
    }
}

/// Collects the shadow rays of all points that the light may reach.
pub(super) struct CastShadows<'a, M> {
    pub(super) model: M,
    pub(super) light: &'a Light,
    pub(super) wave: &'a PathWave,
    pub(super) points: &'a Points,
    pub(super) shadows: &'a mut ShadowWave,
}

impl<M: Model> SimdKernel for CastShadows<'_, M> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(mut self, set: I) {
        for group in self.points.groups() {
            for at in group.lanes() {
                self.cast(set, at);
            }
        }
    }
}

impl<M: Model> CastShadows<'_, M> {
    /// Collects the shadow rays of eight points.
    #[inline(always)]
    fn cast<I: InstructionSet>(&mut self, set: I, at: PointLanes) {
        let point = self.points.shading(set, at);
        let light = self.light.illuminate(point.position);
        let mut lanes = self.model.may_arrive(&point, &light).bits() & at.bits();
        let origin = self.model.origin(&point, light.direction);
        let (origin, direction) = (to_arrays(origin), to_arrays(light.direction));
        let t_max = self.model.end(&light).to_array();
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % N_LANES;
            lanes &= lanes - 1;
            let ray = Ray {
                origin: lane_of(&origin, lane),
                direction: lane_of(&direction, lane),
            };
            self.push(at.first + lane, ray, t_max[lane]);
        }
    }

    #[inline(always)]
    fn push(&mut self, point: usize, ray: Ray, t_max: f32) {
        self.shadows.rays.push(ShadowRay {
            ray,
            t_max,
            ignored: M::IGNORES_OWN_OBJECT.then(|| self.points.object(point)),
        });
        self.shadows.points.push(point as u32);
        self.shadows
            .pixels
            .push(self.wave.pixels[self.points.ray(point)]);
    }
}
