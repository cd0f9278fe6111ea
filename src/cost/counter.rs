//! What is counted, apart from camera rays.

/// A number that is counted for each pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Counter {
    /// BVH nodes entered.
    NodeVisits,
    /// Ray-primitive tests.
    PrimitiveTests,
    /// Rays toward lights.
    ShadowRays,
    /// Rays mirrored off surfaces.
    ReflectionRays,
    /// Rays through surfaces.
    RefractionRays,
    /// The longest path in bounces.
    Depth,
}

impl Counter {
    /// All, in their order.
    pub const ALL: [Self; 6] = [
        Self::NodeVisits,
        Self::PrimitiveTests,
        Self::ShadowRays,
        Self::ReflectionRays,
        Self::RefractionRays,
        Self::Depth,
    ];
}
