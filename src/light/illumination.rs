//! The light that arrives at a point.

use glam::Vec3;

/// The light that arrives at a point from one light, unless it is occluded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Illumination {
    /// From the point to the light, a unit vector.
    pub direction: Vec3,
    /// Distance to the light; infinite for a directional one.
    pub distance: f32,
    /// The radiance that arrives, each channel at least 0.
    pub radiance: Vec3,
}
