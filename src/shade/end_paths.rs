//! The radiance of surface points and of the background → the colors of paths.

use super::model::Model;
use super::paths::PathWave;
use crate::material::Material;
use crate::scene::Scene;
use crate::simd::{
    InstructionSet, N_LANES, SimdKernel, Vector, VectorColumn, lane_of, set_lane, to_arrays,
};
use crate::trace::{PointLanes, Points};

/// Adds the radiance of points to their paths, and collects the reflected rays.
pub(super) struct EndPoints<'a, M> {
    pub(super) model: M,
    pub(super) scene: &'a Scene,
    pub(super) points: &'a Points,
    pub(super) radiance: &'a VectorColumn,
    /// The points that some light reaches: a bit each, a byte for eight.
    pub(super) lit: &'a [u8],
    pub(super) wave: &'a PathWave,
    pub(super) next: &'a mut PathWave,
    /// The color of each path, by slot.
    pub(super) colors: &'a mut VectorColumn,
}

impl<M: Model> SimdKernel for EndPoints<'_, M> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(mut self, set: I) {
        let may_bounce = self.wave.depth < u32::from(self.scene.shading.max_depth);
        for group in self.points.groups() {
            let material = self.scene.material(group.material);
            let reflects = may_bounce && material.reflection > 0.0;
            for at in group.lanes() {
                let mut ended = at.bits();
                if M::NEEDS_LIGHT {
                    ended &= self.lit[at.first / N_LANES];
                }
                self.add(set, at, ended);
                if reflects {
                    self.reflect(set, material, at, ended);
                }
            }
        }
    }
}

impl<M: Model> EndPoints<'_, M> {
    /// Adds the radiance of these lanes.
    #[inline(always)]
    fn add<I: InstructionSet>(&mut self, set: I, at: PointLanes, lanes: u8) {
        let radiance = self.radiance.load(set, at.first);
        let (slots, weights) = self.wave.of_rays(self.points.rays(at));
        add(set, self.colors, radiance, &slots, &weights, lanes);
    }

    /// Collects the reflected rays of these lanes.
    #[inline(always)]
    fn reflect<I: InstructionSet>(
        &mut self,
        set: I,
        material: &Material,
        at: PointLanes,
        lanes: u8,
    ) {
        let point = self.points.shading(set, at);
        let direction = point.mirrored(self.points.directions(set, at));
        let origin = self.model.origin(&point, direction);
        let rays = self.points.rays(at);
        let reflection = material.reflection;
        let reflected = [origin, direction];
        self.next
            .bounce(set, reflected, self.wave, rays, reflection, lanes);
    }
}

/// Adds the background to the paths whose rays hit nothing.
pub(super) struct AddBackground<'a> {
    pub(super) scene: &'a Scene,
    /// The rays that hit nothing.
    pub(super) missed: &'a [u32],
    pub(super) wave: &'a PathWave,
    /// The color of each path, by slot.
    pub(super) colors: &'a mut VectorColumn,
}

impl SimdKernel for AddBackground<'_> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) {
        for missed in self.missed.chunks(N_LANES) {
            let mut rays = [missed[0]; N_LANES];
            rays[..missed.len()].copy_from_slice(missed);
            let mut directions = [[0.0; N_LANES]; 3];
            for (lane, &ray) in rays.iter().enumerate() {
                set_lane(
                    &mut directions,
                    lane,
                    self.wave.rays.get(ray as usize).direction,
                );
            }
            let radiance = self.scene.background.color(set.load_vector(&directions));
            let (slots, weights) = self.wave.of_rays(&rays);
            let lanes = u8::MAX >> (N_LANES - missed.len());
            add(set, self.colors, radiance, &slots, &weights, lanes);
        }
    }
}

/// Adds weighted radiance to the colors of these lanes' slots.
#[inline(always)]
fn add<I: InstructionSet>(
    set: I,
    colors: &mut VectorColumn,
    radiance: Vector<I::Lanes>,
    slots: &[u32; N_LANES],
    weights: &[f32; N_LANES],
    mut lanes: u8,
) {
    let weighted = to_arrays(radiance * set.load(weights));
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize % N_LANES;
        lanes &= lanes - 1;
        colors.add(slots[lane] as usize, lane_of(&weighted, lane));
    }
}
