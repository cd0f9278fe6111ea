//! The light that arrives at points.

use crate::geometry::leaving;
use math::simd::{Real, Vector};

/// Maximum radiance of a light, so that products with highlights stay finite.
pub(super) const MAX_RADIANCE: f32 = 1e20;

/// The light that arrives at a point, or at one point per lane, from one light,
/// unless it is occluded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Illumination<R> {
    /// From the point to the light, a unit vector.
    pub direction: Vector<R>,
    /// Distance to the light; infinite for a directional light.
    pub distance: R,
    /// The radiance of a white diffuse surface that faces the light, each channel at least 0.
    pub radiance: Vector<R>,
    /// The probability density of the direction, per steradian; infinite for a light with one
    /// direction from each point.
    pub density: R,
}

impl Illumination<f32> {
    /// Returns the light of which this share arrives, if any does.
    pub fn weakened_to(self, share: f32) -> Option<Self> {
        let radiance = self.radiance * share;
        (share > 0.0).then_some(Self { radiance, ..self })
    }
}

/// A point of a surface, or one per lane, that light arrives at.
#[derive(Debug, Clone, Copy)]
pub struct LitPoint<R> {
    /// The point.
    pub position: Vector<R>,
    /// The shading normal.
    pub normal: Vector<R>,
    /// The geometric normal.
    pub geometric_normal: Vector<R>,
    /// A bound of the distance of the position from the surface.
    pub error: R,
}

impl<R: Real> LitPoint<R> {
    /// Returns the origin of a ray in a direction that does not hit the surface again.
    #[inline(always)]
    pub fn origin(&self, direction: Vector<R>) -> Vector<R> {
        let normal = self.geometric_normal;
        leaving([self.position, normal], self.error, direction)
    }
}
