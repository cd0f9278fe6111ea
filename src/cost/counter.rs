//! The counters of a pixel.

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
