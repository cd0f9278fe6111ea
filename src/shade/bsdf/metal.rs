//! Metals, smooth or rough.

use super::ggx::Ggx;
use super::{Boundary, Leaving, Scattered, Scattering, Scatters};
use crate::material::Conductor;
use crate::shade::fresnel;
use crate::simd::{Real, Vector};

/// The surface of a metal.
#[derive(Debug, Clone, Copy)]
pub(in crate::shade) struct Metal {
    conductor: Conductor,
    /// `None` for a mirror.
    facets: Option<Ggx>,
}

impl Metal {
    pub(super) fn new(conductor: &Conductor, roughness: f32) -> Self {
        Self {
            conductor: *conductor,
            facets: Ggx::of_roughness(roughness),
        }
    }
}

impl Scatters for Metal {
    fn is_lit(&self) -> bool {
        self.facets.is_some()
    }

    #[inline(always)]
    fn evaluate<R: Real>(&self, at: &Leaving<R>, to_light: Vector<R>) -> Scattering<R> {
        let Some(facets) = self.facets else {
            return Scattering::none(to_light.x);
        };
        let to_viewer = at.in_surface(at.to_viewer);
        let reflection = facets.reflection(to_viewer, at.in_surface(to_light));
        Scattering {
            value: fresnel::metal(&self.conductor, reflection.cos) * reflection.value,
            density: reflection.density,
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
        let Some(facets) = self.facets else {
            let zero = at.to_viewer.x.splat(0.0);
            let cos = at.to_viewer.dot(at.point.normal);
            let cos = cos.max(zero).min(zero.splat(1.0));
            return Scattered {
                direction: at.point.mirrored(-at.to_viewer),
                factor: fresnel::metal(&self.conductor, cos),
                density: zero.splat(f32::INFINITY),
                is_refracted: zero.lt(zero),
                is_diffuse: zero.lt(zero),
            };
        };
        let direction = at.mirrored_by(facets, numbers);
        at.reflected(direction, self.evaluate(at, direction))
    }
}
