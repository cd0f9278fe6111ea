//! Surface points → shadow rays toward one light, in lanes.

use super::arriving_light::SampledLight;
use super::model::Model;
use super::models::lit_groups;
use super::paths::PathWave;
use crate::accel::ShadowStream;
use crate::trace::{PointLanes, Points};
use math::simd::{
    InstructionSet, Lanes, Mask, N_LANES, SimdKernel, ascending, gather, grow, lanes_mut,
};
use world::material::Material;
use world::scene::Scene;

/// Shadow rays toward one light.
#[derive(Debug, Default)]
pub struct ShadowWave {
    /// The rays.
    pub rays: ShadowStream,
    /// The point that each ray leaves, padded to whole lanes.
    points: Vec<u32>,
    /// The pixel of each ray, padded to whole lanes.
    pixels: Vec<u32>,
}

impl ShadowWave {
    /// Removes all rays.
    pub(super) fn clear(&mut self) {
        self.rays.clear();
    }

    /// Returns the point that each ray leaves.
    pub(super) fn points(&self) -> &[u32] {
        &self.points[..self.rays.len()]
    }

    /// Returns the pixel of each ray.
    #[inline]
    pub fn pixels(&self) -> &[u32] {
        &self.pixels[..self.rays.len()]
    }
}

/// Collects the shadow rays of all points that the light may reach.
pub(super) struct CastShadows<'a, M> {
    pub(super) model: M,
    pub(super) scene: &'a Scene,
    pub(super) light: SampledLight<'a>,
    pub(super) wave: &'a PathWave,
    pub(super) points: &'a Points,
    pub(super) shadows: &'a mut ShadowWave,
}

impl<M: Model> SimdKernel for CastShadows<'_, M> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(mut self, set: I) {
        for group in lit_groups(self.scene, self.points) {
            let material = self.scene.material(group.material);
            for at in group.lanes() {
                let lanes = at.bits() & self.points.scattering_sides(set, at, material);
                self.cast(set, material, at, lanes);
            }
        }
    }
}

impl<M: Model> CastShadows<'_, M> {
    /// Collects the shadow rays of these lanes.
    #[inline(always)]
    fn cast<I: InstructionSet>(&mut self, set: I, material: &Material, at: PointLanes, lanes: u8) {
        // Keep the points that the light may reach.
        let point = self.points.shading(set, at);
        let light = self.light.at(set, at.first, point.position);
        let lanes = self.model.may_arrive(material, &point, &light).bits() & lanes;
        // Append their rays, which end at the light.
        let mask = set.mask(lanes);
        let origin = self.model.origin(&point, light.direction);
        let shadows = &mut *self.shadows;
        let next = shadows.rays.len();
        let t_max = self.model.end(&light);
        shadows
            .rays
            .push_lanes(origin, light.direction, t_max, mask);
        grow(&mut shadows.points, next + N_LANES);
        grow(&mut shadows.pixels, next + N_LANES);
        // Note the point and the pixel of each ray.
        let points = ascending(at.first as u32);
        let pixels = gather(self.wave.pixels(), self.points.rays(at));
        let cast = |numbers| set.load_bits(numbers).compress(mask).to_bits();
        *lanes_mut(&mut shadows.points, next) = cast(&points);
        *lanes_mut(&mut shadows.pixels, next) = cast(&pixels);
        if M::IGNORES_OWN_OBJECT {
            let points = (points.iter().enumerate()).filter(|(lane, _)| lanes >> lane & 1 != 0);
            let objects = points.map(|(_, &point)| Some(self.points.object(point as usize)));
            shadows.rays.ignored.extend(objects);
        }
    }
}
