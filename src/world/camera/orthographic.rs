//! The camera with parallel rays.

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::basis::{Basis, up};
use super::image_plane::{ImagePlane, Projection};
use crate::geometry::RenderSpace;
use crate::values;

/// An orthographic camera. It sees only what lies in front of the plane through `eye`.
///
/// ```
/// # use raycost_world::camera::Camera;
/// let camera: Camera = scene::yaml::from_str("
/// orthographic: { eye: [0, 5, 0], target: [0, 0, 0], up: [0, 0, 1], height: 4 }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(try_from = "OrthographicKeys", into = "OrthographicKeys")]
pub struct Orthographic {
    keys: OrthographicKeys,
    basis: Basis,
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct OrthographicKeys {
    /// The middle of the plane where the view begins.
    #[serde(with = "values::Point")]
    eye: DVec3,
    /// Another point in the middle of the picture.
    #[serde(with = "values::Point")]
    target: DVec3,
    /// The upward direction in the picture; +y if not given.
    #[serde(with = "values::Direction", default = "up")]
    up: Vec3,
    /// World-space height of the image.
    #[serde(with = "values::Positive")]
    height: f32,
}

impl TryFrom<OrthographicKeys> for Orthographic {
    type Error = &'static str;

    fn try_from(keys: OrthographicKeys) -> Result<Self, Self::Error> {
        Ok(Self {
            basis: Basis::look_at(keys.eye, keys.target, keys.up)?,
            keys,
        })
    }
}

impl From<Orthographic> for OrthographicKeys {
    fn from(camera: Orthographic) -> Self {
        camera.keys
    }
}

impl Orthographic {
    pub(super) fn focus(&self) -> [DVec3; 2] {
        [
            self.keys.eye,
            self.keys.eye + f64::from(self.keys.height) * self.basis.forward.as_dvec3(),
        ]
    }

    pub(super) fn image_plane(&self, size: [u32; 2], space: &RenderSpace) -> ImagePlane {
        let Basis { forward, right, up } = self.basis;
        let projection = Projection::Parallel { direction: forward };
        let height = space.length(self.keys.height);
        ImagePlane::centered(
            projection,
            *space,
            self.keys.eye,
            [Vec3::ZERO, right, up],
            height,
            size,
        )
    }
}
