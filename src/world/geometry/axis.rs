//! The axis of a shape between two ends with a radius each, and rays in its coordinates.
//!
//! The formulas of cones in the coordinates of such a ray: a point is `y` along the axis from the
//! center and `across` it, and so is the direction.

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::located::{Located, located};
use super::surface::{parameters_of, vector};
use super::{N_PARAMETERS, Transform};
use crate::values;
use math::simd::{Real, Vector};

/// Two distinct points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ends(pub(super) [Vec3; 2]);

/// Two distinct points: `[[x, y, z], [x, y, z]]`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(try_from = "TwoPoints", into = "TwoPoints")]
pub(super) struct EndKeys {
    points: TwoPoints,
    pub(super) ends: Located<Ends>,
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transform = values::expected::<Self>))]
#[cfg_attr(feature = "schema", schemars(with = "[values::Point; 2]"))]
#[serde(expecting = "two ends: [[x, y, z], [x, y, z]]")]
struct TwoPoints(
    #[serde(with = "values::Point")] DVec3,
    #[serde(with = "values::Point")] DVec3,
);

impl TryFrom<TwoPoints> for EndKeys {
    type Error = &'static str;

    fn try_from(points: TwoPoints) -> Result<Self, Self::Error> {
        let TwoPoints(from, to) = points;
        let ends = located([from, to]);
        let [first, second] = ends.geometry;
        if (second - first).length() > 0.0 {
            let ends = ends.map(Ends);
            Ok(Self { points, ends })
        } else {
            Err("cannot be without a length, expected two different ends")
        }
    }
}

impl From<EndKeys> for TwoPoints {
    fn from(keys: EndKeys) -> Self {
        keys.points
    }
}

impl Ends {
    /// Transforms the ends and the radii by a transform that scales all lengths equally.
    pub(super) fn transformed<const N: usize>(
        self,
        radii: [f32; N],
        transform: &Transform,
    ) -> Option<(Self, [f32; N])> {
        let scale = transform.uniform_scale()?;
        let ends = self.0.map(|end| transform.world_point(end));
        Some((Self(ends), radii.map(|radius| scale * radius)))
    }

    /// Returns the numbers that define the shape.
    #[inline(always)]
    pub(super) fn parameters(self, [from, to]: [f32; 2]) -> [f32; N_PARAMETERS] {
        let mut parameters = parameters_of(&self.0);
        (parameters[6], parameters[7]) = (from, to);
        parameters
    }
}

/// The axis of a shape, or one per lane.
#[derive(Clone, Copy)]
pub(super) struct ShapeAxis<R> {
    pub(super) ends: [Vector<R>; 2],
    /// The radii at the ends.
    pub(super) radii: [R; 2],
    /// The unit vector from the first end to the second.
    pub(super) direction: Vector<R>,
    pub(super) half_length: R,
    /// The decrease of the radius per length along the axis.
    pub(super) slope: R,
    /// The mean of the radii.
    pub(super) radius: R,
}

impl<R: Real> ShapeAxis<R> {
    #[inline(always)]
    pub(super) fn new(parameters: &[R; N_PARAMETERS]) -> Self {
        let ends = [vector(parameters, 0), vector(parameters, 3)];
        let [from, to] = ends;
        let radii = [parameters[6], parameters[7]];
        let (half, along) = (radii[0].splat(0.5), to - from);
        let length = along.length().max(half.splat(f32::MIN_POSITIVE));
        Self {
            ends,
            radii,
            direction: along.normalize_or(Vector::splat(half, Vec3::Y)),
            half_length: half * length,
            slope: (radii[0] - radii[1]) / length,
            radius: half * (radii[0] + radii[1]),
        }
    }

    /// Splits a point relative to the center into its parts along the axis and across it.
    #[inline(always)]
    pub(super) fn split(&self, point: Vector<R>) -> (R, Vector<R>) {
        let half = self.radius.splat(0.5);
        let [from, to] = self.ends;
        let from_center = ((point - from) + (point - to)) * half;
        let along = from_center.dot(self.direction);
        (along, from_center - self.direction * along)
    }

    /// Maps uniform numbers in [0, 1) to the position along the axis, from 0 to 1, of points that
    /// are uniform on the side.
    #[inline(always)]
    pub(super) fn fraction_by_area(&self, number: R) -> R {
        let [from, to] = self.radii;
        let least = number.splat(f32::MIN_POSITIVE);
        // The squared radius is linear in the number.
        let squared = from * from + (to * to - from * from) * number;
        number * (from + to) / (squared.max(number.splat(0.0)).sqrt() + from).max(least)
    }

    /// Returns the unit direction of a vector across the axis, whatever its length.
    #[inline(always)]
    pub(super) fn outward(&self, across: Vector<R>) -> Vector<R> {
        let [any, _] = self.direction.orthonormal_pair();
        across.normalize_or(any)
    }
}

