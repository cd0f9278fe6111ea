//! The drawn length of rays in pictures of ray trees.

use glam::Vec3;

use render::attribution::TracedRay;
use world::camera::{ImagePlane, Projection};
use world::geometry::{Aabb, Ray};
use world::scene::Scene;

/// Maximum distance, in radii, of a light to which shadow rays are drawn.
const FAR_LIGHT: f32 = 10.0;
/// Minimum drawn length, in radii, of a ray that leaves the scene.
const SHORTEST: f32 = 0.25;

/// A bounding sphere of the bounded primitives and the camera, in render space.
#[derive(Debug, Clone, Copy)]
pub(super) struct BoundingSphere {
    pub(super) center: Vec3,
    /// Radius, greater than 0.
    pub(super) radius: f32,
}

impl BoundingSphere {
    /// Creates the bounding sphere of a scene and the camera of this image plane.
    pub(super) fn new(scene: &Scene, plane: &ImagePlane) -> Self {
        let camera = match plane.projection {
            Projection::Perspective | Projection::Panorama { .. } => [plane.eye; 2],
            Projection::Parallel { .. } => {
                let [right, bottom] = plane.size.map(|n| n as f32);
                [plane.point(0.0, 0.0), plane.point(right, bottom)]
            }
        };
        let camera = Aabb::from_points(camera);
        let bounded = scene
            .world()
            .upper_level()
            .iter()
            .filter(|p| !p.is_unbounded());
        let bounds = bounded.fold(camera, |all, primitive| all.union(primitive.bounds()));
        Self {
            center: bounds.center(),
            radius: 0.5 * bounds.min.distance(bounds.max),
        }
    }

    /// Returns the length of the line that shows a ray: to its hit, to its light, or to the point
    /// where it leaves the sphere.
    pub(super) fn length(&self, ray: &TracedRay) -> f32 {
        match ray.end() {
            Some(end) => end,
            None if ray.t_max <= FAR_LIGHT * self.radius => ray.t_max,
            None => self.exit(&ray.ray).max(SHORTEST * self.radius),
        }
    }

    /// Returns the distance at which the ray leaves the sphere; 0 if it misses it.
    fn exit(&self, ray: &Ray) -> f32 {
        let from_center = ray.origin - self.center;
        let middle = -from_center.dot(ray.direction);
        let off_center = from_center + middle * ray.direction;
        let half_chord = self.radius.powi(2) - off_center.length_squared();
        if half_chord > 0.0 {
            middle + half_chord.sqrt()
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: BoundingSphere = BoundingSphere {
        center: Vec3::X,
        radius: 2.0,
    };

    fn exit(origin: Vec3, direction: Vec3) -> f32 {
        UNIT.exit(&Ray { origin, direction })
    }

    #[test]
    fn rays_end_where_they_leave_the_sphere() {
        assert_eq!(exit(Vec3::X, Vec3::Y), 2.0);
        assert_eq!(exit(Vec3::NEG_X * 4.0, Vec3::X), 7.0);
        assert!(exit(Vec3::X * 9.0, Vec3::X) < 0.0);
        assert_eq!(exit(Vec3::Y * 9.0, Vec3::X), 0.0);
    }
}
