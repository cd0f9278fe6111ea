//! Fresnel reflection at mirrors, metals and clear media, for points of surfaces.

use glam::Vec3;

use crate::trace::ShadingPoint;
use math::optics::{Split, reflectance_of_metal, split};
use math::simd::{Real, Vector};
use world::material::{Material, MaterialKind};

/// Returns the share of light that a material mirrors, for a ray in `direction`.
#[inline(always)]
pub(super) fn mirrored_share<R: Real>(
    material: &Material,
    point: &ShadingPoint<R>,
    direction: Vector<R>,
) -> Vector<R> {
    let zero = direction.x.splat(0.0);
    let metal = match &material.kind {
        MaterialKind::Conductor { metal, .. } => metal,
        MaterialKind::Opaque { reflection } => {
            return Vector::splat(zero, Vec3::splat(*reflection));
        }
        _ => return Vector::splat(zero, Vec3::ZERO),
    };
    let cos = (-direction.dot(point.normal))
        .max(zero)
        .min(zero.splat(1.0));
    reflectance_of_metal(metal.index, metal.extinction, cos)
}

/// Splits a ray in `direction` at a point; where the surface is not visible, the ray goes straight
/// on. Uses the shading normal, unless the ray comes from behind it; a ray that it would refract
/// away from the surface is reflected.
#[inline(always)]
pub(super) fn split_at<R: Real>(
    point: &ShadingPoint<R>,
    direction: Vector<R>,
    eta: R,
    is_visible: R::Mask,
) -> Split<R> {
    let (zero, one) = (eta.splat(0.0), eta.splat(1.0));
    let is_faced = direction.dot(point.normal).lt(zero);
    let normal = Vector::select(is_faced, point.normal, point.geometric_normal);
    let Split {
        reflectance,
        refracted,
    } = split(direction, normal, eta);
    let enters = refracted.dot(point.geometric_normal).lt(zero);
    let reflectance = R::select(enters, reflectance, one);
    Split {
        reflectance: R::select(is_visible, reflectance, zero),
        refracted: Vector::select(is_visible, refracted, direction),
    }
}
