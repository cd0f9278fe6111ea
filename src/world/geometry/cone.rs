//! Cones and truncated cones, with flat ends.

use std::f32::consts::PI;

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::axis::{AxisRay, ChosenPart, EndKeys, Ends, ShapeAxis};
use super::disk::circle_extent;
use super::located::{Described, Located};
use super::sampled::{Sampled, Seen, SurfaceSample, on_circle};
use super::{Aabb, Intersectable, N_PARAMETERS, Patch, Project, Ray, RayTest, Transform};
use crate::values;
use math::sampling::disk;
use math::simd::{Real, Vector};

/// The closed surface of a cone between two ends, each a flat disk with its own radius.
///
/// ```
/// # use raycost_world::geometry::{Located, Cone};
/// let tip: Located<Cone> = scene::yaml::from_str("
/// { ends: [[0, 0, 2], [0, 1, 2]], radius: [0.5, 0] }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    /// The centers of the two ends, which differ.
    ends: Ends,
    /// The radii at the ends.
    radius: [f32; 2],
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ConeKeys {
    /// The centers of the two ends, which differ.
    ends: EndKeys,
    /// The radius at each end; one may be 0.
    #[serde(with = "values::ConeRadii")]
    radius: [f32; 2],
}

impl Described for Cone {
    type Keys = ConeKeys;

    fn from_keys(ConeKeys { ends, radius }: ConeKeys) -> Result<Located<Self>, &'static str> {
        Ok(ends.ends.map(|ends| Self { ends, radius }))
    }
}

impl Cone {
    /// Creates the cone between two points, which must differ, with these radii, at most one of
    /// which is 0.
    pub fn new(ends: [Vec3; 2], radii: [f32; 2]) -> Self {
        Self {
            ends: Ends(ends),
            radius: radii,
        }
    }

    /// Returns the centers of the ends.
    pub fn ends(&self) -> [Vec3; 2] {
        self.ends.0
    }
}

/// Returns the sine and the cosine of the angle between the normals of the side and of the axis.
#[inline(always)]
fn slant<R: Real>(axis: &ShapeAxis<R>) -> (R, R) {
    let one = axis.slope.splat(1.0);
    let cos = one / (one + axis.slope * axis.slope).sqrt();
    (axis.slope * cos, cos)
}

impl RayTest for Cone {
    /// Clips the ray to the infinite cone and to the slab between
    /// the ends, so that no ray gets in between side and end.
    #[inline(always)]
    fn hits<R: Real>(parameters: &[R; N_PARAMETERS], origin: Vector<R>, direction: Vector<R>) -> R {
        // Clip the ray to the infinite cone.
        let axis = ShapeAxis::new(parameters);
        let (sine, cos) = slant(&axis);
        let ray = AxisRay::new(&axis, origin, direction);
        let side = ray.cone(cos * axis.radius, sine, cos);
        let zero = sine.splat(0.0);
        // Parallel to the side, a ray is inside of it or outside.
        let is_parallel = side.a.equals(zero) & side.b.equals(zero);
        // Through both halves of the double cone: the right half has positive radii.
        let is_double = !is_parallel & side.a.lt(zero);
        let grows = zero.lt(side.growth);
        let is_open_before = is_parallel | (is_double & !grows);
        let is_open_after = is_parallel | (is_double & grows);
        let enter = R::select(is_open_before, zero.splat(f32::NEG_INFINITY), side.enter);
        let exit = R::select(is_open_after, zero.splat(f32::INFINITY), side.exit);
        let is_inside = is_parallel & !zero.lt(side.c);
        let hits = is_inside | is_double | (!is_parallel & side.hits);
        // Clip it to the slab between the ends.
        let inverse = zero.splat(1.0) / ray.direction_along;
        let to_first = (-axis.half_length - ray.along) * inverse;
        let to_second = (axis.half_length - ray.along) * inverse;
        let enter = ray.start + enter.max(to_first.min(to_second));
        let exit = ray.start + exit.min(to_first.max(to_second));
        let t = R::select(zero.lt(enter), enter, exit);
        R::select(hits & enter.le(exit), t, zero)
    }
}

