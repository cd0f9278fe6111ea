//! The light that arrives at points.

use math::simd::Vector;

/// The greatest radiance of a light: products with what highlights reflect stay finite.
pub(super) const MAX_RADIANCE: f32 = 1e20;

/// The light that arrives at a point, or at one point per lane, from one light,
/// unless it is occluded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Illumination<R> {
    /// From the point to the light, a unit vector.
    pub direction: Vector<R>,
    /// Distance to the light; infinite for a directional one.
    pub distance: R,
    /// The radiance that arrives, each channel at least 0: that of a white diffuse
    /// surface which faces the light.
    pub radiance: Vector<R>,
    /// The density with which the direction was chosen, per steradian; infinite for a
    /// light that has one direction from each point.
    pub density: R,
}
