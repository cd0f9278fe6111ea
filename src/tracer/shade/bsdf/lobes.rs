//! Diffuse reflection, a highlight and a mirror: the keys of Blinn-Phong materials.

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;

use super::{Boundary, Leaving, Scattered, Scattering, Scatters};
use math::sampling::hemisphere;
use math::simd::{Real, Vector};
use world::material::{Material, RoughSurface};

/// Division of the light at a surface: fractions, with a sum of at most 1.
#[derive(Debug, Clone, Copy)]
pub(in crate::shade) struct Lobes<'a> {
    /// Fraction of the color, reflected in all directions.
    diffuse: f32,
    /// Fraction reflected by rough facets, if there are any.
    glossy: f32,
    rough: Option<&'a RoughSurface>,
    /// Fraction reflected as by a mirror.
    mirror: f32,
    /// The probability of choosing each of them.
    choice: Choice,
}

#[derive(Debug, Clone, Copy)]
struct Choice {
    diffuse: f32,
    glossy: f32,
    mirror: f32,
}

impl<'a> Lobes<'a> {
    /// Reads the fractions `diffuse` and `specular`, and takes the fraction of the mirror; all are scaled down where they
    /// sum to more than 1.
    pub(super) fn new(material: &'a Material, reflection: f32) -> Self {
        let sum = material.diffuse + material.specular + reflection;
        let scale = 1.0 / sum.max(1.0);
        let chosen = 1.0 / sum.max(f32::MIN_POSITIVE);
        Self {
            diffuse: scale * material.diffuse,
            glossy: scale * material.specular,
            rough: material.rough.as_deref(),
            mirror: scale * reflection,
            choice: Choice {
                diffuse: chosen * material.diffuse,
                glossy: chosen * material.specular,
                mirror: chosen * reflection,
            },
        }
    }
}

impl Scatters for Lobes<'_> {
    fn is_lit(&self) -> bool {
        self.diffuse > 0.0 || self.glossy > 0.0
    }

    #[inline(always)]
    fn evaluate<R: Real>(
        &self,
        at: &Leaving<R>,
        _: &Boundary<R>,
        to_light: Vector<R>,
    ) -> Scattering<R> {
        // The diffuse lobe: Lambert's cosine law.
        let zero = to_light.x.splat(0.0);
        let cos = to_light.dot(at.point.normal).max(zero);
        let diffuse = Scattering {
            value: at.point.color * (zero.splat(self.diffuse) * cos),
            density: zero.splat(self.choice.diffuse * FRAC_1_PI) * cos,
        };
        let Some(rough) = self.rough else {
            return diffuse;
        };
        // The glossy lobe: microfacets, and the light they reflect onto each other.
        let to_viewer = at.in_surface(at.to_viewer);
        let facets = rough
            .facets(zero)
            .reflection(to_viewer, at.in_surface(to_light));
        let white = Vector::splat(zero, Vec3::ONE);
        let gain = at.gain(rough.of_mirror.as_ref(), white);
        diffuse.with(Scattering {
            value: gain * (zero.splat(self.glossy) * facets.value),
            density: zero.splat(self.choice.glossy) * facets.density,
        })
    }

    #[inline(always)]
    fn sample<R: Real>(
        &self,
        at: &Leaving<R>,
        boundary: &Boundary<R>,
        numbers: [R; 2],
        lobe: R,
    ) -> Scattered<R> {
        let zero = lobe.splat(0.0);
        // Choose a lobe by its share.
        let is_mirror = lobe.lt(zero.splat(self.choice.mirror));
        let is_glossy = lobe.lt(zero.splat(self.choice.mirror + self.choice.glossy));
        // Sample a direction of the diffuse or the glossy lobe.
        let [x, y, z] = hemisphere(numbers);
        let mut direction = at.in_world(Vector { x, y, z });
        if let Some(rough) = self.rough {
            let reflected = at.mirrored_by(rough.facets(zero), numbers);
            direction = Vector::select(is_glossy, reflected, direction);
        }
        let scattered = Scattered {
            is_diffuse: !is_glossy,
            ..at.reflected(direction, self.evaluate(at, boundary, direction))
        };
        if self.mirror == 0.0 {
            return scattered;
        }
        // Replace the direction in lanes that chose the mirror.
        let share = Vec3::splat(self.mirror / self.choice.mirror);
        Scattered {
            direction: Vector::select(
                is_mirror,
                at.point.mirrored(at.arriving),
                scattered.direction,
            ),
            factor: Vector::select(is_mirror, Vector::splat(zero, share), scattered.factor),
            density: R::select(is_mirror, zero.splat(f32::INFINITY), scattered.density),
            ..scattered
        }
    }
}
