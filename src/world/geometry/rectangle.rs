//! Flat rectangles and parallelograms.

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::located::{Described, Located, located};
use super::plane::MIN_COS;
use super::sampled::{Sampled, Seen, SurfaceSample};
use super::spherical_rectangle::SphericalRectangle;
use super::surface::{parameters_of, rounding_of_plane, vector};
use super::{Aabb, Intersectable, N_PARAMETERS, Patch, Project, Ray, Transform};
use crate::values;
use math::simd::{Mask, Real, Vector};

/// The points `corner + a * edges[0] + b * edges[1]` with `a` and `b` from 0 to 1: a
/// rectangle, or a parallelogram if the edges are not perpendicular.
///
/// ```
/// # use raycost_world::geometry::{Located, Rectangle};
/// let wall: Located<Rectangle> = scene::yaml::from_str("
/// { corner: [-1, 0, 2], edges: [[2, 0, 0], [0, 1, 0]] }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    corner: Vec3,
    /// The edges, not parallel. The outward normal is along their cross product.
    edges: [Vec3; 2],
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RectangleKeys {
    /// A corner.
    #[serde(with = "values::Point")]
    corner: DVec3,
    /// The two edges at the corner, which are not parallel.
    edges: Edges,
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[cfg_attr(feature = "schema", schemars(with = "[values::Point; 2]"))]
#[serde(expecting = "two edges: [[x, y, z], [x, y, z]]")]
struct Edges(
    #[serde(with = "values::Point")] DVec3,
    #[serde(with = "values::Point")] DVec3,
);

impl Described for Rectangle {
    type Keys = RectangleKeys;

    fn from_keys(
        RectangleKeys { corner, edges }: RectangleKeys,
    ) -> Result<Located<Self>, &'static str> {
        let [u, v] = [edges.0, edges.1].map(|edge| edge.as_vec3());
        let sine = u.normalize_or_zero().cross(v.normalize_or_zero()).length();
        if sine < 1e-6 {
            return Err("cannot be without area, expected two edges that are not parallel");
        }
        Ok(located([corner]).map(|[corner]| Self::new(corner, u, v)))
    }
}

impl Rectangle {
    /// Creates the rectangle with these edges, which must not be parallel, at a corner.
    pub fn new(corner: Vec3, u: Vec3, v: Vec3) -> Self {
        Self {
            corner,
            edges: [u, v],
        }
    }

    /// Returns the corners in order.
    fn corners(&self) -> [Vec3; 4] {
        let [u, v] = self.edges;
        let corner = self.corner;
        [corner, corner + u, corner + u + v, corner + v]
    }
}

impl Intersectable for Rectangle {
    #[inline]
    fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        let (u, v) = (self.edges[0].as_dvec3(), self.edges[1].as_dvec3());
        let direction = ray.direction.as_dvec3();
        let from_corner = ray.origin.as_dvec3() - self.corner.as_dvec3();
        // Cramer's rule for `from_corner + t * direction = a * u + b * v`, with all unknowns times
        // `volume`.
        let normal = u.cross(v);
        let volume = direction.dot(normal);
        let min_cos = f64::from(MIN_COS);
        if volume * volume < min_cos * min_cos * normal.length_squared() {
            return None;
        }
        // Compare the coordinates on the edges with 0 and `volume`, without a division.
        let moment = from_corner.cross(direction);
        let (a, b) = (-moment.dot(v), moment.dot(u));
        let range = volume.min(0.0)..=volume.max(0.0);
        if !(range.contains(&a) && range.contains(&b)) {
            return None;
        }
        let t = (-from_corner.dot(normal) / volume) as f32;
        (t > 0.0 && t < t_max).then_some(t)
    }

    /// Rounded outward.
    fn bounds(&self) -> Aabb {
        let [corner, u, v] = [self.corner, self.edges[0], self.edges[1]].map(|v| v.as_dvec3());
        Aabb::around([corner, corner + u, corner + u + v, corner + v])
    }

    fn transformed(&self, transform: &Transform) -> Option<Self> {
        let [u, v] = self.edges.map(|edge| transform.world_vector(edge));
        let [u, v] = if transform.is_mirrored() {
            [v, u]
        } else {
            [u, v]
        };
        Some(Self::new(transform.world_point(self.corner), u, v))
    }

    fn patch(&self) -> Option<Patch> {
        Some(Patch::Polygon(self.corners().into()))
    }
}

