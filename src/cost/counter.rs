//! The counters of a pixel.

use super::RayKind;

/// A counter of each pixel. Camera rays have none: each sample has one ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Counter {
    /// BVH nodes visited.
    NodeVisits,
    /// Ray-primitive tests.
    PrimitiveTests,
    /// Rays toward lights.
    ShadowRays,
    /// Reflected rays.
    ReflectionRays,
    /// Refracted rays.
    RefractionRays,
    /// Bounces of the longest path.
    Depth,
}

impl Counter {
    /// Returns the counter of rays of one kind; `None` for camera rays.
    #[inline]
    pub fn of_rays(kind: RayKind) -> Option<Self> {
        match kind {
            RayKind::Camera => None,
            RayKind::Shadow => Some(Self::ShadowRays),
            RayKind::Reflection => Some(Self::ReflectionRays),
            RayKind::Refraction => Some(Self::RefractionRays),
        }
    }

    /// All counters, in the order of declaration.
    pub const ALL: [Self; 6] = [
        Self::NodeVisits,
        Self::PrimitiveTests,
        Self::ShadowRays,
        Self::ReflectionRays,
        Self::RefractionRays,
        Self::Depth,
    ];
}
