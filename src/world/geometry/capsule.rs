//! Capsules: all points within a distance of a line segment, with a radius at each end.

use std::f32::consts::PI;

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::axis::{AxisRay, ChosenPart, EndKeys, Ends, ShapeAxis};
use super::located::{Described, Located};
use super::sampled::{Sampled, Seen, SurfaceSample, on_circle};
use super::sphere_equation::{SphereEquation, squared_length};
use super::{Aabb, Intersectable, N_PARAMETERS, Patch, Project, Ray, RayTest, Transform};
use crate::values;
use math::simd::{Mask, Real, Vector};

/// The smallest convex surface around two spheres: a cylinder or a cone with round ends.
///
/// ```
/// # use raycost_world::geometry::{Located, Capsule};
/// let pill: Located<Capsule> = scene::yaml::from_str("
/// { ends: [[-1, 0, 2], [1, 0, 2]], radius: 0.5 }
/// ").unwrap();
/// let thorn: Located<Capsule> = scene::yaml::from_str("
/// { ends: [[0, 0, 2], [0, 3, 2]], radius: [0.5, 0.1] }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capsule {
    /// The centers of the two ends, which differ.
    ends: Ends,
    /// The radii at the ends.
    radius: [f32; 2],
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CapsuleKeys {
    /// The centers of the two ends, which differ.
    ends: EndKeys,
    /// The radius, or one for each end.
    #[serde(with = "values::Radii")]
    radius: [f32; 2],
}

impl Described for Capsule {
    type Keys = CapsuleKeys;

    fn from_keys(CapsuleKeys { ends, radius }: CapsuleKeys) -> Result<Located<Self>, &'static str> {
        Ok(ends.ends.map(|ends| Self { ends, radius }))
    }
}

impl Capsule {
    /// Creates the capsule around spheres with these centers, which must differ, and radii.
    pub fn new(ends: [Vec3; 2], radii: [f32; 2]) -> Self {
        Self {
            ends: Ends(ends),
            radius: radii,
        }
    }

    /// Returns the position along the axis, from 0 to 1, of the surface point `near`: the center of
    /// the sphere that touches the surface there.
    #[inline(always)]
    pub fn fraction<R: Real>(parameters: &[R; N_PARAMETERS], near: Vector<R>) -> R {
        let axis = ShapeAxis::new(parameters);
        let half = axis.radius.splat(0.5);
        let (along, across) = axis.split(near);
        half + half * foot_on_axis(&axis, along, across) / axis.half_length
    }
}

/// Returns the sine and the cosine of the angle between the normals of a capsule's cone and of its
/// axis; if one sphere contains the other, of a flat cone.
#[inline(always)]
fn slant<R: Real>(axis: &ShapeAxis<R>) -> (R, R) {
    let one = axis.slope.splat(1.0);
    let sine = axis.slope.max(-one).min(one);
    (sine, (one - sine * sine).sqrt())
}

/// Returns the position on the axis of the center of the sphere that touches the surface nearest to
/// a point.
#[inline(always)]
fn foot_on_axis<R: Real>(axis: &ShapeAxis<R>, along: R, across: Vector<R>) -> R {
    let (sine, cos) = slant(axis);
    let cos = cos.max(cos.splat(f32::MIN_POSITIVE));
    let foot = along - sine * across.length() / cos;
    foot.max(-axis.half_length).min(axis.half_length)
}

/// Returns where a ray enters and leaves a sphere; infinities of the other sign for a miss.
#[inline(always)]
fn span<R: Real>(sphere: &SphereEquation<R>) -> [R; 2] {
    let (hits, (near, far)) = (sphere.hits(), sphere.roots());
    [
        R::select(hits, near, near.splat(f32::INFINITY)),
        R::select(hits, far, far.splat(f32::NEG_INFINITY)),
    ]
}

impl RayTest for Capsule {
    /// The capsule is the union of its two spheres and the cone between the circles where it
    /// touches them: a ray enters it where it first enters one of the three.
    #[inline(always)]
    fn hits<R: Real>(parameters: &[R; N_PARAMETERS], origin: Vector<R>, direction: Vector<R>) -> R {
        let axis = ShapeAxis::new(parameters);
        let [from, to] = axis.ends;
        let [from_radius, to_radius] = axis.radii;
        let zero = from_radius.splat(0.0);
        let (never, always) = (zero.splat(f32::INFINITY), zero.splat(f32::NEG_INFINITY));
        let (sine, cos) = slant(&axis);
        let ray = AxisRay::new(&axis, origin, direction);
        // Intersect the cone, between the circles where it touches the spheres.
        let cone = ray.cone(axis.radius, sine, cos);
        let lower = from_radius * sine - axis.half_length;
        let upper = to_radius * sine + axis.half_length;
        let (at_enter, at_exit) = (
            ray.along + ray.direction_along * cone.enter,
            ray.along + ray.direction_along * cone.exit,
        );
        // A ray parallel to the side does not cross it, and has no parameters there.
        let crosses = cone.hits & !(cone.a.equals(zero) & cone.b.equals(zero));
        let enters = crosses & lower.le(at_enter) & at_enter.le(upper);
        let exits = crosses & lower.le(at_exit) & at_exit.le(upper);
        let near = R::select(enters, ray.start + cone.enter, never);
        let far = R::select(exits, ray.start + cone.exit, always);
        // Most single rays miss all three, and the roots take the most time.
        let a = squared_length(direction);
        let from = SphereEquation::new(from - origin, from_radius * from_radius, direction, a);
        let to = SphereEquation::new(to - origin, to_radius * to_radius, direction, a);
        if (crosses | from.hits() | to.hits()).none() {
            return always;
        }
        // Intersect the spheres, and take the union of all three.
        let [near_from, far_from] = span(&from);
        let [near_to, far_to] = span(&to);
        let far = far.max(far_from).max(far_to);
        let near = near.min(near_from).min(near_to).min(far);
        R::select(zero.lt(near), near, far)
    }
}

