//! The camera that looks from one point to another.

use glam::Vec3;
use serde::Deserialize;

use super::image_plane::{ImagePlane, Projection};
use crate::yaml::{self, Number};

/// A perspective camera.
///
/// ```
/// # use raycost::camera::Camera;
/// let camera: Camera = raycost::yaml::from_str("
/// look_at: { eye: [0, 1, -5], target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 40 }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "Keys")]
pub struct LookAt {
    eye: Vec3,
    basis: Basis,
    fov_y_deg: f32,
}

/// The directions of a camera, unit vectors at right angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Basis {
    pub(super) forward: Vec3,
    pub(super) right: Vec3,
    pub(super) up: Vec3,
}

impl Basis {
    /// Looking from `eye` to `target`, `up` upwards in the picture; `Err` says
    /// what is wrong with the three.
    pub(super) fn look_at(eye: Vec3, target: Vec3, up: Vec3) -> Result<Self, &'static str> {
        let forward = (target - eye)
            .try_normalize()
            .ok_or("cannot have its eye in its target, expected two different points")?;
        // Right-handed, as in ParaView: seen toward -z, x points to the right.
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

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    #[serde(deserialize_with = "yaml::point")]
    eye: Vec3,
    #[serde(deserialize_with = "yaml::point")]
    target: Vec3,
    #[serde(deserialize_with = "yaml::direction", default = "up")]
    up: Vec3,
    #[serde(deserialize_with = "fov_deg")]
    fov_y_deg: f32,
}

/// The `up` of a camera whose file names none.
pub(super) fn up() -> Vec3 {
    Vec3::Y
}

fn fov_deg<'de, D: serde::Deserializer<'de>>(d: D) -> Result<f32, D::Error> {
    let number = Number {
        expected: "an angle in degrees from 0.001 to 179.9",
        accepts: |deg| (0.001..=179.9).contains(&deg),
    };
    serde::de::DeserializeSeed::deserialize(number, d)
}

impl TryFrom<Keys> for LookAt {
    type Error = &'static str;

    fn try_from(keys: Keys) -> Result<Self, Self::Error> {
        Ok(Self {
            eye: keys.eye,
            basis: Basis::look_at(keys.eye, keys.target, keys.up)?,
            fov_y_deg: keys.fov_y_deg,
        })
    }
}

impl LookAt {
    pub(super) fn image_plane(&self, width: u32, height: u32) -> ImagePlane {
        let Basis { forward, right, up } = self.basis;
        let half_height = libm::tanf(0.5 * self.fov_y_deg.to_radians());
        ImagePlane::centered(
            Projection::Perspective { eye: self.eye },
            [self.eye + forward, right, up],
            2.0 * half_height,
            [width, height],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_field_of_view_spans_the_rows_edge_to_edge() {
        let keys = Keys {
            eye: Vec3::ZERO,
            target: -Vec3::Z,
            up: Vec3::Y,
            fov_y_deg: 90.0,
        };
        let plane = LookAt::try_from(keys).unwrap().image_plane(200, 100);
        let top = plane.point(99.5, -0.5);
        assert!((top - Vec3::new(0.0, 1.0, -1.0)).length() < 1e-5, "{top}");
        let right = plane.point(199.5, 49.5);
        assert!(
            (right - Vec3::new(2.0, 0.0, -1.0)).length() < 1e-5,
            "{right}"
        );
    }
}
