//! The surfaces of clear media, smooth or rough.

use super::ggx::Ggx;
use super::{Boundary, Leaving, Scattered, Scattering, Scatters};
use crate::shade::fresnel::{Split, split_at};
use crate::simd::{Real, Vector};
use crate::trace::ShadingPoint;

/// The surface of a clear medium. A path is reflected or refracted, with the
/// probabilities of Fresnel's equations.
#[derive(Debug, Clone, Copy)]
pub(in crate::shade) struct Medium {
    /// `None` for a smooth surface.
    facets: Option<Ggx>,
}

impl Medium {
    pub(super) fn new(roughness: f32) -> Self {
        Self {
            facets: Ggx::of_roughness(roughness),
        }
    }
}

impl Scatters for Medium {
    fn is_lit(&self) -> bool {
        false
    }

    #[inline(always)]
    fn evaluate<R: Real>(&self, _: &Leaving<R>, to_light: Vector<R>) -> Scattering<R> {
        Scattering::none(to_light.x)
    }

    #[inline(always)]
    fn sample<R: Real>(
        &self,
        at: &Leaving<R>,
        boundary: &Boundary<R>,
        numbers: [R; 2],
        lobe: R,
    ) -> Scattered<R> {
        let (zero, one) = (lobe.splat(0.0), lobe.splat(1.0));
        let Some(facets) = self.facets else {
            return scattered(&at.point, at.to_viewer, boundary, lobe);
        };
        let to_viewer = at.in_surface(at.to_viewer);
        let facet = at.in_world(facets.facet(to_viewer, numbers));
        let on_facet = ShadingPoint {
            normal: facet,
            ..at.point
        };
        let scattered = scattered(&on_facet, at.to_viewer, boundary, lobe);
        // Light that other facets hide, or that comes from the wrong side, is lost.
        let to_light = at.in_surface(scattered.direction);
        let side = to_light
            .z
            .flip_sign_by(R::select(scattered.is_refracted, -one, one));
        let visible = facets.visibility(to_viewer, to_light);
        let visible = R::select(zero.lt(side), visible, zero);
        let visible = R::select(boundary.is_visible, visible, one);
        Scattered {
            factor: scattered.factor * visible,
            ..scattered
        }
    }
}

/// Reflects or refracts at a point.
#[inline(always)]
fn scattered<R: Real>(
    point: &ShadingPoint<R>,
    to_viewer: Vector<R>,
    Boundary { eta, is_visible }: &Boundary<R>,
    lobe: R,
) -> Scattered<R> {
    let (zero, one) = (lobe.splat(0.0), lobe.splat(1.0));
    let Split {
        reflectance,
        refracted,
    } = split_at(point, -to_viewer, *eta, *is_visible);
    let is_refracted = reflectance.le(lobe);
    // A narrower cone behind the surface carries the light of a wider one before it.
    let spread = R::select(*is_visible, *eta * *eta, one);
    let factor = R::select(is_refracted, spread, one);
    Scattered {
        direction: Vector::select(is_refracted, refracted, point.mirrored(-to_viewer)),
        factor: Vector {
            x: factor,
            y: factor,
            z: factor,
        },
        density: zero.splat(f32::INFINITY),
        is_refracted,
        is_diffuse: zero.lt(zero),
    }
}
