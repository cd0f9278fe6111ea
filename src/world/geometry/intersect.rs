//! The trait of all shapes.

use super::{Aabb, Patch, Ray, Transform};

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