impl Intersectable for Capsule {
    #[inline]
    fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        self.first_hit(ray, t_max)
    }

    fn bounds(&self) -> Aabb {
        let [from, to] = self.ends.0;
        let around = |center: Vec3, radius: f32| Aabb {
            min: center - radius,
            max: center + radius,
        };
        around(from, self.radius[0]).union(around(to, self.radius[1]))
    }

    fn transformed(&self, transform: &Transform) -> Option<Self> {
        let (ends, radius) = self.ends.transformed(self.radius, transform)?;
        Some(Self { ends, radius })
    }

    fn patch(&self) -> Option<Patch> {
        let axis = ShapeAxis::new(&self.parameters());
        let (sine, _) = slant(&axis);
        // The angle from the axis to the normals of the cone.
        let side = libm::acosf(sine);
        let round = |center: f32, radius: f32, angle: f32| {
            [center + radius * angle.cos(), radius * angle.sin()]
        };
        const N: usize = 3;
        let from = (0..=N).map(|i| {
            let angle = PI + (side - PI) * i as f32 / N as f32;
            round(-axis.half_length, axis.radii[0], angle)
        });
        let to = (0..=N).map(|i| {
            let angle = side - side * i as f32 / N as f32;
            round(axis.half_length, axis.radii[1], angle)
        });
        Some(Patch::turned(self.ends.0, from.chain(to)))
    }
}

impl Project for Capsule {
    #[inline(always)]
    fn parameters(&self) -> [f32; N_PARAMETERS] {
        self.ends.parameters(self.radius)
    }

    #[inline(always)]
    fn project_onto<R: Real>(
        parameters: &[R; N_PARAMETERS],
        near: Vector<R>,
    ) -> (Vector<R>, Vector<R>) {
        let axis = ShapeAxis::new(parameters);
        let (along, across) = axis.split(near);
        let foot = foot_on_axis(&axis, along, across);
        let normal = (across + axis.direction * (along - foot)).normalize_or(axis.outward(across));
        let half = foot.splat(0.5);
        let fraction = half + half * foot / axis.half_length;
        let [from, to] = axis.ends;
        let center = from + (to - from) * fraction;
        let radius = axis.radius - axis.slope * foot;
        (center + normal * radius, normal)
    }
}

impl Sampled for Capsule {
    #[inline(always)]
    fn area<R: Real>(parameters: &[R; N_PARAMETERS]) -> R {
        let [from, side, to] = areas(&ShapeAxis::new(parameters));
        from + side + to
    }

    /// Samples the surface uniformly: the first number selects one of the three parts.
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
        // The normal's component along the axis: uniform on the sphere at an end.
        let at_from = of_from * (one + sine) - one;
        let at_to = one - of_to * (one - sine);
        let along = R::select(is_side, sine, R::select(is_from, at_from, at_to));
        let outward = (one - along * along).max(zero).sqrt();
        let outward = R::select(is_side, cos, outward);
        let normal = axis.direction.around(on_circle(v, outward, along));
        let fraction = axis.fraction_by_area(of_side);
        let fraction = R::select(is_side, fraction, R::select(is_from, zero, one));
        let [begin, end] = axis.ends;
        let radius = axis.radii[0] + (axis.radii[1] - axis.radii[0]) * fraction;
        let point = begin + (end - begin) * fraction + normal * radius;
        Seen::new(point, normal, from).by_area(area)
    }
}

/// Returns the areas of the parts of the surface: first sphere, cone, second sphere.
#[inline(always)]
fn areas<R: Real>(axis: &ShapeAxis<R>) -> [R; 3] {
    let (sine, cos) = slant(axis);
    let one = sine.splat(1.0);
    let circle = sine.splat(2.0 * PI);
    let [from, to] = axis.radii;
    [
        circle * from * from * (one + sine),
        circle * (from + to) * axis.half_length * cos * cos,
        circle * to * to * (one - sine),
    ]
}
