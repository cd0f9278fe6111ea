//! The surfaces of clear media, smooth or rough.

use glam::Vec3;

use super::{Boundary, Leaving, Scattered, Scattering, Scatters};
use crate::material::RoughSurface;
use crate::optics::{Split, split};
use crate::shade::fresnel::split_at;
use crate::simd::{Real, Vector};

/// The surface of a clear medium. A path is reflected or refracted, with the
/// probabilities of Fresnel's equations.
#[derive(Debug, Clone, Copy)]
pub(in crate::shade) struct Medium<'a> {
    /// `None` for a smooth surface.
    rough: Option<&'a RoughSurface>,
}

impl<'a> Medium<'a> {
    pub(super) fn new(rough: Option<&'a RoughSurface>) -> Self {
        Self { rough }
    }
}

impl Scatters for Medium<'_> {
    fn is_lit(&self) -> bool {
        self.rough.is_some()
    }

    /// Of reflection; light samples do not contribute to what is refracted.
    #[inline(always)]
    fn evaluate<R: Real>(
        &self,
        at: &Leaving<R>,
        boundary: &Boundary<R>,
        to_light: Vector<R>,
    ) -> Scattering<R> {
        let Some(rough) = self.rough else {
            return Scattering::none(to_light.x);
        };
        let facet = (at.to_viewer + to_light).normalize();
        let reflectance = split(-at.to_viewer, facet, boundary.eta).reflectance;
        let zero = reflectance.splat(0.0);
        let reflectance = R::select(boundary.is_visible, reflectance, zero);
        let [to_viewer, to_light] = [at.to_viewer, to_light].map(|to| at.in_surface(to));
        let facets = rough.facets.reflection(to_viewer, to_light);
        let value = reflectance * facets.value / returned(rough, at, boundary.eta);
        Scattering {
            value: Vector::splat(zero, Vec3::ONE) * value,
            density: reflectance * facets.density,
        }
    }

    #[inline(always)]
    fn sample<R: Real>(
        &self,
        at: &Leaving<R>,
        boundary: &Boundary<R>,
        numbers: [R; 2],
        lobe: R,
    ) -> Scattered<R> {
        match self.rough {
            None => {
                let split = split_at(&at.point, -at.to_viewer, boundary.eta, boundary.is_visible);
                let mirrored = at.point.mirrored(-at.to_viewer);
                chosen(split, mirrored, boundary, lobe)
            }
            Some(rough) => self.by_facets(rough, at, boundary, numbers, lobe),
        }
    }
}

impl Medium<'_> {
    /// Reflects or refracts at one of the facets that the viewer sees.
    #[inline(always)]
    fn by_facets<R: Real>(
        &self,
        rough: &RoughSurface,
        at: &Leaving<R>,
        boundary: &Boundary<R>,
        numbers: [R; 2],
        lobe: R,
    ) -> Scattered<R> {
        let (zero, one) = (lobe.splat(0.0), lobe.splat(1.0));
        let Boundary { eta, is_visible } = *boundary;
        let to_viewer = at.in_surface(at.to_viewer);
        let facet = at.in_world(rough.facets.facet(to_viewer, numbers));
        let Split {
            reflectance,
            refracted,
        } = split(-at.to_viewer, facet, eta);
        let split = Split {
            reflectance: R::select(is_visible, reflectance, zero),
            refracted: Vector::select(is_visible, refracted, -at.to_viewer),
        };
        let mirrored = (-at.to_viewer).reflect(facet).normalize();
        let chosen = chosen(split, mirrored, boundary, lobe);
        let reflected = at.reflected(mirrored, self.evaluate(at, boundary, mirrored));
        // Light that other facets hide, or that comes from the wrong side, is lost.
        let to_light = at.in_surface(chosen.direction);
        let by_geometry = chosen.direction.dot(at.point.geometric_normal);
        let is_behind = to_light.z.lt(zero) & by_geometry.lt(zero);
        let visible = rough.facets.visibility(to_viewer, to_light);
        let passed = R::select(is_behind, visible / returned(rough, at, eta), zero);
        let refracted = Scattered {
            factor: chosen.factor * R::select(is_visible, passed, one),
            ..chosen
        };
        Scattered::select(chosen.is_refracted, refracted, reflected)
    }
}

/// The share of light that facets return at once.
#[inline(always)]
fn returned<R: Real>(rough: &RoughSurface, at: &Leaving<R>, eta: R) -> R {
    let one = eta.splat(1.0);
    let Some(albedo) = &rough.of_medium else {
        return one;
    };
    let [outside, inside] = albedo.at(at.cos_of_viewer());
    R::select(eta.lt(one), outside, inside)
}

/// The reflected or the refracted direction, chosen by the reflectance.
#[inline(always)]
fn chosen<R: Real>(
    Split {
        reflectance,
        refracted,
    }: Split<R>,
    mirrored: Vector<R>,
    Boundary { eta, is_visible }: &Boundary<R>,
    lobe: R,
) -> Scattered<R> {
    let (zero, one) = (lobe.splat(0.0), lobe.splat(1.0));
    let is_refracted = reflectance.le(lobe);
    // A narrower cone behind the surface carries the light of a wider one before it.
    let spread = R::select(*is_visible, *eta * *eta, one);
    let factor = R::select(is_refracted, spread, one);
    Scattered {
        direction: Vector::select(is_refracted, refracted, mirrored),
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