/// A ray in the coordinates of an axis.
pub(super) struct AxisRay<R> {
    /// The parameter of the ray at the origin of these coordinates.
    pub(super) start: R,
    pub(super) along: R,
    pub(super) across: Vector<R>,
    pub(super) direction_along: R,
    pub(super) direction_across: Vector<R>,
}

/// Minimum squared sine of the angle between a ray and an axis: smaller ones are rounding errors.
const MIN_SINE_SQUARED: f32 = 1e-14;

impl<R: Real> AxisRay<R> {
    /// Creates the ray, starting from its point nearest to the axis or one near the shape, so that
    /// its numbers have the magnitude of the shape, however far away the ray begins (as in
    /// [`Sphere`](super::Sphere)).
    #[inline(always)]
    pub(super) fn new(axis: &ShapeAxis<R>, origin: Vector<R>, direction: Vector<R>) -> Self {
        let (half, one) = (axis.radius.splat(0.5), axis.radius.splat(1.0));
        let [from, to] = axis.ends;
        // Find the ray's point nearest to the center.
        let to_center = ((from - origin) + (to - origin)) * half;
        let squared = direction.dot(direction);
        let inverse = one / squared;
        let nearest = to_center.dot(direction) * inverse;
        let point = direction * nearest - to_center;
        // Split point and direction into their parts along the axis and across it.
        let (along, direction_along) = (point.dot(axis.direction), direction.dot(axis.direction));
        let across = point - axis.direction * along;
        let direction_across = direction - axis.direction * direction_along;
        // Step to the point nearest to the axis, but not beyond the shape's reach.
        let least = squared * one.splat(MIN_SINE_SQUARED);
        let reach = (axis.half_length + axis.radii[0].max(axis.radii[1])) * inverse.sqrt();
        let step = across.dot(direction_across) / direction_across.dot(direction_across).max(least);
        let step = (-step).max(-reach).min(reach);
        Self {
            start: nearest + step,
            along: along + direction_along * step,
            across: across + direction_across * step,
            direction_along,
            direction_across,
        }
    }

    /// Intersects the ray with the infinite double cone of the points at a distance of at most
    /// `(radius - sine * y) / cos` from the axis; `cos` and `sine` belong to the angle between the
    /// cone's normals and the axis' normals.
    #[inline(always)]
    pub(super) fn cone(&self, radius: R, sine: R, cos: R) -> ConeSpan<R> {
        let zero = radius.splat(0.0);
        let (o, d) = (self.across * cos, self.direction_across * cos);
        let at_origin = radius - sine * self.along;
        let growth = -(sine * self.direction_along);
        // The squared distance to the axis minus the squared one to the surface, as a t² + 2 b t +
        // c.
        let a = d.dot(d) - growth * growth;
        let b = o.dot(d) - at_origin * growth;
        let c = o.dot(o) - at_origin * at_origin;
        // b² - a c, by Lagrange's identity without differences of large squares.
        let (inward, beside) = (d * at_origin - o * growth, o.cross(d));
        let discriminant = inward.dot(inward) - beside.dot(beside);
        // Solve the quadratic without cancellation.
        let root = discriminant.max(zero).sqrt();
        let is_ascending = zero.le(b);
        let q = R::select(is_ascending, -(b + root), root - b);
        let by_a = q / a;
        let by_c = R::select(q.equals(zero), zero, c / q);
        ConeSpan {
            enter: R::select(is_ascending, by_a, by_c),
            exit: R::select(is_ascending, by_c, by_a),
            hits: zero.le(discriminant),
            a,
            b,
            c,
            growth,
        }
    }
}

/// The intersection of a ray with a double cone.
pub(super) struct ConeSpan<R: Real> {
    pub(super) enter: R,
    pub(super) exit: R,
    /// True if the ray meets the surface.
    pub(super) hits: R::Mask,
    /// The coefficients of the quadratic: the ray is in the cone where it is negative.
    pub(super) a: R,
    pub(super) b: R,
    pub(super) c: R,
    /// The growth of the cone's radius along the ray.
    pub(super) growth: R,
}

/// The part of a surface that a number in [0, 1) samples in proportion to the areas: the first end,
/// the side or the second end.
pub(super) struct ChosenPart<R: Real> {
    /// The total area.
    pub(super) area: R,
    pub(super) is_from: R::Mask,
    pub(super) is_side: R::Mask,
    /// For each part, a number in [0, 1) that is uniform if the part is sampled.
    pub(super) shares: [R; 3],
}

impl<R: Real> ChosenPart<R> {
    #[inline(always)]
    pub(super) fn by_area([from, side, to]: [R; 3], number: R) -> Self {
        let area = from + side + to;
        let chosen = number * area;
        let is_from = chosen.lt(from);
        let is_to = (from + side).le(chosen);
        Self {
            area,
            is_from,
            is_side: !is_from & !is_to,
            shares: [chosen / from, (chosen - from) / side, (area - chosen) / to],
        }
    }
}
