//! A refitted hierarchy finds the hits of brute force, however the primitives have moved.

use crate::common::generators::{cases, point, ray, shape};
use crate::common::twins::{QUALITIES, compare_built};
use glam::Vec3;
use proptest::prelude::*;
use scene::config::{Acceleration, Quality};
use tracer::accel::Accel;
use world::geometry::{Shape, Sphere, Transform, TransformStep, Triangle, world_from_object};
use world::scene::{MaterialId, ObjectId, Primitive};

/// A shape, where it moves in a unit of time, and the factor by which it grows.
type Moving = (Shape, Vec3, f32);

fn moving() -> impl Strategy<Value = Vec<Moving>> {
    prop::collection::vec((shape(), point(), 0.2_f32..3.0), 1..200)
}

fn primitive(shape: Shape, transform: Option<&Transform>) -> Primitive {
    Primitive::new(shape, transform, ObjectId(0), MaterialId(0))
}

/// The primitives at a time.
fn at(moving: &[Moving], time: f32) -> Vec<Primitive> {
    let moved = |(shape, velocity, growth): &Moving| {
        let factor = 1.0 + time.min(1.0) * (growth - 1.0);
        let steps = [
            TransformStep::Scale(Vec3::splat(factor)),
            TransformStep::Translate((time * *velocity).as_dvec3()),
        ];
        primitive(
            shape.clone(),
            Transform::new(&world_from_object(&steps)).as_ref(),
        )
    };
    moving.iter().map(moved).collect()
}

fn built(primitives: &[Primitive], quality: Quality) -> Accel<'_> {
    Accel::new(primitives, Acceleration::Bvh(quality))
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn all_find_the_same_hits_of_moved_primitives(
        moving in moving(),
        rays in prop::collection::vec(ray(), 40),
        time in prop_oneof![Just(0.0_f32), 0.0_f32..1.0, Just(50.0)],
    ) {
        let [first, moved] = [0.0, time].map(|time| at(&moving, time));
        compare_built(&moved, &rays, |quality| {
            let refitted = built(&first, quality).refitted(&moved);
            refitted.expect("they are as many, of the same kinds")
        })?;
    }

    #[test]
    fn refitting_twice_is_refitting_once(moving in moving()) {
        let [first, between, last] = [0.0, 0.5, 1.0].map(|time| at(&moving, time));
        for quality in QUALITIES {
            let first = built(&first, quality);
            let twice = first.refitted(&between).and_then(|accel| accel.refitted(&last));
            let once = first.refitted(&last);
            prop_assert!(twice.map(|accel| accel.index()) == once.map(|accel| accel.index()));
        }
    }

    #[test]
    fn whole_primitives_that_rest_keep_their_boxes(moving in moving()) {
        let primitives = at(&moving, 0.0);
        let accel = built(&primitives, Quality::Fast);
        let refitted = accel.refitted(&primitives).expect("they are the same");
        prop_assert_eq!(refitted.nodes(), accel.nodes());
    }
}

fn balls(n: u16) -> Vec<Primitive> {
    let center = |i| Vec3::new(f32::from(i), 0.0, 0.0);
    let radius = 0.6;
    let ball = |i| {
        let center = center(i);
        primitive(Shape::Sphere(Sphere { center, radius }), None)
    };
    (0..n).map(ball).collect()
}

#[test]
fn other_primitives_are_refused() {
    let first = balls(40);
    let mut others = first.clone();
    others[7] = primitive(
        Shape::Triangle(Triangle {
            vertices: [Vec3::ZERO, Vec3::X, Vec3::Y],
        }),
        None,
    );
    for quality in QUALITIES {
        let accel = built(&first, quality);
        assert!(accel.refitted(&balls(40)).is_some());
        for refused in [&balls(39), &balls(41), &others] {
            assert!(accel.refitted(refused).is_none());
        }
    }
    let brute_force = Accel::new(&first, Acceleration::BruteForce);
    assert!(brute_force.refitted(&first).is_none());
}

/// Large enough for subtrees that are refitted in parallel.
#[test]
fn threads_change_nothing() {
    let moving: Vec<Moving> = (0..60_000_u32)
        .map(|i| {
            let at = |k: u32| (i.wrapping_mul(k) % 997) as f32 / 10.0;
            let (center, radius) = (Vec3::new(at(7919), at(6007), at(4003)), 0.1);
            let velocity = Vec3::new(at(31), -at(37), at(41));
            (Shape::Sphere(Sphere { center, radius }), velocity, 1.0)
        })
        .collect();
    let [first, moved] = [0.0, 0.1].map(|time| at(&moving, time));
    let base = built(&first, Quality::Fast);
    let on = |n_threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
        let pool = pool.build().unwrap();
        pool.install(|| base.refitted(&moved)).unwrap()
    };
    let expected = on(1);
    for n_threads in [2, 5] {
        assert!(on(n_threads).index() == expected.index(), "{n_threads}");
    }
}
