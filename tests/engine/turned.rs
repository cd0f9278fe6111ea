//! Cylinders, cones and capsules agree with models in double precision.

use glam::{DVec3, Vec3};
use proptest::prelude::*;

use crate::common::generators::{cases, direction};
use world::geometry::{Capsule, Cone, Cylinder, Intersectable, Ray, Shape};

/// A shape between two ends with a radius at each.
#[derive(Debug, Clone, Copy)]
struct Turned {
    kind: u32,
    ends: [Vec3; 2],
    radii: [f32; 2],
}

impl Turned {
    fn shape(&self) -> Shape {
        let Self { ends, radii, .. } = *self;
        match self.kind {
            0 => Shape::Cylinder(Cylinder::new(ends, radii[0])),
            1 => Shape::Cone(Cone::new(ends, radii)),
            2 => Shape::Cone(Cone::new(ends, [radii[0], 0.0])),
            _ => Shape::Capsule(Capsule::new(ends, radii)),
        }
    }

    /// The radii of the shape.
    fn radii(&self) -> [f64; 2] {
        let [from, to] = self.radii.map(f64::from);
        match self.kind {
            0 => [from, from],
            2 => [from, 0.0],
            _ => [from, to],
        }
    }

    /// A number that is negative within the shape, positive outside, and not larger than the
    /// distance from its surface.
    fn depth(&self, point: DVec3) -> f64 {
        let [a, b] = self.ends.map(|end| end.as_dvec3());
        let [r0, r1] = self.radii();
        if self.kind > 2 {
            // The union of spheres between the ends: the least of a convex function.
            let at = |s: f64| (point - a.lerp(b, s)).length() - (r0 + s * (r1 - r0));
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..200 {
                let third = (high - low) / 3.0;
                if at(low + third) < at(high - third) {
                    high -= third;
                } else {
                    low += third;
                }
            }
            return at(0.5 * (low + high));
        }
        let axis = (b - a).normalize();
        let length = (b - a).length();
        let along = (point - a).dot(axis);
        let across = (point - a - axis * along).length();
        let radius = r0 + (r1 - r0) * along / length;
        let slant = length / length.hypot(r1 - r0);
        ((across - radius) * slant).max(-along).max(along - length)
    }

    fn size(&self) -> f64 {
        let [a, b] = self.ends.map(|end| end.as_dvec3());
        (b - a).length() + self.radii()[0].max(self.radii()[1])
    }
}

fn turned() -> impl Strategy<Value = Turned> {
    let radius = || prop_oneof![3 => 0.1_f32..2.0, 1 => 0.001_f32..0.1];
    let length = prop_oneof![4 => 0.1_f32..5.0, 1 => 0.001_f32..0.1, 1 => 5.0_f32..300.0];
    let axis = prop_oneof![3 => direction(), 1 => Just(Vec3::Z)];
    (0..5_u32, axis, length, [radius(), radius()]).prop_map(|(kind, axis, length, radii)| Turned {
        kind,
        ends: [-0.5 * length * axis, 0.5 * length * axis],
        radii,
    })
}

