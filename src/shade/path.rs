//! What a path of rays carries from point to point.

use glam::Vec3;

/// A path of rays from the camera: colour += weight * light of a point, weight
/// *= reflection.
#[derive(Debug, Clone, Copy)]
pub struct Path {
    /// The light so far, each channel at least 0, not limited to 1.
    pub color: Vec3,
    /// Bounces so far.
    pub depth: u32,
    /// Where the camera ray started.
    pub(super) eye: Vec3,
    /// Share of the next point's light that comes to the camera.
    weight: f32,
}

impl Path {
    /// A path whose camera ray starts at `eye`.
    pub fn from_eye(eye: Vec3) -> Self {
        Self {
            color: Vec3::ZERO,
            depth: 0,
            eye,
            weight: 1.0,
        }
    }

    /// Adds the light of a point.
    pub(super) fn add(&mut self, light: Vec3) {
        self.color += self.weight * light;
    }

    /// Goes on with a mirrored ray that brings this share of its light.
    pub(super) fn bounce(&mut self, reflection: f32) {
        self.depth += 1;
        self.weight *= reflection;
    }
}