impl Project for Rectangle {
    #[inline(always)]
    fn parameters(&self) -> [f32; N_PARAMETERS] {
        let [u, v] = self.edges;
        parameters_of(&[self.corner, u, v])
    }

    #[inline(always)]
    fn project_onto<R: Real>(
        parameters: &[R; N_PARAMETERS],
        near: Vector<R>,
    ) -> (Vector<R>, Vector<R>) {
        let corner = vector(parameters, 0);
        let (normal, _) = normal_and_area(vector(parameters, 3), vector(parameters, 6));
        (near - normal * (near - corner).dot(normal), normal)
    }

    #[inline(always)]
    fn rounding_along<R: Real>(parameters: &[R; N_PARAMETERS], at: [Vector<R>; 2]) -> R {
        rounding_of_plane(vector(parameters, 0), at)
    }
}

impl Sampled for Rectangle {
    #[inline(always)]
    fn area<R: Real>(parameters: &[R; N_PARAMETERS]) -> R {
        normal_and_area(vector(parameters, 3), vector(parameters, 6)).1
    }

    /// Samples directions uniformly for a near rectangle; for a parallelogram, or a rectangle
    /// farther away, samples points uniformly on its surface.
    #[inline(always)]
    fn sample<R: Real>(
        parameters: &[R; N_PARAMETERS],
        from: Vector<R>,
        numbers: [R; 2],
    ) -> SurfaceSample<R> {
        let (corner, u, v) = (
            vector(parameters, 0),
            vector(parameters, 3),
            vector(parameters, 6),
        );
        // A uniform point on the surface.
        let (normal, area) = normal_and_area(u, v);
        let [a, b] = numbers;
        let by_area = Seen::new(corner + u * a + v * b, normal, from).by_area(area);
        let is_near = is_near(corner - from, u, v);
        if is_near.none() {
            return by_area;
        }
        // A uniform direction, where that is accurate.
        let directions = SphericalRectangle::new(corner - from, [u, v]);
        let is_wide = directions.is_wide() & is_near;
        let seen = Seen::along(directions.way(numbers), normal);
        SurfaceSample {
            seen: Seen::select(is_wide, seen, by_area.seen),
            density: R::select(is_wide, directions.density(), by_area.density),
        }
    }

    #[inline(always)]
    fn density<R: Real>(parameters: &[R; N_PARAMETERS], from: Vector<R>, seen: &Seen<R>) -> R {
        let (u, v) = (vector(parameters, 3), vector(parameters, 6));
        let (_, area) = normal_and_area(u, v);
        let by_area = seen.density_by_area(area);
        let to_corner = vector(parameters, 0) - from;
        let is_near = is_near(to_corner, u, v);
        if is_near.none() {
            return by_area;
        }
        let directions = SphericalRectangle::new(to_corner, [u, v]);
        R::select(
            directions.is_wide() & is_near,
            directions.density(),
            by_area,
        )
    }
}

/// Returns true if a point is nearer to the center of a rectangle than two of its diagonals: from
/// farther away, uniform points on the surface are as good, and faster. Always false for a
/// parallelogram without right angles, up to rounding errors.
#[inline(always)]
fn is_near<R: Real>(to_corner: Vector<R>, u: Vector<R>, v: Vector<R>) -> R::Mask {
    let half = to_corner.x.splat(0.5);
    let to_center = to_corner + u * half + v * half;
    let (width, height) = (u.dot(u), v.dot(v));
    let reach = half.splat(4.0) * (width + height);
    let is_rectangle = u
        .dot(v)
        .abs()
        .lt((width * height).sqrt() * half.splat(1e-5));
    to_center.dot(to_center).lt(reach) & is_rectangle
}