proptest! {
    #![proptest_config(cases(2000))]

    /// A ray from anywhere hits the surface where it says, and nothing before.
    #[test]
    fn hits_are_where_a_model_in_double_precision_has_them(
        turned in turned(),
        at in [-1.2_f32..1.2, -1.0_f32..1.0, -1.0_f32..1.0],
        direction in prop_oneof![4 => direction(), 1 => Just(Vec3::Z), 1 => Just(Vec3::X)],
        back in prop_oneof![2 => 0.0_f32..3.0, 1 => 3.0_f32..3000.0],
        stretch in prop_oneof![Just(1.0_f32), Just(1e-3), Just(30.0)],
    ) {
        let [from, to] = turned.ends;
        let axis = to - from;
        let [u, v] = { let (u, v) = axis.normalize().any_orthonormal_pair(); [u, v] };
        let radius = turned.radii[0].max(turned.radii[1]);
        let target = 0.5 * at[0] * axis + radius * (at[1] * u + at[2] * v);
        let origin = target - back * direction;
        let ray = Ray { origin, direction: stretch * direction };
        let at_distance = |distance: f64| origin.as_dvec3() + distance * direction.as_dvec3();
        // What rounding may do.
        let reach = f64::from(origin.length()) + turned.size();
        let slack = 4e-6 * reach;
        let shape = turned.shape();
        let depths = |far: f64| (0..400).map(move |i| {
            let distance = far * (f64::from(i) + 0.5) / 400.0;
            turned.depth(at_distance(distance))
        });
        let is_inside = turned.depth(at_distance(0.0)) < 0.0;
        match shape.intersect(&ray, f32::INFINITY) {
            Some(t) => {
                let distance = f64::from(t * stretch);
                let point = at_distance(distance);
                prop_assert!(turned.depth(point).abs() < slack, "{}", turned.depth(point));
                for depth in depths(distance) {
                    prop_assert!(if is_inside { depth < slack } else { depth > -slack }, "{depth}");
                }
                let hit = ray.at(t);
                let (on_surface, normal) = shape.project(hit);
                let moved = on_surface.as_dvec3();
                prop_assert!(turned.depth(moved).abs() < slack, "{}", turned.depth(moved));
                prop_assert!(f64::from(on_surface.distance(hit)) < 3.0 * slack);
                prop_assert!((normal.length() - 1.0).abs() < 1e-5);
                // Outside along the normal, inside against it.
                let step = (1e-3 * f64::from(radius)).max(2.0 * slack);
                prop_assert!(turned.depth(moved + step * normal.as_dvec3()) > 0.1 * step - slack);
                let bounds = shape.bounds();
                let slack = slack as f32;
                prop_assert!(on_surface.cmpge(bounds.min - slack).all());
                prop_assert!(on_surface.cmple(bounds.max + slack).all());
            }
            None => {
                prop_assert!(!is_inside || turned.depth(at_distance(0.0)) > -slack);
                let far = f64::from(back) + 2.0 * turned.size();
                for depth in depths(far) {
                    prop_assert!(depth > -slack, "{depth}");
                }
            }
        }
    }

    /// No point outside of the bounds is near to the shape, and each bound is reached.
    #[test]
    fn bounds_are_tight(turned in turned()) {
        let bounds = turned.shape().bounds();
        let size = turned.size() as f32;
        let (min, max) = turned.shape().patch().unwrap().corners().iter().fold(
            (Vec3::INFINITY, Vec3::NEG_INFINITY),
            |(min, max), corner| (min.min(*corner), max.max(*corner)),
        );
        // A circle is drawn as a polygon.
        let radius = turned.radii[0].max(turned.radii[1]);
        prop_assert!((min - bounds.min).abs().max_element() < 0.15 * radius + 1e-5 * size);
        prop_assert!((max - bounds.max).abs().max_element() < 0.15 * radius + 1e-5 * size);
    }
}

#[test]
fn a_ray_parallel_to_the_axis_of_a_capsule_hits_only_its_ends() {
    let capsule = Capsule::new([Vec3::ZERO, 3.0 * Vec3::X], [1.0; 2]);
    let cap = 0.75_f32.sqrt();
    for (x, y, expected) in [
        (9.0, 2.0, None),
        (1.0, 2.0, None),
        (9.0, 0.5, Some(9.0 - 3.0 - cap)),
        (1.0, 0.5, Some(1.0 + cap)),
        (-2.0, 0.5, None),
    ] {
        let ray = Ray {
            origin: Vec3::new(x, y, 0.0),
            direction: Vec3::NEG_X,
        };
        let found = capsule.intersect(&ray, f32::INFINITY);
        assert_eq!(found.is_some(), expected.is_some(), "{x} {y}: {found:?}");
        let error = found.unwrap_or(0.0) - expected.unwrap_or(0.0);
        assert!(error.abs() < 1e-5, "{x} {y}: {found:?}");
    }
}

/// How far along a capsule a point is: where the sphere that touches it there has its center.
#[test]
fn the_fraction_along_a_capsule_is_that_of_the_touching_sphere() {
    let capsule = Capsule::new([Vec3::ZERO, Vec3::new(0.0, 0.0, 2.0)], [0.5, 0.25]);
    let parameters = Shape::Capsule(capsule).parameters();
    let sine = 0.125_f32;
    let normal = Vec3::new((1.0 - sine * sine).sqrt(), 0.0, sine);
    for fraction in [0.0, 0.25, 0.5, 1.0] {
        let center = Vec3::new(0.0, 0.0, 2.0 * fraction);
        let point = center + (0.5 - 0.25 * fraction) * normal;
        let found = Capsule::fraction(&parameters, point.into());
        assert!((found - fraction).abs() < 1e-6, "{found} {fraction}");
    }
    assert_eq!(
        Capsule::fraction(&parameters, Vec3::new(0.0, 0.0, -0.5).into()),
        0.0
    );
    assert_eq!(
        Capsule::fraction(&parameters, Vec3::new(0.1, 0.0, 2.3).into()),
        1.0
    );
}
