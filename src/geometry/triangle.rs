//! Triangles.

use glam::Vec3;
use serde::de::{Error, Unexpected};
use serde::{Deserialize, Deserializer};

use super::{Aabb, Intersectable, Patch, Ray, Shear, Transform};
use crate::yaml;

/// The points between three vertices.
///
/// ```
/// # use raycost::geometry::Triangle;
/// let triangle: Triangle = raycost::yaml::from_str("
/// { vertices: [[-1, 0, 2], [1, 0, 2], [0, 1, 2]] }
/// ").unwrap();
/// # assert_eq!(triangle.vertices[2].y, 1.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Triangle {
    /// The vertices, counter-clockwise as seen from outside; not on one line.
    #[serde(deserialize_with = "vertices")]
    pub vertices: [Vec3; 3],
}

impl Triangle {
    /// The unit normal; `None` if the vertices lie on one line.
    pub fn normal(&self) -> Option<Vec3> {
        let [a, b, c] = self.vertices;
        (b - a).cross(c - a).try_normalize()
    }

    /// The barycentric coordinates of a point in the triangle's plane: at least 0,
    /// with a sum of 1. For a point outside they are those of a point on an
    /// edge.
    pub fn barycentrics(&self, point: Vec3) -> Vec3 {
        let [a, b, c] = self.vertices;
        let normal = (b - a).cross(c - a);
        // Signed areas of the triangles of the point and two vertices.
        let areas = [(b, c), (c, a), (a, b)]
            .map(|(from, to)| (to - from).cross(point - from).dot(normal).max(0.0));
        Vec3::from(areas) / areas.iter().sum::<f32>()
    }
}

impl Intersectable for Triangle {
    /// Watertight: see [`Shear`].
    #[inline]
    fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        let shear = Shear::along(ray.direction);
        shear
            .intersect(self.vertices.map(|vertex| shear.point(ray, vertex)))
            .filter(|&t| t > 0.0 && t < t_max)
    }

    fn project(&self, near: Vec3) -> (Vec3, Vec3) {
        let normal = self.normal().unwrap_or(Vec3::Y);
        let above = (near - self.vertices[0]).dot(normal);
        (near - above * normal, normal)
    }

    fn bounds(&self) -> Aabb {
        Aabb::of_points(self.vertices)
    }

    fn transformed(&self, transform: &Transform) -> Option<Self> {
        let vertices = self.vertices.map(|vertex| transform.world_point(vertex));
        Some(Self { vertices })
    }

    fn patch(&self) -> Option<Patch> {
        Some(Patch::Triangle(self.vertices))
    }
}

/// Reads three points that are not on one line.
fn vertices<'de, D: Deserializer<'de>>(d: D) -> Result<[Vec3; 3], D::Error> {
    let vertices = <[YamlPoint; 3]>::deserialize(d)?.map(|YamlPoint(point)| point);
    if (Triangle { vertices }).normal().is_none() {
        return Err(D::Error::invalid_value(
            Unexpected::Other("three points on one line"),
            &"three corners that span an area",
        ));
    }
    Ok(vertices)
}

#[derive(Deserialize)]
struct YamlPoint(#[serde(deserialize_with = "yaml::point")] Vec3);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_hit_a_triangle_from_both_sides_within_its_edges() {
        let triangle = Triangle {
            vertices: [Vec3::ZERO, Vec3::X, Vec3::Y],
        };
        let down = |x: f32, y: f32| Ray {
            origin: Vec3::new(x, y, 2.0),
            direction: -Vec3::Z,
        };
        assert_eq!(triangle.intersect(&down(0.25, 0.25), 9.0), Some(2.0));
        assert_eq!(triangle.intersect(&down(0.75, 0.75), 9.0), None);
        let up = Ray {
            origin: Vec3::new(0.25, 0.25, -1.0),
            direction: Vec3::Z,
        };
        assert_eq!(triangle.intersect(&up, 9.0), Some(1.0));
        let along = Ray {
            origin: Vec3::new(-1.0, 0.25, 0.0),
            direction: Vec3::X,
        };
        assert_eq!(triangle.intersect(&along, 9.0), None);
    }
}
