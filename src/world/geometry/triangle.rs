//! Triangles.

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::located::{Described, Located, located};
use super::sampled::{Sampled, Seen, SurfaceSample};
use super::surface::{parameters_of, vector};
use super::{Aabb, Intersectable, N_PARAMETERS, Patch, Project, Ray, Shear, Transform};
use crate::values;
use math::simd::{Real, Vector};

/// The points between three vertices.
///
/// ```
/// # use raycost_world::geometry::{Located, Triangle};
/// let triangle: Located<Triangle> = scene::yaml::from_str("
/// { vertices: [[-1, 0, 2], [1, 0, 2], [0, 1, 2]] }
/// ").unwrap();
/// # assert_eq!(triangle.geometry.vertices[2].y, 1.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangle {
    /// The vertices, counterclockwise as seen from outside; not on one line.
    pub vertices: [Vec3; 3],
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TriangleKeys {
    /// The vertices, counterclockwise as seen from outside; not on one line.
    vertices: TriangleCorners,
}

/// Three points that are not on one line.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(try_from = "[Corner; 3]", into = "[Corner; 3]")]
struct TriangleCorners {
    points: [Corner; 3],
    triangle: Located<Triangle>,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Corner(#[serde(with = "values::Point")] DVec3);

impl TryFrom<[Corner; 3]> for TriangleCorners {
    type Error = &'static str;

    fn try_from(points: [Corner; 3]) -> Result<Self, Self::Error> {
        let vertices = located(points.map(|Corner(point)| point));
        let triangle = vertices.map(|vertices| Triangle { vertices });
        let has_area = triangle.geometry.normal().is_some();
        has_area.then_some(Self { points, triangle }).ok_or(
            "invalid value: three points on one line, expected three corners that span an area",
        )
    }
}

impl From<TriangleCorners> for [Corner; 3] {
    fn from(corners: TriangleCorners) -> Self {
        corners.points
    }
}

impl Described for Triangle {
    type Keys = TriangleKeys;

    fn from_keys(keys: TriangleKeys) -> Result<Located<Self>, &'static str> {
        Ok(keys.vertices.triangle)
    }
}

impl Triangle {
    /// Returns the unit normal; `None` if the vertices lie on one line.
    pub fn normal(&self) -> Option<Vec3> {
        let [a, b, c] = self.vertices;
        (b - a).cross(c - a).try_normalize()
    }
}

/// Returns the barycentric coordinates of a point in the plane of a triangle with these parameters,
/// or one point per lane: at least 0, with a sum of 1. A point outside is first moved to an edge.
#[inline(always)]
pub fn barycentrics<R: Real>(triangle: &[R; N_PARAMETERS], point: Vector<R>) -> [R; 3] {
    let [a, b, c] = corners(triangle);
    let normal = (b - a).cross(c - a);
    let u = area(b, c, point, normal);
    let v = area(c, a, point, normal);
    let w = area(a, b, point, normal);
    let sum = u + v + w;
    [u / sum, v / sum, w / sum]
}

/// Returns the vertices of a triangle with these parameters, or one per lane.
#[inline(always)]
pub fn corners<R: Real>(triangle: &[R; N_PARAMETERS]) -> [Vector<R>; 3] {
    [
        vector(triangle, 0),
        vector(triangle, 3),
        vector(triangle, 6),
    ]
}

/// Returns the area of the triangle of a point and two vertices, in arbitrary units; 0 if the point
/// lies outside.
#[inline(always)]
fn area<R: Real>(from: Vector<R>, to: Vector<R>, point: Vector<R>, normal: Vector<R>) -> R {
    let signed = (to - from).cross(point - from).dot(normal);
    signed.max(signed.splat(0.0))
}

impl Intersectable for Triangle {
    /// Intersects without gaps between adjacent triangles: see [`Shear`].
    #[inline]
    fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        let shear = Shear::along(ray.direction);
        shear
            .intersect(shear.points(ray, self.vertices))
            .filter(|&t| t > 0.0 && t < t_max)
    }

    fn bounds(&self) -> Aabb {
        Aabb::from_points(self.vertices)
    }

    fn transformed(&self, transform: &Transform) -> Option<Self> {
        let [a, b, c] = self.vertices.map(|vertex| transform.world_point(vertex));
        let is_mirrored = transform.is_mirrored();
        let vertices = if is_mirrored { [a, c, b] } else { [a, b, c] };
        Some(Self { vertices })
    }

    fn patch(&self) -> Option<Patch> {
        Some(Patch::Triangle(self.vertices))
    }
}

impl Project for Triangle {
    #[inline(always)]
    fn parameters(&self) -> [f32; N_PARAMETERS] {
        parameters_of(&self.vertices)
    }

    #[inline(always)]
    fn project_onto<R: Real>(
        parameters: &[R; N_PARAMETERS],
        near: Vector<R>,
    ) -> (Vector<R>, Vector<R>) {
        let (a, b, c) = (
            vector(parameters, 0),
            vector(parameters, 3),
            vector(parameters, 6),
        );
        let up = Vector::splat(a.x, Vec3::Y);
        let normal = (b - a).cross(c - a).normalize_or(up);
        let above = (near - a).dot(normal);
        (near - normal * above, normal)
    }
}

impl Sampled for Triangle {
    #[inline(always)]
    fn area<R: Real>(parameters: &[R; N_PARAMETERS]) -> R {
        normal_and_area(parameters).1
    }

    /// Samples the surface uniformly: Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th
    /// edition, section 6.5.3, after Heitz's map of the square.
    #[inline(always)]
    fn sample<R: Real>(
        parameters: &[R; N_PARAMETERS],
        from: Vector<R>,
        [u, v]: [R; 2],
    ) -> SurfaceSample<R> {
        let half = u.splat(0.5);
        let is_first = u.lt(v);
        let of_first = R::select(is_first, half * u, u - half * v);
        let of_second = R::select(is_first, v - half * u, half * v);
        let (a, b, c) = (
            vector(parameters, 0),
            vector(parameters, 3),
            vector(parameters, 6),
        );
        let point = a * of_first + b * of_second + c * (u.splat(1.0) - of_first - of_second);
        let (normal, area) = normal_and_area(parameters);
        Seen::new(point, normal, from).by_area(area)
    }
}

/// Returns the unit normal and the area.
#[inline(always)]
fn normal_and_area<R: Real>(parameters: &[R; N_PARAMETERS]) -> (Vector<R>, R) {
    let a = vector(parameters, 0);
    let cross = (vector(parameters, 3) - a).cross(vector(parameters, 6) - a);
    let normal = cross.normalize_or(Vector::splat(a.x, Vec3::Y));
    (normal, a.x.splat(0.5) * cross.length())
}

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
