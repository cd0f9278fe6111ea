//! Cameras of ParaView's render views.

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::panels::{Panel, Panels};
use super::template::StateValue;
use world::camera::{ImagePlane, Projection};

/// The scene's camera, converted to ParaView's: on-axis and right-handed. Positions and directions
/// are in world space.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct ViewCamera {
    position: DVec3,
    focal_point: DVec3,
    /// Unit vector to the right.
    right: Vec3,
    /// Unit vector upward.
    up: Vec3,
    /// Tangents of half the horizontal and half the vertical angle of view; half the width and half
    /// the height of the picture if parallel.
    half: [f32; 2],
    is_parallel: bool,
    /// True if the scene's camera is left-handed, so that ParaView shows the scene mirrored.
    is_mirrored: bool,
}

impl ViewCamera {
    /// Converts the camera of an image plane. The focal point is at `median_distance` from the
    /// position, or else at the distance of the picture's middle, at least 1.
    pub fn new(plane: &ImagePlane, median_distance: Option<f32>) -> Self {
        let position = plane.eye_in_world;
        let (forward, is_parallel) = match plane.projection {
            Projection::Perspective | Projection::Panorama { .. } => (direction(plane), false),
            Projection::Parallel { direction } => (direction, true),
        };
        // Make the axes right-handed.
        let right = plane.right.reject_from(forward).normalize();
        let mirrored_up = right.cross(forward);
        let is_mirrored = mirrored_up.dot(plane.down) > 0.0;
        let up = if is_mirrored {
            -mirrored_up
        } else {
            mirrored_up
        };
        // Contain all corners of the picture in a symmetric view.
        let half = |axis: Vec3| {
            let [w, h] = plane.size.map(|n| n as f32 - 0.5);
            let corners = [(-0.5, -0.5), (w, -0.5), (-0.5, h), (w, h)];
            let extent = |(x, y)| {
                let corner = plane.point(x, y) - plane.eye;
                let depth = if is_parallel {
                    plane.space.length(1.0)
                } else {
                    corner.dot(forward)
                };
                corner.dot(axis).abs() / depth
            };
            corners.into_iter().map(extent).fold(0.0, f32::max)
        };
        let half = match plane.projection {
            // ParaView has no panoramic camera: 90 degrees from top to bottom.
            Projection::Panorama { .. } => [2.0, 1.0],
            Projection::Perspective | Projection::Parallel { .. } => [half(right), half(up)],
        };
        // Choose the focal point.
        let to_center = plane.center().distance(plane.eye);
        let distance = median_distance.unwrap_or_else(|| match to_center {
            0.0 => plane.space.world_length(1.0),
            _ => plane.space.world_length(to_center),
        });
        Self {
            position,
            focal_point: position + (distance * forward).as_dvec3(),
            right,
            up,
            half,
            is_parallel,
            is_mirrored,
        }
    }

    /// Returns the position of the eye; the middle of the image plane if parallel.
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// Returns the tangents of half the horizontal and half the vertical angle of view; half
    /// the width and half the height of the picture if parallel.
    pub fn half(&self) -> [f32; 2] {
        self.half
    }

    /// Returns the unit vectors to the right, up and forward in ParaView's view.
    pub fn axes(&self) -> [Vec3; 3] {
        let forward = (self.focal_point - self.position).normalize().as_vec3();
        [forward.cross(self.up), self.up, forward]
    }

    /// Mirrors a point in world space if the view shows the scene mirrored.
    pub fn mirrored(&self, point: DVec3) -> DVec3 {
        if self.is_mirrored {
            let right = self.right.as_dvec3();
            point - 2.0 * right.dot(point - self.position) * right
        } else {
            point
        }
    }

    /// Returns the value of a key such as `camera2.view_angle`, the view angle in each of two
    /// panels, for a picture of this width and height; `None` for other keys.
    pub fn value(&self, size: [f64; 2], key: &str) -> Option<StateValue> {
        let (n, key) = Panels::split_key(key, "camera")?;
        let number = self.number(key, Panels::new(n, size).panel())?;
        Some(number.to_string().into())
    }

