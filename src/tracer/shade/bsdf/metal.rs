//! Metals, smooth or rough.

use glam::Vec3;

use super::{Boundary, Leaving, Scattered, Scattering, Scatters};
use math::optics::reflectance_of_metal;
use math::simd::{Real, Vector};
use world::material::{Conductor, RoughSurface};

/// The surface of a metal.
#[derive(Debug, Clone, Copy)]
pub(in crate::shade) struct Metal<'a> {
    conductor: Conductor,
    /// `None` for a mirror.
    rough: Option<&'a RoughSurface>,
    /// The reflectance of light along the normal.
    color: Vec3,
}

impl<'a> Metal<'a> {
    pub(super) fn new(conductor: &Conductor, rough: Option<&'a RoughSurface>) -> Self {
        Self {
            conductor: *conductor,
            rough,
            color: reflectance(conductor, 1.0).into(),
        }
    }
}

impl Scatters for Metal<'_> {
    fn is_lit(&self) -> bool {
        self.rough.is_some()
    }

    #[inline(always)]
    fn evaluate<R: Real>(
        &self,
        at: &Leaving<R>,
        _: &Boundary<R>,
        to_light: Vector<R>,
    ) -> Scattering<R> {
        let Some(rough) = self.rough else {
            return Scattering::none(to_light.x);
        };
        // Microfacets reflect the light once.
        let to_viewer = at.in_surface(at.to_viewer);
        let reflection = rough
            .facets(to_viewer.z)
            .reflection(to_viewer, at.in_surface(to_light));
        // They reflect the rest onto each other.
        let color = Vector::splat(to_light.x, self.color);
        let gain = at.gain(rough.of_mirror.as_ref(), color);
        let once = reflectance(&self.conductor, reflection.cos) * reflection.value;
        Scattering {
            value: once.times(gain),
            density: reflection.density,
        }
    }

    #[inline(always)]
    fn sample<R: Real>(
        &self,
        at: &Leaving<R>,
        boundary: &Boundary<R>,
        numbers: [R; 2],
        _: R,
    ) -> Scattered<R> {
        let Some(rough) = self.rough else {
            let zero = at.to_viewer.x.splat(0.0);
            return Scattered {
                direction: at.point.mirrored(at.arriving),
                factor: reflectance(&self.conductor, at.cos_of_viewer()),
                density: zero.splat(f32::INFINITY),
                is_refracted: zero.splat_mask(false),
                is_diffuse: zero.splat_mask(false),
            };
        };
        let direction = at.mirrored_by(rough.facets(numbers[0]), numbers);
        at.reflected(direction, self.evaluate(at, boundary, direction))
    }
}

/// Returns the reflectance by the cosine of the angle of incidence.
#[inline(always)]
fn reflectance<R: Real>(conductor: &Conductor, cos: R) -> Vector<R> {
    reflectance_of_metal(conductor.index, conductor.extinction, cos)
}
