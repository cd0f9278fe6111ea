//! The model of the course's NumPy code, kept for comparison with it.
//!
//! It differs from the standard model: only the highlight has the light's color, and only the
//! diffuse light has the surface's color; normals are not flipped toward the ray; V points to the
//! camera even after a bounce; a shadow ray ignores the object that it leaves and does not end at
//! its light; a point that no light reaches is black, without ambient light, and ends the path; new
//! rays start 1e-4 off the surface, along its normal.

use glam::Vec3;

use super::blinn_phong::{Reflected, reflected};
use super::bsdf::Boundary;
use super::model::{Bounce, Model};
use crate::trace::ShadingPoint;
use math::simd::{Real, Vector};
use world::light::Illumination;
use world::material::Material;

/// Distance of the origin of new rays from the surface, in world units.
const OFFSET: f32 = 1e-4;

/// The model of the course; see the module's documentation.
#[derive(Clone, Copy)]
pub(super) struct Seed;

impl Model for Seed {
    const IGNORES_OWN_OBJECT: bool = true;
    const NEEDS_LIGHT: bool = true;
    const BOUNCE: Bounce = Bounce::Mirrored;

    #[inline(always)]
    fn may_arrive<R: Real>(
        self,
        _: &Material,
        point: &ShadingPoint<R>,
        _: &Illumination<R>,
    ) -> R::Mask {
        point.side.le(point.side)
    }

    #[inline(always)]
    fn origin<R: Real>(self, point: &ShadingPoint<R>, _: Vector<R>) -> Vector<R> {
        point.position + point.outward(point.geometric_normal) * point.side.splat(OFFSET)
    }

    #[inline(always)]
    fn end<R: Real>(self, light: &Illumination<R>) -> R {
        light.distance.splat(f32::INFINITY)
    }

    #[inline(always)]
    fn to_viewer<R: Real>(
        self,
        point: &ShadingPoint<R>,
        eye: Vector<R>,
        _: Vector<R>,
    ) -> Vector<R> {
        let none = Vector::splat(point.side, Vec3::ZERO);
        (eye - point.position).normalize_or(none)
    }

    #[inline(always)]
    fn ambient<R: Real>(self, material: &Material, ambient: Vec3, color: Vector<R>) -> Vector<R> {
        Vector::splat(color.x, material.ambient * ambient)
    }

    #[inline(always)]
    fn reflected<R: Real>(
        self,
        material: &Material,
        _: &Boundary<R>,
        point: &ShadingPoint<R>,
        light: &Illumination<R>,
        to_viewer: Vector<R>,
    ) -> Vector<R> {
        let normal = point.outward(point.normal);
        let Reflected { diffuse, highlight } =
            reflected(material, point.color, normal, light, to_viewer);
        diffuse + light.radiance * highlight
    }
}
