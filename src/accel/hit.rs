//! What rays are asked for, and what they find.

use crate::geometry::Ray;
use crate::scene::ObjectId;

/// A ray's hit on a primitive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Parameter along the ray, greater than 0.
    pub t: f32,
    /// The primitive's index in the scene.
    pub primitive: u32,
}

/// A ray to be tested for occlusion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadowRay {
    /// The ray, whose direction is a unit vector.
    pub ray: Ray,
    /// Only hits with `t` in (0, `t_max`) count.
    pub t_max: f32,
    /// An object whose hits do not count.
    pub ignored: Option<ObjectId>,
}
