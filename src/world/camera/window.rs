//! The perspective camera that looks through a window, which may be off-axis.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::image_plane::{ImagePlane, Projection};
use crate::geometry::RenderSpace;
use crate::values;
use base::keywords;

/// A perspective camera that looks through a window in a plane of constant z,
/// with x to the right and y up.
///
/// ```
/// # use raycost_world::camera::Camera;
/// let camera: Camera = scene::yaml::from_str("
/// window: { eye: [0, 0.35, -1], x: [-1, 1], y: [-0.5, 1], z: 0, samples: edges }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(try_from = "WindowKeys", into = "WindowKeys")]
pub struct Window {
    keys: WindowKeys,
}

keywords! {
    /// The positions of the pixels' centers in the window.
    #[derive(Default)]
    pub enum WindowSamples {
        /// In the centers of `width * height` equal cells.
        #[default]
        Centers = "centers",
        /// In equal steps from edge to edge, both included, as in the course's program.
        Edges = "edges",
    }
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct WindowKeys {
    /// The center of projection.
    #[serde(with = "values::Point")]
    eye: DVec3,
    /// The left and the right edge of the window.
    #[serde(with = "values::Range")]
    x: [f64; 2],
    /// The bottom and the top edge of the window.
    #[serde(with = "values::Range")]
    y: [f64; 2],
    /// The z coordinate of the window.
    #[serde(with = "values::ExactCoordinate")]
    z: f64,
    /// The positions of the samples in the cells of the window.
    #[serde(default)]
    samples: WindowSamples,
}

impl TryFrom<WindowKeys> for Window {
    type Error = &'static str;

    fn try_from(keys: WindowKeys) -> Result<Self, Self::Error> {
        if keys.eye.z == keys.z {
            Err("cannot lie in the eye's own plane, expected a `z` other than the eye's")
        } else {
            Ok(Self { keys })
        }
    }
}

impl From<Window> for WindowKeys {
    fn from(window: Window) -> Self {
        window.keys
    }
}

impl Window {
    pub(super) fn focus(&self) -> [DVec3; 2] {
        let WindowKeys { eye, z, .. } = self.keys;
        [eye, eye.with_z(z)]
    }

    pub(super) fn image_plane(&self, size: [u32; 2], space: &RenderSpace) -> ImagePlane {
        let WindowKeys {
            eye,
            x,
            y,
            z,
            samples,
        } = self.keys;
        let scaled = |vector: DVec3| (vector / space.unit()).as_vec3();
        let (first_x, step_x) = samples.grid(x, size[0]);
        let (below_top, step_y) = samples.grid([0.0, y[1] - y[0]], size[1]);
        ImagePlane {
            projection: Projection::Perspective,
            lens: None,
            space: *space,
            eye_in_world: eye,
            eye: space.point(eye),
            to_first: scaled(DVec3::new(first_x, y[1] - below_top, z) - eye),
            right: scaled(step_x * DVec3::X),
            down: scaled(-step_y * DVec3::Y),
            size,
        }
    }
}

impl WindowSamples {
    /// Returns the first of `n` sample points in the interval, and the step between them.
    fn grid(self, [from, to]: [f64; 2], n: u32) -> (f64, f64) {
        match self {
            Self::Edges => (from, (to - from) / f64::from(n.max(2) - 1)),
            Self::Centers => {
                let step = (to - from) / f64::from(n);
                (from + 0.5 * step, step)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn plane(samples: WindowSamples) -> ImagePlane {
        let keys = WindowKeys {
            eye: DVec3::new(0.0, 0.35, -1.0),
            x: [-1.0, 1.0],
            y: [-0.5, 1.0],
            z: 0.0,
            samples,
        };
        Window { keys }.image_plane([5, 4], &RenderSpace::default())
    }

    #[test]
    fn edges_sample_both_ends() {
        let plane = plane(WindowSamples::Edges);
        assert_eq!(plane.point(0.0, 0.0), Vec3::new(-1.0, 1.0, 0.0));
        assert_eq!(plane.point(4.0, 3.0), Vec3::new(1.0, -0.5, 0.0));
    }

    #[test]
    fn centers_sample_half_a_cell_inside() {
        let plane = plane(WindowSamples::Centers);
        let close = |a: Vec3, b: Vec3| (a - b).length() < 1e-6;
        assert!(close(plane.point(0.0, 0.0), Vec3::new(-0.8, 0.8125, 0.0)));
        assert!(close(plane.point(4.0, 3.0), Vec3::new(0.8, -0.3125, 0.0)));
    }
}
