//! The state of a path of rays.

use glam::Vec3;

/// A path of rays from the camera. At each point, color += weight * radiance
/// and weight *= reflection.
#[derive(Debug, Clone, Copy)]
pub struct Path {
    /// The radiance so far, each channel at least 0, not limited to 1.
    pub color: Vec3,
    /// The number of bounces so far.
    pub depth: u32,
    /// The origin of the camera ray.
    pub(super) eye: Vec3,
    /// The share of the next point's radiance that reaches the camera.
    weight: f32,
}

impl Path {
    /// Creates a path whose camera ray starts at `eye`.
    pub fn from_eye(eye: Vec3) -> Self {
        Self {
            color: Vec3::ZERO,
            depth: 0,
            eye,
            weight: 1.0,
        }
    }

    /// Adds the radiance of a point.
    pub(super) fn add(&mut self, light: Vec3) {
        self.color += self.weight * light;
    }

    /// Continues with a reflected ray, weighted by `reflection`.
    pub(super) fn bounce(&mut self, reflection: f32) {
        self.depth += 1;
        self.weight *= reflection;
    }
}
