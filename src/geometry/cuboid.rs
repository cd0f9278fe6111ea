//! Axis-aligned boxes as shapes.

use glam::Vec3;
use serde::Deserialize;

use super::{Aabb, Intersectable, Patch, Ray, Transform};
use crate::yaml;

/// The surface of an axis-aligned box. A `transform` makes a rotated one.
///
/// ```
/// # use raycost::geometry::Cuboid;
/// let cuboid: Cuboid = raycost::yaml::from_str("{ min: [-1, 0, 2], max: [1, 2, 3] }").unwrap();
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(try_from = "CuboidKeys")]
pub struct Cuboid {
    bounds: Aabb,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CuboidKeys {
    #[serde(deserialize_with = "yaml::point")]
    min: Vec3,
    #[serde(deserialize_with = "yaml::point")]
    max: Vec3,
}

impl TryFrom<CuboidKeys> for Cuboid {
    type Error = &'static str;

    fn try_from(CuboidKeys { min, max }: CuboidKeys) -> Result<Self, Self::Error> {
        if min.cmplt(max).all() {
            Ok(Self::new(Aabb { min, max }))
        } else {
            Err("cannot be without volume, expected min < max on every axis")
        }
    }
}

impl Cuboid {
    /// The surface of `bounds`, which must have a volume.
    pub fn new(bounds: Aabb) -> Self {
        Self { bounds }
    }
}

impl Intersectable for Cuboid {
    /// The slab test of Kay and Kajiya (SIGGRAPH 1986).
    #[inline]
    fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        let inverse = ray.direction.recip();
        let t0 = (self.bounds.min - ray.origin) * inverse;
        let t1 = (self.bounds.max - ray.origin) * inverse;
        let enter = t0.min(t1).max_element();
        let exit = t0.max(t1).min_element();
        let t = if enter > 0.0 { enter } else { exit };
        (enter <= exit && t > 0.0 && t < t_max).then_some(t)
    }

    fn project(&self, near: Vec3) -> (Vec3, Vec3) {
        let center = self.bounds.center();
        let outward = (near - center) / (0.5 * (self.bounds.max - self.bounds.min));
        let axis = outward.abs().max_position();
        let mut normal = Vec3::ZERO;
        normal[axis] = outward[axis].signum();
        let mut point = near;
        point[axis] = if normal[axis] > 0.0 {
            self.bounds.max[axis]
        } else {
            self.bounds.min[axis]
        };
        (point, normal)
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn transformed(&self, transform: &Transform) -> Option<Self> {
        let bounds = transform.world_bounds(&self.bounds);
        transform.keeps_axes().then_some(Self { bounds })
    }

    fn patch(&self) -> Option<Patch> {
        let [a, b, c, d, e, f, g, h] = self.bounds.corners();
        Some(Patch::Box([a, b, d, c, e, f, h, g]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_corners_follow_one_face_and_then_the_opposite_one() {
        let cuboid = Cuboid::new(Aabb {
            min: Vec3::new(-1.0, -2.0, 3.0),
            max: Vec3::new(1.0, 2.0, 5.0),
        });
        let patch = cuboid.patch().unwrap();
        let (near, far) = patch.corners().split_at(4);
        for i in 0..4 {
            assert_eq!(far[i] - near[i], Vec3::new(0.0, 0.0, 2.0));
            let edge = near[(i + 1) % 4] - near[i];
            assert_eq!((edge != Vec3::ZERO, edge.x * edge.y), (true, 0.0));
        }
        // VTK's hexahedron: the corners of the first face are counter-clockwise
        // as seen from inside.
        let [u, v] = [near[1] - near[0], near[2] - near[1]];
        assert!(u.cross(v).dot(far[0] - near[0]) > 0.0);
    }

    #[test]
    fn a_ray_hits_a_box_from_outside_and_from_inside() {
        let cuboid = Cuboid::new(Aabb {
            min: Vec3::new(-1.0, -2.0, 3.0),
            max: Vec3::new(1.0, 2.0, 5.0),
        });
        let along_z = |z: f32| Ray {
            origin: Vec3::new(0.5, 0.5, z),
            direction: Vec3::Z,
        };
        assert_eq!(cuboid.intersect(&along_z(0.0), 9.0), Some(3.0));
        assert_eq!(cuboid.intersect(&along_z(4.0), 9.0), Some(1.0));
        assert_eq!(cuboid.intersect(&along_z(6.0), 9.0), None);
        let (point, normal) = cuboid.project(Vec3::new(0.5, 0.5, 3.0001));
        assert_eq!((point.z, normal), (3.0, -Vec3::Z));
    }
}
