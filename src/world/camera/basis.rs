//! The orientation of a camera.

use glam::{DVec3, Vec3};

/// The directions of a camera: orthonormal vectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Basis {
    pub(super) forward: Vec3,
    pub(super) right: Vec3,
    pub(super) up: Vec3,
}

impl Basis {
    /// Returns the basis of a camera that looks from `eye` to `target`, with `up` pointing upward
    /// in the image.
    ///
    /// # Errors
    /// The three do not define an orientation.
    pub(super) fn look_at(eye: DVec3, target: DVec3, up: Vec3) -> Result<Self, &'static str> {
        let forward = (target - eye)
            .try_normalize()
            .ok_or("cannot have its eye in its target, expected two different points")?
            .as_vec3();
        // Right-handed, as in ParaView: looking toward -z, x points to the right.
        let right = forward.cross(up);
        if right.length_squared() < 1e-12 {
            return Err(
                "cannot have its `up` along the line from `eye` to `target`, \
                 expected an `up` at an angle to it",
            );
        }
        let right = right.normalize();
        Ok(Self {
            forward,
            right,
            up: right.cross(forward),
        })
    }
}

/// Returns the default `up` of a camera.
pub(super) fn up() -> Vec3 {
    Vec3::Y
}
