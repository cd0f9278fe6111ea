//! The trait of shading models.

use glam::Vec3;

use super::bsdf::Boundary;
use crate::trace::ShadingPoint;
use math::simd::{Real, Vector};
use scene::light::Illumination;
use scene::material::Material;
use scene::world::Lights;

/// How paths go on from a point.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Bounce {
    /// Not at all.
    None,
    /// As reflected and refracted rays.
    Mirrored,
    /// In a direction chosen at random.
    Scattered,
}

/// A model of how surfaces reflect light. All formulas are for one point or for one
/// per lane, all of which have the same material.
pub(super) trait Model: Copy {
    /// Whether a shadow ray ignores the object that it leaves.
    const IGNORES_OWN_OBJECT: bool = false;
    /// Whether a point that no light reaches is black and ends its path.
    const NEEDS_LIGHT: bool = false;
    /// How paths go on.
    const BOUNCE: Bounce;

    /// Whether light samples contribute to what surfaces of a material reflect.
    fn is_lit(self, material: &Material) -> bool {
        material.is_lit()
    }

    /// Number of light samples at a point after this number of bounces, of at most
    /// `max_depth`.
    fn n_light_samples(self, lights: &Lights, _depth: u32, _max_depth: u32) -> usize {
        lights.n_samples()
    }

    /// Whether the light may arrive: not if the surface itself is in its way.
    fn may_arrive<R: Real>(
        self,
        material: &Material,
        point: &ShadingPoint<R>,
        light: &Illumination<R>,
    ) -> R::Mask;

    /// The origin of a ray that leaves the point in this direction.
    #[inline(always)]
    fn origin<R: Real>(self, point: &ShadingPoint<R>, direction: Vector<R>) -> Vector<R> {
        point.origin(direction)
    }

    /// The parameter at which a shadow ray ends: at its light.
    #[inline(always)]
    fn end<R: Real>(self, light: &Illumination<R>) -> R {
        light.distance
    }

    /// The unit vector to the viewer: of a path from `eye`, by a ray in `direction`, to
    /// whose origin it points.
    #[inline(always)]
    fn to_viewer<R: Real>(
        self,
        _point: &ShadingPoint<R>,
        _eye: Vector<R>,
        direction: Vector<R>,
    ) -> Vector<R> {
        -direction
    }

    /// The reflected ambient light: none.
    #[inline(always)]
    fn ambient<R: Real>(self, _material: &Material, _ambient: Vec3, color: Vector<R>) -> Vector<R> {
        Vector::splat(color.x, Vec3::ZERO)
    }

    /// The light that the point reflects to the viewer. `boundary` is that of a medium.
    fn reflected<R: Real>(
        self,
        material: &Material,
        boundary: &Boundary<R>,
        point: &ShadingPoint<R>,
        light: &Illumination<R>,
        to_viewer: Vector<R>,
    ) -> Vector<R>;
}