impl Intersectable for Cone {
    #[inline]
    fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        self.first_hit(ray, t_max)
    }

    fn bounds(&self) -> Aabb {
        let [from, to] = self.ends.0;
        let axis = (to - from).normalize_or(Vec3::Y);
        let extent = circle_extent(axis);
        let around = |center: Vec3, radius: f32| Aabb {
            min: center - radius * extent,
            max: center + radius * extent,
        };
        around(from, self.radius[0]).union(around(to, self.radius[1]))
    }

    fn transformed(&self, transform: &Transform) -> Option<Self> {
        let (ends, radius) = self.ends.transformed(self.radius, transform)?;
        Some(Self { ends, radius })
    }

    fn patch(&self) -> Option<Patch> {
        let half = ShapeAxis::new(&self.parameters()).half_length;
        let [from, to] = self.radius;
        let circles = [[-half, 0.0], [-half, from], [half, to], [half, 0.0]];
        Some(Patch::turned(self.ends.0, circles))
    }
}

impl Project for Cone {
    #[inline(always)]
    fn parameters(&self) -> [f32; N_PARAMETERS] {
        self.ends.parameters(self.radius)
    }

    /// Projects onto the side or the end that the point is least far inside of.
    #[inline(always)]
    fn project_onto<R: Real>(
        parameters: &[R; N_PARAMETERS],
        near: Vector<R>,
    ) -> (Vector<R>, Vector<R>) {
        let axis = ShapeAxis::new(parameters);
        let (sine, cos) = slant(&axis);
        let (along, across) = axis.split(near);
        let radius = axis.radius - axis.slope * along;
        let above_side = cos * (across.length() - radius);
        let above_end = along.abs() - axis.half_length;
        let of_end = axis.direction.flip_sign_by(along);
        let of_side = axis.outward(across) * cos + axis.direction * sine;
        let is_side = above_end.le(above_side);
        let normal = Vector::select(is_side, of_side, of_end);
        let above = R::select(is_side, above_side, above_end);
        (near - normal * above, normal)
    }
}

impl Sampled for Cone {
    #[inline(always)]
    fn area<R: Real>(parameters: &[R; N_PARAMETERS]) -> R {
        let [from, side, to] = areas(&ShapeAxis::new(parameters));
        from + side + to
    }

    /// Samples the surface uniformly: the first number selects the side or an end.
    #[inline(always)]
    fn sample<R: Real>(
        parameters: &[R; N_PARAMETERS],
        from: Vector<R>,
        [u, v]: [R; 2],
    ) -> SurfaceSample<R> {
        let axis = ShapeAxis::new(parameters);
        let (sine, cos) = slant(&axis);
        let (zero, one) = (u.splat(0.0), u.splat(1.0));
        let ChosenPart {
            area,
            is_from,
            is_side,
            shares: [of_from, of_side, of_to],
        } = ChosenPart::by_area(areas(&axis), u);
        let of_end = R::select(is_from, of_from, of_to);
        let [x, y] = disk([R::select(is_side, zero, of_end), v]);
        let [radius, end] = [
            R::select(is_from, axis.radii[0], axis.radii[1]),
            R::select(is_from, -one, one),
        ];
        let on_end = axis
            .direction
            .around([radius * x, radius * y, end * axis.half_length]);
        let normal = axis.direction.around(on_circle(v, cos, sine));
        let fraction = axis.fraction_by_area(of_side);
        let radius = axis.radii[0] + (axis.radii[1] - axis.radii[0]) * fraction;
        let along = axis.half_length * (fraction + fraction - one);
        let on_side = axis.direction.around(on_circle(v, radius, along));
        let [begin, behind] = axis.ends;
        let center = (begin + behind) * one.splat(0.5);
        let point = center + Vector::select(is_side, on_side, on_end);
        let normal = Vector::select(is_side, normal, axis.direction * end);
        Seen::new(point, normal, from).by_area(area)
    }
}

/// Returns the areas of the first end, the side and the second end.
#[inline(always)]
fn areas<R: Real>(axis: &ShapeAxis<R>) -> [R; 3] {
    let [from, to] = axis.radii;
    let (pi, two) = (from.splat(PI), from.splat(2.0));
    let (length, step) = (two * axis.half_length, from - to);
    [
        pi * from * from,
        pi * (from + to) * (length * length + step * step).sqrt(),
        pi * to * to,
    ]
}
