//! The camera that sees all around.

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::basis::{Basis, up};
use super::image_plane::{ImagePlane, Projection};
use super::sphere_axes::SphereAxes;
use crate::geometry::RenderSpace;
use crate::values;

/// A panorama of 360 x 180 degrees, an equirectangular map: columns are at equal steps of
/// longitude around `up`, rows of latitude, and the direction to `target` is on the middle
/// column. The horizon is the middle row.
///
/// ```
/// # use raycost_world::camera::Camera;
/// let camera: Camera = scene::yaml::from_str("
/// panorama: { eye: [0, 1.6, 0], target: [0, 1.6, -1] }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(try_from = "PanoramaKeys", into = "PanoramaKeys")]
pub struct Panorama {
    keys: PanoramaKeys,
    axes: SphereAxes,
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct PanoramaKeys {
    /// The center of the panorama.
    #[serde(with = "values::Point")]
    eye: DVec3,
    /// A point on the middle column of the picture.
    #[serde(with = "values::Point")]
    target: DVec3,
    /// The direction of the top row of the picture; +y if not given.
    #[serde(with = "values::Direction", default = "up")]
    up: Vec3,
}

impl TryFrom<PanoramaKeys> for Panorama {
    type Error = &'static str;

    fn try_from(keys: PanoramaKeys) -> Result<Self, Self::Error> {
        let Basis { right, .. } = Basis::look_at(keys.eye, keys.target, keys.up)?;
        Ok(Self {
            axes: SphereAxes {
                forward: keys.up.cross(right),
                right,
                up: keys.up,
            },
            keys,
        })
    }
}

impl From<Panorama> for PanoramaKeys {
    fn from(camera: Panorama) -> Self {
        camera.keys
    }
}

impl Panorama {
    pub(super) fn focus(&self) -> [DVec3; 2] {
        [self.keys.eye, self.keys.target]
    }

    pub(super) fn image_plane(&self, size: [u32; 2], space: &RenderSpace) -> ImagePlane {
        use std::f32::consts::{PI, TAU};
        let (axes, [width, height]) = (self.axes, size);
        let [right, down] = [
            TAU / width as f32 * axes.right,
            -PI / height as f32 * axes.up,
        ];
        let [to_column, to_row] = [width, height].map(|n| 0.5 * (n as f32 - 1.0));
        ImagePlane {
            projection: Projection::Panorama { axes },
            lens: None,
            space: *space,
            eye_in_world: self.keys.eye,
            eye: space.point(self.keys.eye),
            to_first: axes.forward - to_column * right - to_row * down,
            right,
            down,
            size,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(text: &str) -> ImagePlane {
        let panorama: Panorama = scene::yaml::from_str(text).unwrap();
        panorama.image_plane([40, 20], &RenderSpace::default())
    }

    #[test]
    fn directions_go_around_and_up() {
        // The horizon is level although the target is below it.
        let plane = plane("{ eye: [1, 2, 3], target: [1, 1, 2] }");
        for (x, y, expected) in [
            (19.5, 9.5, Vec3::NEG_Z),
            (29.5, 9.5, Vec3::X),
            (9.5, 9.5, Vec3::NEG_X),
            (-0.5, 9.5, Vec3::Z),
            (39.5, 9.5, Vec3::Z),
            (7.0, -0.5, Vec3::Y),
            (23.0, 19.5, Vec3::NEG_Y),
        ] {
            let ray = plane.ray(x, y);
            assert_eq!(ray.origin, Vec3::new(1.0, 2.0, 3.0));
            assert!(
                ray.direction.abs_diff_eq(expected, 1e-6),
                "{x} {y}: {}",
                ray.direction
            );
        }
    }

    #[test]
    fn the_pixels_cover_the_sphere() {
        let plane = plane("{ eye: [0, 0, 0], target: [3, 1, 2], up: [0, 1, 1] }");
        let mut area = 0.0;
        for y in 0..20_u8 {
            let side = plane.footprints(plane.pitch(), [3.0, y.into()], 2.0_f32);
            area += 40.0 * side * side;
        }
        let sphere = 4.0 * std::f32::consts::PI * 4.0;
        assert!((area / sphere - 1.0).abs() < 2e-3, "{area}");
    }
}
