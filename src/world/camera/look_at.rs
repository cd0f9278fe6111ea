//! The perspective camera that looks from one point to another.

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::basis::{Basis, up};
use super::image_plane::{ImagePlane, Projection};
use super::lens::{FRAME_HEIGHT, Lens, LensKeys};
use crate::geometry::RenderSpace;
use crate::kinds;
use crate::values::{self, Number};

/// A perspective camera, a pinhole or with a lens.
///
/// ```
/// # use raycost_world::camera::Camera;
/// let camera: Camera = scene::yaml::from_str("
/// look_at: { eye: [0, 1, -5], target: [0, 0, 0], up: [0, 1, 0], fov_y_deg: 40 }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(try_from = "LookAtKeys", into = "LookAtKeys")]
pub struct LookAt {
    keys: LookAtKeys,
    basis: Basis,
    /// Half the height of view at distance 1.
    half_height: f32,
    lens: Option<Lens>,
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(transform = values::exactly_one("fov_y_deg focal_length_mm")))]
#[serde(deny_unknown_fields)]
struct LookAtKeys {
    /// The center of projection.
    #[serde(with = "values::Point")]
    eye: DVec3,
    /// The point in the middle of the picture.
    #[serde(with = "values::Point")]
    target: DVec3,
    /// The upward direction in the picture; +y if not given.
    #[serde(with = "values::Direction", default = "up")]
    up: Vec3,
    /// The angle of view from the bottom to the top of the picture, in degrees.
    #[serde(with = "Fov", default)]
    fov_y_deg: Option<f32>,
    /// Instead of the angle: the focal length in millimeters, for frames of 36 x 24 mm.
    #[serde(with = "FocalLength", default)]
    focal_length_mm: Option<f32>,
    /// A thin lens; a pinhole if not given.
    #[serde(default)]
    lens: Option<LensKeys>,
}

kinds! {
    Fov: f32 = Number { expected: "an angle in degrees from 0.001 to 179.9", ranges: &[[0.001, 179.9]] };
    FocalLength: f32 = Number {
        expected: "a focal length in millimeters from 1 to 10000",
        ranges: &[[1.0, 1e4]],
    };
}

impl TryFrom<LookAtKeys> for LookAt {
    type Error = &'static str;

    fn try_from(keys: LookAtKeys) -> Result<Self, Self::Error> {
        let half_height = match (keys.fov_y_deg, keys.focal_length_mm) {
            (Some(deg), None) => libm::tanf(0.5 * deg.to_radians()),
            (None, Some(mm)) => 0.5 * FRAME_HEIGHT / (1e-3 * mm),
            (Some(_), Some(_)) => {
                return Err("cannot have two angles of view, \
                     expected either `fov_y_deg` or `focal_length_mm`");
            }
            (None, None) => {
                return Err("needs an angle of view, expected `fov_y_deg` or `focal_length_mm`");
            }
        };
        let basis = Basis::look_at(keys.eye, keys.target, keys.up)?;
        let lens = match &keys.lens {
            Some(lens) => lens.placed([keys.eye, keys.target], basis, half_height)?,
            None => None,
        };
        Ok(Self {
            keys,
            basis,
            half_height,
            lens,
        })
    }
}

impl From<LookAt> for LookAtKeys {
    fn from(camera: LookAt) -> Self {
        camera.keys
    }
}

impl LookAt {
    /// Creates a pinhole camera with +y upward in the picture, and this angle of view from its bottom
    /// to its top in degrees, from 0.001 to 179.9. Points are in world space.
    ///
    /// # Errors
    /// Eye and target are the same point, or one is straight above the other.
    pub fn new(eye: DVec3, target: DVec3, fov_y_deg: f32) -> Result<Self, &'static str> {
        Self::try_from(LookAtKeys {
            eye,
            target,
            up: up(),
            fov_y_deg: Some(fov_y_deg),
            focal_length_mm: None,
            lens: None,
        })
    }

    pub(super) fn focus(&self) -> [DVec3; 2] {
        [self.keys.eye, self.keys.target]
    }

    /// Returns the image plane at distance 1 in render space.
    pub(super) fn image_plane(&self, size: [u32; 2], space: &RenderSpace) -> ImagePlane {
        let Basis { forward, right, up } = self.basis;
        let half_height = self.half_height;
        let to_plane = [forward, right, up];
        ImagePlane {
            lens: self.lens.map(|lens| lens.in_space(space)),
            ..ImagePlane::centered(
                Projection::Perspective,
                *space,
                self.keys.eye,
                to_plane,
                2.0 * half_height,
                size,
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_field_of_view_spans_the_rows_from_edge_to_edge() {
        let camera = LookAt::new(DVec3::ZERO, DVec3::NEG_Z, 90.0).unwrap();
        let plane = camera.image_plane([200, 100], &RenderSpace::default());
        let top = plane.point(99.5, -0.5);
        assert!((top - Vec3::new(0.0, 1.0, -1.0)).length() < 1e-5, "{top}");
        let right = plane.point(199.5, 49.5);
        assert!(
            (right - Vec3::new(2.0, 0.0, -1.0)).length() < 1e-5,
            "{right}"
        );
    }
}
