//! The standard model: Blinn-Phong with shadows and reflected rays.
//!
//! Whitted, "An Improved Illumination Model for Shaded Display", CACM 23(6), 1980. V points to the
//! origin of the ray, shadow rays end at their lights, and a point in shadow keeps its ambient
//! light.

use glam::Vec3;

use super::blinn_phong::{Reflected, reflected};
use super::bsdf::Boundary;
use super::model::{Bounce, Model};
use crate::trace::ShadingPoint;
use math::simd::{Real, Vector};
use world::light::Illumination;
use world::material::Material;

/// The standard model; see the module's documentation.
#[derive(Clone, Copy)]
pub(super) struct Standard;

impl Model for Standard {
    const BOUNCE: Bounce = Bounce::Mirrored;

    /// Rejects light from behind the surface, and from a light that is off.
    #[inline(always)]
    fn may_arrive<R: Real>(
        self,
        _: &Material,
        point: &ShadingPoint<R>,
        light: &Illumination<R>,
    ) -> R::Mask {
        let Vector { x, y, z } = light.radiance;
        let zero = x.splat(0.0);
        let is_off = x.equals(zero) & y.equals(zero) & z.equals(zero);
        point.is_faced_by(light.direction) & !is_off
    }

    #[inline(always)]
    fn ambient<R: Real>(self, material: &Material, ambient: Vec3, color: Vector<R>) -> Vector<R> {
        Vector::splat(color.x, material.ambient * ambient).times(color)
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
        let Reflected { diffuse, highlight } =
            reflected(material, point.color, point.normal, light, to_viewer);
        diffuse.plus(highlight).times(light.radiance)
    }
}