/// Returns the unit normal and the area of a parallelogram with these edges.
#[inline(always)]
fn normal_and_area<R: Real>(u: Vector<R>, v: Vector<R>) -> (Vector<R>, R) {
    let (length_u, length_v) = (u.length(), v.length());
    let cross = (u / length_u).cross(v / length_v);
    let sine = cross.length();
    (cross / sine, length_u * length_v * sine)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn vector() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-1.0_f32..1.0).prop_map(Vec3::from)
    }

    proptest! {
        #[test]
        fn a_ray_hits_the_points_between_the_edges(
            [corner, u, v, origin] in [vector(), vector(), vector(), vector()],
            [a, b] in [-0.5_f32..1.5, -0.5_f32..1.5],
            scale in prop_oneof![Just(1.0_f32), Just(1e-12), Just(1e12)],
        ) {
            let normal = u.cross(v);
            let target = corner + a * u + b * v;
            let direction = (target - origin).normalize();
            prop_assume!(normal.length() > 0.05 && direction.dot(normal).abs() > 0.01);
            let is_near_edge = [a, b].iter().any(|along| along.abs().min((along - 1.0).abs()) < 1e-3);
            prop_assume!(!is_near_edge);
            let rectangle = Rectangle::new(scale * corner, scale * u, scale * v);
            let ray = Ray { origin: scale * origin, direction };
            let distance = scale * target.distance(origin);
            let is_inside = [a, b].iter().all(|along| (0.0..1.0).contains(along));
            let hit = rectangle.intersect(&ray, f32::INFINITY);
            prop_assert_eq!(hit.is_some(), is_inside);
            if let Some(t) = hit {
                prop_assert!((t - distance).abs() < 1e-4 * scale, "{} {}", t, distance);
                prop_assert_eq!(rectangle.intersect(&ray, 0.99 * t), None);
            }
            let away = Ray { direction: -direction, ..ray };
            prop_assert_eq!(rectangle.intersect(&away, f32::INFINITY), None);
        }
    }

    #[test]
    fn a_rectangle_ends_at_its_edges() {
        let rectangle = Rectangle::new(Vec3::new(-1.0, 0.0, 2.0), 2.0 * Vec3::X, Vec3::Y);
        let at = |x: f32, y: f32| {
            let ray = Ray {
                origin: Vec3::new(x, y, 0.0),
                direction: Vec3::Z,
            };
            rectangle.intersect(&ray, 9.0)
        };
        assert_eq!(at(-0.99, 0.01), Some(2.0));
        assert_eq!(at(0.99, 0.99), Some(2.0));
        for (x, y) in [(-1.01, 0.5), (1.01, 0.5), (0.0, -0.01), (0.0, 1.01)] {
            assert_eq!(at(x, y), None);
        }
        let (point, normal) = rectangle.project(Vec3::new(0.2, 0.4, 2.01));
        assert_eq!((point, normal), (Vec3::new(0.2, 0.4, 2.0), Vec3::Z));
    }

    #[test]
    fn parallel_edges_are_refused() {
        let read = |text: &str| scene::yaml::from_str::<Located<Rectangle>>(text).is_ok();
        assert!(read("{ corner: [0, 0, 0], edges: [[1, 0, 0], [1, 1, 0]] }"));
        assert!(!read(
            "{ corner: [0, 0, 0], edges: [[1, 0, 0], [-2, 0, 0]] }"
        ));
        assert!(!read(
            "{ corner: [0, 0, 0], edges: [[1, 0, 0], [0, 0, 0]] }"
        ));
    }
}
