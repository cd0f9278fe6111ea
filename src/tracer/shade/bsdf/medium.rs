//! The surfaces of clear media, smooth or rough.

use std::f32::consts::PI;

use glam::Vec3;

use super::{Boundary, Leaving, Scattered, Scattering, Scatters};
use crate::shade::fresnel::split_at;
use math::optics::{Split, split};
use math::simd::{Real, Vector};
use world::material::RoughSurface;

/// The surface of a clear medium. A path is reflected or refracted, with the probabilities of
/// Fresnel's equations.
#[derive(Debug, Clone, Copy)]
pub(in crate::shade) struct Medium<'a> {
    /// `None` for a smooth surface.
    rough: Option<&'a RoughSurface>,
}

/// Least difference of indices that bends light: below it, rounding errors hide the facet of two
/// directions, and the light goes straight on.
const LEAST_BEND: f32 = 1e-3;

impl<'a> Medium<'a> {
    pub(super) fn new(rough: Option<&'a RoughSurface>) -> Self {
        Self { rough }
    }
}

impl Scatters for Medium<'_> {
    fn is_lit(&self) -> bool {
        self.rough.is_some()
    }

    fn is_lit_from_all_sides(&self) -> bool {
        self.rough.is_some()
    }

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
        let reflected = reflection(rough, at, boundary, to_light);
        let refracted = refraction(rough, at, boundary, to_light);
        let cos = to_light.dot(at.point.normal);
        Scattering::select(cos.lt(cos.splat(0.0)), refracted, reflected)
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
                let split = split_at(&at.point, at.arriving, boundary.eta, boundary.is_visible);
                let mirrored = at.point.mirrored(at.arriving);
                choose(split, mirrored, boundary, lobe)
            }
            Some(rough) => by_facets(rough, at, boundary, numbers, lobe),
        }
    }
}

/// Reflects or refracts at one of the facets that the viewer sees.
#[inline(always)]
fn by_facets<R: Real>(
    rough: &RoughSurface,
    at: &Leaving<R>,
    boundary: &Boundary<R>,
    numbers: [R; 2],
    lobe: R,
) -> Scattered<R> {
    // Sample a facet that the viewer sees.
    let (zero, one) = (lobe.splat(0.0), lobe.splat(1.0));
    let Boundary { eta, is_visible } = *boundary;
    let to_viewer = at.in_surface(at.to_viewer);
    let normal = rough.facets(zero).facet(to_viewer, numbers);
    let facet = at.in_world(normal);
    // Split the light at this facet by Fresnel's equations.
    let Split {
        reflectance,
        refracted,
    } = split(-at.to_viewer, facet, eta);
    let split = Split {
        reflectance: R::select(is_visible, reflectance, zero),
        refracted: Vector::select(is_visible, refracted, at.arriving),
    };
    // Choose the reflected or the refracted ray.
    let mirrored = (-at.to_viewer).reflect(facet).normalize();
    let chosen = choose(split, mirrored, boundary, lobe);
    let reflected = at.reflected(mirrored, reflection(rough, at, boundary, mirrored));
    // Light that other facets hide, or that comes from the wrong side, is lost.
    let to_light = at.in_surface(chosen.direction);
    let visible = rough.facets(zero).visibility(to_viewer, to_light);
    let is_behind = chosen.direction.dot(at.point.normal).lt(zero);
    let passed = R::select(is_behind, visible / returned(rough, at, eta), zero);
    // The density of the refracted direction.
    let density = (one - reflectance)
        * rough
            .facets(zero)
            .refraction([to_viewer, to_light], normal, eta);
    let refracted = Scattered {
        factor: chosen.factor * R::select(is_visible, passed, one),
        density: R::select(bends(boundary), density, chosen.density),
        ..chosen
    };
    Scattered::select(chosen.is_refracted, refracted, reflected)
}

/// Returns the scattering by reflection from a direction in front of the surface.
#[inline(always)]
fn reflection<R: Real>(
    rough: &RoughSurface,
    at: &Leaving<R>,
    boundary: &Boundary<R>,
    to_light: Vector<R>,
) -> Scattering<R> {
    // The facet that mirrors the light to the viewer, and its reflectance.
    let facet = (at.to_viewer + to_light).normalize();
    let reflectance = split(-at.to_viewer, facet, boundary.eta).reflectance;
    let zero = reflectance.splat(0.0);
    let reflectance = R::select(boundary.is_visible, reflectance, zero);
    // The scattering of all facets, with the light they reflect onto each other.
    let (to_viewer, to_light) = (at.in_surface(at.to_viewer), at.in_surface(to_light));
    let facets = rough.facets(zero).reflection(to_viewer, to_light);
    let value = reflectance * facets.value / returned(rough, at, boundary.eta);
    Scattering {
        value: Vector::splat(zero, Vec3::ONE) * value,
        density: reflectance * facets.density,
    }
}

/// Returns the scattering by refraction from a direction behind the surface: Walter et al. 2007,
/// with the density of visible facets.
#[inline(always)]
fn refraction<R: Real>(
    rough: &RoughSurface,
    at: &Leaving<R>,
    boundary: &Boundary<R>,
    to_light: Vector<R>,
) -> Scattering<R> {
    let eta = boundary.eta;
    let (zero, one) = (eta.splat(0.0), eta.splat(1.0));
    // The facet that refracts the light to the viewer.
    let sum = at.to_viewer * eta + to_light;
    // Toward the medium of the smaller index.
    let facet = Vector::select(eta.lt(one), -sum, sum).normalize();
    // The density of the direction: the chance to meet the facet, times what it refracts.
    let reflectance = split(-at.to_viewer, facet, eta).reflectance;
    let (to_viewer, to_light) = (at.in_surface(at.to_viewer), at.in_surface(to_light));
    let normal = at.in_surface(facet);
    let is_refracted = bends(boundary) & zero.lt(normal.z);
    let density = (one - reflectance)
        * rough
            .facets(zero)
            .refraction([to_viewer, to_light], normal, eta);
    let density = R::select(is_refracted, density, zero);
    // The light that reaches the viewer, unless other facets hide it.
    let visible = rough.facets(zero).visibility(to_viewer, to_light);
    let share = eta * eta * visible / returned(rough, at, eta);
    Scattering {
        value: Vector::splat(zero, Vec3::splat(PI)) * (density * share),
        density,
    }
}

/// Returns true if facets bend refracted light.
#[inline(always)]
fn bends<R: Real>(Boundary { eta, is_visible }: &Boundary<R>) -> R::Mask {
    let difference = (*eta - eta.splat(1.0)).abs();
    *is_visible & eta.splat(LEAST_BEND).lt(difference)
}

/// Returns the share of light that facets return directly.
#[inline(always)]
fn returned<R: Real>(rough: &RoughSurface, at: &Leaving<R>, eta: R) -> R {
    let one = eta.splat(1.0);
    let Some(albedo) = &rough.of_medium else {
        return one;
    };
    let [outside, inside] = albedo.at(at.cos_of_viewer());
    R::select(eta.lt(one), outside, inside)
}

/// Returns the reflected or the refracted direction, chosen by the reflectance.
#[inline(always)]
fn choose<R: Real>(
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
        is_diffuse: zero.splat_mask(false),
    }
}
