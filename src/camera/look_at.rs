//! The perspective camera that looks from one point to another.

use glam::Vec3;
use serde::Deserialize;

use super::basis::{Basis, up};
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
#[serde(try_from = "LookAtKeys")]
pub struct LookAt {
    eye: Vec3,
    basis: Basis,
    fov_y_deg: f32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LookAtKeys {
    #[serde(deserialize_with = "yaml::point")]
    eye: Vec3,
    #[serde(deserialize_with = "yaml::point")]
    target: Vec3,
    #[serde(deserialize_with = "yaml::direction", default = "up")]
    up: Vec3,
    #[serde(deserialize_with = "fov_deg")]
    fov_y_deg: f32,
}

fn fov_deg<'de, D: serde::Deserializer<'de>>(d: D) -> Result<f32, D::Error> {
    let number = Number {
        expected: "an angle in degrees from 0.001 to 179.9",
        accepts: |deg| (0.001..=179.9).contains(&deg),
    };
    serde::de::DeserializeSeed::deserialize(number, d)
}

impl TryFrom<LookAtKeys> for LookAt {
    type Error = &'static str;

    fn try_from(keys: LookAtKeys) -> Result<Self, Self::Error> {
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
    fn the_field_of_view_spans_the_rows_from_edge_to_edge() {
        let keys = LookAtKeys {
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