    /// Returns the value of a key without its prefix `camera2.`, for a view in which the picture fills
    /// the panel.
    fn number(&self, key: &str, panel: Panel) -> Option<f64> {
        let (name, index) = match key.split_once('.') {
            Some((name, index)) => (name, index.parse().ok()?),
            None => (key, 0),
        };
        let distance = self.focal_point.distance(self.position) as f32;
        let half_height = panel.half_height(self.half.map(|half| 2.0 * f64::from(half))) as f32;
        let number = match name {
            "position" => return self.position.as_ref().get(index).copied(),
            "focal_point" => return self.focal_point.as_ref().get(index).copied(),
            "mirror" => return Some(self.mirror(index)),
            "view_up" => *self.up.as_ref().get(index)?,
            "view_angle" if self.is_parallel => 30.0,
            "view_angle" => 2.0 * half_height.atan().to_degrees(),
            "parallel_projection" => f32::from(self.is_parallel),
            "parallel_scale" if self.is_parallel => half_height,
            "parallel_scale" => half_height * distance,
            _ => return None,
        };
        Some(number.into())
    }

    /// Returns entry `i` of a 4 x 4 matrix, row-major: the reflection in the plane through the eye
    /// perpendicular to `right` for a left-handed camera, else the identity.
    fn mirror(&self, i: usize) -> f64 {
        let (row, column) = (i / 4, i % 4);
        let identity = if row == column { 1.0 } else { 0.0 };
        if !self.is_mirrored || row == 3 {
            return identity;
        }
        let right = self.right.as_dvec3();
        let along_row = 2.0 * right[row];
        match column {
            3 => along_row * right.dot(self.position),
            _ => identity - along_row * right[column],
        }
    }
}

/// Returns the unit viewing direction: perpendicular to the image plane, which avoids distortion,
/// if that ray meets the picture; else toward the middle of the picture.
fn direction(plane: &ImagePlane) -> Vec3 {
    let to_center = plane.center() - plane.eye;
    let normal = plane.right.normalize().cross(plane.down.normalize());
    let straight = to_center.project_onto_normalized(normal);
    let steps = |axis: Vec3| (to_center - straight).dot(axis).abs() / axis.length_squared();
    let [width, height] = plane.size.map(|n| n as f32);
    let meets_picture = steps(plane.right) <= 0.5 * width && steps(plane.down) <= 0.5 * height;
    if meets_picture { straight } else { to_center }.normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use world::geometry::RenderSpace;

    #[test]
    fn a_left_handed_plane_is_mirrored_about_the_eye() {
        let camera: world::camera::Camera =
            scene::yaml::from_str("window: { eye: [3, 0, -1], x: [2, 4], y: [-1, 1], z: 0 }")
                .unwrap();
        let camera = ViewCamera::new(&camera.image_plane([10, 10], &RenderSpace::default()), None);
        assert!(camera.is_mirrored);
        let row: Vec<f64> = (0..4).map(|i| camera.mirror(i)).collect();
        assert_eq!(row, [-1.0, 0.0, 0.0, 6.0]);
        assert!((camera.up - Vec3::Y).length() < 1e-6);
    }

    #[test]
    fn an_off_axis_camera_looks_straight_at_its_window_where_it_can() {
        let focal_point = |eye: &str| {
            let text = format!("window: {{ eye: {eye}, x: [-1, 1], y: [-1, 1], z: 0 }}");
            let camera: world::camera::Camera = scene::yaml::from_str(&text).unwrap();
            ViewCamera::new(
                &camera.image_plane([10, 10], &RenderSpace::default()),
                Some(1.0),
            )
            .focal_point
        };
        assert_eq!(focal_point("[0.9, -0.5, -1]"), DVec3::new(0.9, -0.5, 0.0));
        let beside = focal_point("[4, 0, -3]");
        let to_middle = DVec3::new(3.2, 0.0, -2.4);
        assert!(beside.abs_diff_eq(to_middle, 1e-6), "{beside}");
    }

    #[test]
    fn a_look_at_camera_is_not_mirrored() {
        let camera: world::camera::Camera =
            scene::yaml::from_str("look_at: { eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 90 }")
                .unwrap();
        let camera = ViewCamera::new(
            &camera.image_plane([100, 100], &RenderSpace::default()),
            Some(4.0),
        );
        assert!(!camera.is_mirrored);
        assert!((camera.focal_point - DVec3::Z).length() < 1e-6);
        let panel = Panels::new(2, [1.0, 1.0]).panel();
        let angle = camera.number("view_angle", panel).unwrap();
        assert!(angle > 90.0 && angle < 120.0, "{angle}");
    }
}
