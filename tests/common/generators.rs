//! Random rays and primitives, many of them degenerate.

use glam::Vec3;
use proptest::prelude::*;

use world::geometry::{Capsule, Ray, Shape, Sphere, Triangle};
use world::scene::{MaterialId, ObjectId, Primitive};

/// The settings of a property test: `default` cases, or as many as the environment asks for:
/// `PROPTEST_CASES=50000 cargo test --test engine rounding`.
pub fn cases(default: u32) -> ProptestConfig {
    let asked_for = std::env::var("PROPTEST_CASES").map(|n| n.parse().unwrap());
    ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::with_cases(asked_for.unwrap_or(default))
    }
}

/// A number, often one of a few round ones, so that some rays are parallel to
/// axes or pass through edges, and some primitives coincide.
pub fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        3 => -4.0_f32..4.0,
        1 => prop::sample::select(vec![-2.0_f32, -1.0, -0.5, -0.0, 0.0, 0.5, 1.0, 2.0]),
    ]
}

/// Three such numbers.
pub fn triple() -> impl Strategy<Value = [f32; 3]> {
    [coordinate(), coordinate(), coordinate()]
}

/// A point.
pub fn point() -> impl Strategy<Value = Vec3> {
    triple().prop_map(Vec3::from)
}

/// A unit vector, often parallel to an axis or to a plane of two axes, with zeros of
/// either sign.
pub fn direction() -> impl Strategy<Value = Vec3> {
    let any = point()
        .prop_filter("a direction has a length", |d| d.length() > 0.1)
        .prop_map(Vec3::normalize);
    let steps = prop::sample::select(vec![-1.0_f32, -0.0, 0.0, 1.0]);
    let round = prop::array::uniform3(steps)
        .prop_map(Vec3::from)
        .prop_filter("a direction has a length", |d| *d != Vec3::ZERO)
        .prop_map(Vec3::normalize);
    prop_oneof![3 => any, 1 => round]
}

/// A ray that starts between the primitives or far away.
pub fn ray() -> impl Strategy<Value = Ray> {
    let far_or_near = prop_oneof![4 => Just(1.0_f32), 1 => Just(100.0)];
    (point(), direction(), far_or_near).prop_map(|(origin, direction, scale)| Ray {
        origin: scale * origin,
        direction,
    })
}

/// Coherent rays: from a point, to a point, or parallel; some of them are equal.
pub fn bundle() -> impl Strategy<Value = Vec<Ray>> {
    let spread = || prop::sample::select(vec![0.0_f32, 1e-7, 1e-3, 0.02, 0.1, 0.5]);
    let offsets = prop::collection::vec([point(), point()], 16..40);
    (ray(), [spread(), spread()], offsets).prop_map(
        |(ray, [spread_origin, spread_direction], offsets)| {
            let near = |[offset, turn]: [Vec3; 2]| Ray {
                origin: ray.origin + spread_origin * offset,
                direction: match spread_direction {
                    // Equal to the last bit, including the signs of zeros.
                    0.0 => ray.direction,
                    _ => (ray.direction + spread_direction * 0.25 * turn).normalize(),
                },
            };
            offsets.into_iter().map(near).collect()
        },
    )
}

/// A sphere, a capsule or a triangle; some of them coincide.
pub fn shape() -> impl Strategy<Value = Shape> {
    let few = || prop_oneof![Just(0.5_f32), Just(1.0), 0.01_f32..2.0];
    prop_oneof![
        ([point(), point()], [few(), few()])
            .prop_filter("the ends differ", |([from, to], _)| from != to)
            .prop_map(|(ends, radii)| Shape::Capsule(Capsule::new(ends, radii))),
        (point(), few()).prop_map(|(center, radius)| Shape::Sphere(Sphere { center, radius })),
        [point(), point(), point()]
            .prop_filter("a triangle needs an area", |[a, b, c]| {
                (*b - *a).cross(*c - *a).length() > 1e-2
            })
            .prop_map(|vertices| Shape::Triangle(Triangle { vertices })),
    ]
}

/// A triangle of any size and shape: huge, tiny, thin, a line or a point.
pub fn awkward_triangle() -> impl Strategy<Value = Triangle> {
    let size = || prop::sample::select(vec![0.0_f32, 1e-7, 1e-5, 1e-3, 0.1, 1.0, 30.0, 1e5]);
    (point(), [point(), point()], [size(), size()]).prop_map(|(a, [b, c], [size_b, size_c])| {
        Triangle {
            vertices: [a, a + size_b * b, a + size_c * c],
        }
    })
}

/// A ray in the plane of a triangle, along an edge or through a vertex; or from a
/// point of the plane to anywhere.
pub fn ray_at(triangle: Triangle) -> impl Strategy<Value = Ray> {
    let weight = || prop_oneof![-1.0_f32..2.0, Just(0.0_f32), Just(0.5), Just(1.0)];
    let in_plane = [weight(), weight()].prop_map(move |[u, v]| {
        let [a, b, c] = triangle.vertices;
        a + u * (b - a) + v * (c - a)
    });
    (in_plane.clone(), in_plane, point(), 0..3).prop_filter_map(
        "a ray needs a direction",
        |(from, to, off, kind)| {
            let (origin, target) = match kind {
                0 => (from, to),
                1 => (off, to),
                _ => (from, off),
            };
            let direction = (target - origin).try_normalize()?;
            Some(Ray { origin, direction })
        },
    )
}

/// The shapes as primitives, which belong to objects 0, 1, 2, 0, 1, …
pub fn primitives(shapes: impl IntoIterator<Item = Shape>) -> Vec<Primitive> {
    let primitive = |(i, shape)| Primitive::new(shape, None, ObjectId(i % 3), MaterialId(0));
    (0_u32..).zip(shapes).map(primitive).collect()
}
