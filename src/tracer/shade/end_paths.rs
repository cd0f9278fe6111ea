//! The radiance of surface points and of the background → the colors of paths.

use super::emission::weighted_background;
use super::fresnel::{mirrored_share, split_at};
use super::interfaces::Interfaces;
use super::model::{Bounce, Model};
use super::path::is_worth_tracing;
use super::paths::{Continued, PathWave};
use crate::cost::RayKind;
use crate::trace::{PointLanes, Points};
use math::optics::Split;
use math::simd::{InstructionSet, Lanes, N_LANES, SimdKernel, VectorColumn, bits_of, lanes};
use world::material::Material;
use world::scene::{MaterialId, Scene};

/// Adds the radiance of points to their paths, and collects the reflected rays, unless the model
/// scatters them.
pub(super) struct EndPoints<'a, M> {
    pub(super) model: M,
    pub(super) scene: &'a Scene,
    pub(super) points: &'a Points,
    pub(super) radiance: &'a VectorColumn,
    /// 1 for each point that some light reaches, else 0.
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
        let may_bounce = M::BOUNCE == Bounce::Mirrored
            && self.wave.depth < u32::from(self.scene.shading.max_depth);
        for group in self.points.groups() {
            let material = self.scene.material(group.material);
            let reflects = may_bounce && material.kind.mirrors();
            for at in group.lanes() {
                // Add the radiance to the colors of the paths.
                let mut ended = at.bits();
                if M::NEEDS_LIGHT {
                    ended &= bits_of(lanes(self.lit, at.first));
                }
                self.add(set, at, ended);
                if material.is_veil() && self.scene.splits_at_veils() {
                    self.pass(set, at, ended);
                }
                // Continue the paths: a mirror reflects, the surface of a medium splits.
                ended &= self.points.scattering_sides(set, at, material);
                match material.kind.medium() {
                    None if reflects => self.reflect(set, material, at, ended),
                    Some(_) if may_bounce => self.split(set, group.material, at, ended),
                    _ => {}
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
        let (slots, weights) =
            self.wave
                .slots_and_weights(set, self.points.rays(at), self.scene.splits_paths());
        let met = weights * self.points.opacities(set, at);
        let added = self
            .wave
            .with_gained(set, self.points.rays(at), radiance.times(met));
        self.colors.add_to(set, &slots, added, lanes);
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
        let arriving = self.points.directions(set, at);
        let direction = point.mirrored(arriving);
        let origin = self.model.origin(&point, direction);
        let rays = self.points.rays(at);
        let before = self.wave.weights.gather(set, rays) * self.points.opacities(set, at);
        let reflected = Continued {
            origin,
            direction,
            weight: before.times(mirrored_share(material, &point, arriving)),
            rays,
            kinds: [RayKind::Reflection; N_LANES],
            densities: [f32::INFINITY; N_LANES],
            distances: self.points.distances(at),
            media: None,
        };
        self.next.bounce(set, &reflected, self.wave, lanes);
    }

    /// Collects the rays of these lanes that go on past a surface that is not opaque.
    #[inline(always)]
    fn pass<I: InstructionSet>(&mut self, set: I, at: PointLanes, lanes: u8) {
        let point = self.points.shading(set, at);
        let direction = self.points.directions(set, at);
        let rays = self.points.rays(at);
        let share = set.splat(1.0) - self.points.opacities(set, at);
        let passing = Continued {
            origin: self.model.origin(&point, direction),
            direction,
            weight: self.wave.weights.gather(set, rays) * share,
            rays,
            kinds: [RayKind::Refraction; N_LANES],
            densities: [f32::INFINITY; N_LANES],
            distances: self.points.distances(at),
            media: None,
        };
        let lanes = lanes & self.worth(rays, share.to_array());
        self.next.bounce(set, &passing, self.wave, lanes);
    }

    /// Collects the reflected and the refracted rays of these lanes, at the surface of a medium.
    #[inline(always)]
    fn split<I: InstructionSet>(
        &mut self,
        set: I,
        material: MaterialId,
        at: PointLanes,
        lanes: u8,
    ) {
        let point = self.points.shading(set, at);
        let direction = self.points.directions(set, at);
        let rays = self.points.rays(at);
        // Split the light by Fresnel's equations.
        let Interfaces {
            eta,
            visible,
            behind,
        } = Interfaces::met(self.scene, self.wave, material, rays, point.side.signs());
        let Split {
            reflectance,
            refracted,
        } = split_at(&point, direction, set.load(&eta), set.mask(visible));
        let mirrored = point.mirrored(direction);
        let refraction = set.splat(1.0) - reflectance;
        // Collect the two rays of each point, if they have enough weight.
        let before = self.wave.weights.gather(set, rays);
        for (kind, direction, factor, media) in [
            (RayKind::Reflection, mirrored, reflectance, None),
            (RayKind::Refraction, refracted, refraction, Some(&behind)),
        ] {
            let continued = Continued {
                origin: self.model.origin(&point, direction),
                direction,
                weight: before * factor,
                rays,
                kinds: [kind; N_LANES],
                densities: [f32::INFINITY; N_LANES],
                distances: self.points.distances(at),
                media,
            };
            let lanes = lanes & self.worth(rays, factor.to_array());
            self.next.bounce(set, &continued, self.wave, lanes);
        }
    }

    /// Returns the lanes whose rays still have enough weight after this factor.
    #[inline(always)]
    fn worth(&self, rays: &[u32; N_LANES], factors: [f32; N_LANES]) -> u8 {
        let mut lanes = 0;
        for (lane, (&ray, factor)) in rays.iter().zip(factors).enumerate() {
            let weight = self.wave.weights.get(ray as usize) * factor;
            lanes |= u8::from(is_worth_tracing(weight.into())) << lane;
        }
        lanes
    }
}

/// Adds the background to the paths whose rays hit nothing.
pub(super) struct AddBackground<'a> {
    pub(super) scene: &'a Scene,
    /// Indices of the rays that hit nothing.
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
            // Gather eight rays that hit nothing.
            let mut rays = [missed[0]; N_LANES];
            rays[..missed.len()].copy_from_slice(missed);
            let mut densities = [f32::INFINITY; N_LANES];
            if !self.wave.branches.is_empty() {
                densities = rays.map(|ray| self.wave.branches[ray as usize].density);
            }
            // Add the background that they see.
            let ray = self.wave.rays.gather(set, &rays);
            let radiance = weighted_background(self.scene, ray, set.load(&densities));
            let (slots, weights) =
                self.wave
                    .slots_and_weights(set, &rays, self.scene.splits_paths());
            let lanes = u8::MAX >> (N_LANES - missed.len());
            let added = self.wave.with_gained(set, &rays, radiance.times(weights));
            self.colors.add_to(set, &slots, added, lanes);
        }
    }
}
