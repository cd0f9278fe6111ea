//! Particles of fog.

use super::{Boundary, Leaving, Scattered, Scattering, Scatters};
use math::simd::{Real, Vector};
use world::fog::HenyeyGreenstein;

/// A particle that scatters light by a phase function. The color of the point is its albedo.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Particle {
    pub(super) phase: HenyeyGreenstein,
}

impl Scatters for Particle {
    fn is_lit(&self) -> bool {
        true
    }

    fn is_lit_from_all_sides(&self) -> bool {
        true
    }

    #[inline(always)]
    fn evaluate<R: Real>(
        &self,
        at: &Leaving<R>,
        _: &Boundary<R>,
        to_light: Vector<R>,
    ) -> Scattering<R> {
        let density = self.phase.density(-at.to_viewer.dot(to_light));
        Scattering {
            value: at.point.color * (density * density.splat(std::f32::consts::PI)),
            density,
        }
    }

    #[inline(always)]
    fn sample<R: Real>(
        &self,
        at: &Leaving<R>,
        _: &Boundary<R>,
        numbers: [R; 2],
        _: R,
    ) -> Scattered<R> {
        let (direction, cos) = self.phase.sample(-at.to_viewer, numbers);
        Scattered {
            direction,
            factor: at.point.color,
            density: self.phase.density(cos),
            is_refracted: cos.splat_mask(false),
            is_diffuse: cos.splat_mask(true),
        }
    }
}
