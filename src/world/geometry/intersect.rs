//! The traits of shapes.

use super::{Aabb, N_PARAMETERS, Patch, Project, Ray, Transform};
use math::simd::{Real, Vector};

/// A shape that rays can hit.
pub trait Intersectable: Sized {
    /// Returns the least `t` in (0, `t_max`) at which the ray hits the shape, from either side. The
    /// ray's direction may have any length.
    fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32>;

    /// Returns the smallest box around the shape; [`Aabb::ALL`] if it has no bounds.
    fn bounds(&self) -> Aabb;

    /// Returns the image under the transform, if it is a shape of the same kind.
    fn transformed(&self, transform: &Transform) -> Option<Self>;

    /// Returns the cell that a viewer draws for the shape; `None` if it has no bounds.
    fn patch(&self) -> Option<Patch>;
}

/// A shape that one formula in single precision tests, for a ray or for a ray per lane.
pub trait RayTest: Project {
    /// Returns the parameter at which a ray hits a shape with these parameters; not a positive
    /// number for a miss.
    fn hits<R: Real>(parameters: &[R; N_PARAMETERS], origin: Vector<R>, direction: Vector<R>) -> R;

    /// Returns the hit of one ray in (0, `t_max`).
    #[inline(always)]
    fn first_hit(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        let t = Self::hits(&self.parameters(), ray.origin.into(), ray.direction.into());
        (t > 0.0 && t < t_max).then_some(t)
    }
}
