//! The trait of shading models.

use glam::Vec3;

use super::bsdf::Boundary;
use crate::trace::ShadingPoint;
use math::simd::{Real, Vector};
use world::light::Illumination;
use world::material::Material;
use world::scene::Lights;

/// How paths continue from a point.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Bounce {
    /// They end.
    None,
    /// As reflected and refracted rays.
    Mirrored,
    /// In a direction chosen at random.
    Scattered,
}

/// A model of how surfaces reflect light. All formulas are for one point or for one point per lane,
/// all with the same material.
pub(super) trait Model: Copy {
    /// True if a shadow ray ignores the object that it leaves.
    const IGNORES_OWN_OBJECT: bool = false;
    /// True if a point that no light reaches is black and ends its path.
    const NEEDS_LIGHT: bool = false;
    /// How paths continue.
    const BOUNCE: Bounce;

    /// Returns true if light samples contribute to the light that surfaces of a material reflect.
    fn is_lit(self, material: &Material) -> bool {
        material.is_lit()
    }

    /// Returns the number of light samples at a point after this number of bounces, of at most
    /// `max_depth`.
    fn n_light_samples(self, lights: &Lights, _depth: u32, _max_depth: u32) -> usize {
        lights.n_samples()
    }

    /// Returns true if the light may arrive: if the surface itself is not in its way.
    fn may_arrive<R: Real>(
        self,
        material: &Material,
        point: &ShadingPoint<R>,
        light: &Illumination<R>,
    ) -> R::Mask;

    /// Returns the origin of a ray that leaves the point in this direction.
    #[inline(always)]
    fn origin<R: Real>(self, point: &ShadingPoint<R>, direction: Vector<R>) -> Vector<R> {
        point.origin(direction)
    }

    /// Returns the parameter at which a shadow ray ends: at its light.
    #[inline(always)]
    fn end<R: Real>(self, light: &Illumination<R>) -> R {
        light.distance
    }

    /// Returns the unit vector to the viewer: to the origin of a ray in `direction`, of a path from
    /// `eye`.
    #[inline(always)]
    fn to_viewer<R: Real>(
        self,
        _point: &ShadingPoint<R>,
        _eye: Vector<R>,
        direction: Vector<R>,
    ) -> Vector<R> {
        -direction
    }

    /// Returns the reflected ambient light: none.
    #[inline(always)]
    fn ambient<R: Real>(self, _material: &Material, _ambient: Vec3, color: Vector<R>) -> Vector<R> {
        Vector::splat(color.x, Vec3::ZERO)
    }

    /// Returns the light that the point reflects to the viewer. `boundary` matters only for media.
    fn reflected<R: Real>(
        self,
        material: &Material,
        boundary: &Boundary<R>,
        point: &ShadingPoint<R>,
        light: &Illumination<R>,
        to_viewer: Vector<R>,
    ) -> Vector<R>;
}
