//! The light that surface points reflect to the viewer, in lanes.

use glam::Vec3;

use super::arriving_light::SampledLight;
use super::bsdf::Boundary;
use super::interfaces::Interfaces;
use super::model::{Bounce, Model};
use super::paths::PathWave;
use crate::trace::{PointLanes, Points};
use math::simd::{
    Arithmetic, InstructionSet, Lanes, Mask, N_LANES, SimdKernel, Vector, VectorColumn, lanes,
    set_lane,
};
use world::scene::Scene;

/// Sets the radiance of points to the reflected ambient light.
pub(super) struct AddAmbient<'a, M> {
    pub(super) model: M,
    pub(super) scene: &'a Scene,
    pub(super) points: &'a Points,
    pub(super) radiance: &'a mut VectorColumn,
}

impl<M: Model> SimdKernel for AddAmbient<'_, M> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) {
        let ambient = self.scene.shading.ambient;
        for group in self.points.groups() {
            let material = self.scene.material(group.material);
            for at in group.lanes() {
                let color = self.points.colors(set, at);
                let reflected = self.model.ambient(material, ambient, color);
                // Points on the hidden side of a one-sided surface reflect none.
                let lanes = set.mask(self.points.scattering_sides(set, at, material));
                let none = set.splat_vector(Vec3::ZERO);
                self.radiance
                    .store(at.first, Vector::select(lanes, reflected, none));
            }
        }
    }
}

/// The points where the paths of a wave start.
#[derive(Debug, Clone, Copy)]
pub enum Eyes<'a> {
    /// The same point for all paths.
    One(Vec3),
    /// One point per path, by slot.
    OfSlots(&'a [Vec3]),
}

/// Adds the light from one light to the radiance of points.
pub(super) struct AddLight<'a, M> {
    pub(super) model: M,
    pub(super) scene: &'a Scene,
    pub(super) light: SampledLight<'a>,
    pub(super) eyes: Eyes<'a>,
    pub(super) wave: &'a PathWave,
    pub(super) points: &'a Points,
    /// The share of the light that reaches each point.
    pub(super) reached: &'a [f32],
    pub(super) radiance: &'a mut VectorColumn,
}

impl<M: Model> SimdKernel for AddLight<'_, M> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) {
        for group in self.points.groups() {
            let material = self.scene.material(group.material);
            for at in group.lanes() {
                // Skip eight points that the light does not reach.
                let share = set.load(lanes(self.reached, at.first));
                let reached = set.splat(0.0).lt(share);
                if reached.bits() == 0 {
                    continue;
                }
                // Find the light, the viewer and the boundary at each point.
                let point = self.points.shading(set, at);
                let mut light = self.light.at(set, at.first, point.position);
                light.radiance = light.radiance * share;
                let (eye, direction) = (self.eyes(set, at), self.points.directions(set, at));
                let to_viewer = self.model.to_viewer(&point, eye, direction);
                let boundary = if M::BOUNCE == Bounce::Scattered && material.kind.medium().is_some()
                {
                    let (rays, flipped) = (self.points.rays(at), point.side.signs());
                    Interfaces::met(self.scene, self.wave, group.material, rays, flipped)
                        .boundary(set)
                } else {
                    Boundary::without_medium(point.side)
                };
                // Add the reflected light where it arrives.
                let reflected = self
                    .model
                    .reflected(material, &boundary, &point, &light, to_viewer);
                let before = self.radiance.load(set, at.first);
                let after = Vector::select(reached, before + reflected, before);
                self.radiance.store(at.first, after);
            }
        }
    }
}

impl<M> AddLight<'_, M> {
    /// Returns the starts of the paths of eight points.
    #[inline(always)]
    fn eyes<I: InstructionSet>(&self, set: I, at: PointLanes) -> Vector<I::Lanes> {
        let eyes = match self.eyes {
            Eyes::One(eye) => return set.splat_vector(eye),
            Eyes::OfSlots(eyes) => eyes,
        };
        let mut columns = [[0.0; N_LANES]; 3];
        for (lane, &ray) in self.points.rays(at).iter().enumerate() {
            let slot = self.wave.slots()[ray as usize];
            set_lane(&mut columns, lane, eyes[slot as usize]);
        }
        set.load_vector(&columns)
    }
}
