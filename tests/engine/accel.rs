//! The hierarchy finds the hits of brute force, on random scenes.

use crate::common::generators::{self, bundle, cases, ray, triple};
use crate::common::twins::{QUALITIES, compare};
use crate::common::{parse, scene_in_world};
use glam::{DAffine3, DVec3, Vec3};
use math::sampling::uniform;
use proptest::prelude::*;
use scene::config::{Acceleration, Quality};
use tracer::accel::Accel;
use tracer::cost::{Cost, NoProbe};
use world::geometry::{Ray, Shape, Sphere, Transform, TransformStep, Triangle, world_from_object};
use world::scene::{MaterialId, ObjectId, Primitive, Scene};

fn list([x, y, z]: [f32; 3]) -> String {
    format!("[{x}, {y}, {z}]")
}

/// One object of the scene file, without its material.
fn shape() -> impl Strategy<Value = String> {
    let radius = prop_oneof![0.01_f32..2.0, Just(1.0)];
    let size = [0.01_f32..2.0, 0.01_f32..2.0, 0.01_f32..2.0];
    prop_oneof![
        4 => (triple(), radius.clone())
            .prop_map(|(c, r)| format!("sphere: {{ center: {}, radius: {r} }}", list(c))),
        3 => (triple(), triple(), triple())
            .prop_filter("a triangle needs an area", |&(a, b, c)| {
                let [a, b, c] = [a, b, c].map(Vec3::from);
                (b - a).cross(c - a).length() > 1e-2
            })
            .prop_map(|(a, b, c)| {
                format!("triangle: {{ vertices: [{}, {}, {}] }}", list(a), list(b), list(c))
            }),
        2 => (triple(), size).prop_map(|(min, size)| {
            let max: [f32; 3] = std::array::from_fn(|i| min[i] + size[i]);
            format!("box: {{ min: {}, max: {} }}", list(min), list(max))
        }),
        2 => (triple(), triple(), radius)
            .prop_filter("a disk needs a normal", |(_, n, _)| Vec3::from(*n).length() > 0.1)
            .prop_map(|(c, n, r)| {
                format!("disk: {{ center: {}, normal: {}, radius: {r} }}", list(c), list(n))
            }),
        3 => (triple(), triple(), [0.01_f32..2.0, 0.01_f32..2.0], 0..3)
            .prop_filter("the ends differ", |(a, b, ..)| a != b)
            .prop_map(|(a, b, [from, to], kind)| {
                let ends = format!("ends: [{}, {}]", list(a), list(b));
                match kind {
                    0 => format!("cylinder: {{ {ends}, radius: {from} }}"),
                    1 => format!("cone: {{ {ends}, radius: [{from}, 0] }}"),
                    _ => format!("capsule: {{ {ends}, radius: [{from}, {to}] }}"),
                }
            }),
        1 => (triple(), triple())
            .prop_filter("a plane needs a normal", |(_, n)| Vec3::from(*n).length() > 0.1)
            .prop_map(|(p, n)| format!("plane: {{ point: {}, normal: {} }}", list(p), list(n))),
    ]
}

/// No transform, or one that makes ellipsoids of spheres and rotates boxes.
fn transform() -> impl Strategy<Value = String> {
    let steps = (
        [0.3_f32..3.0, 0.3_f32..3.0, 0.3_f32..3.0],
        0.0_f32..360.0,
        triple(),
    );
    let transformed = steps.prop_map(|(scale, angle, by)| {
        format!(
            "\n    transform: [{{ scale: {} }}, {{ rotate: {{ axis: [1, 2, 3], angle_deg: {angle} }} }}, {{ translate: {} }}]",
            list(scale),
            list(by)
        )
    });
    prop_oneof![Just(String::new()), transformed]
}

fn scene() -> impl Strategy<Value = Scene> {
    prop::collection::vec((shape(), transform()), 1..60).prop_map(|objects| {
        let objects: String = objects
            .iter()
            .map(|(shape, transform)| format!("  - {shape}\n    material: m{transform}\n"))
            .collect();
        let text = format!(
            "image: {{ width: 1, height: 1 }}\n\
             camera: {{ look_at: {{ eye: [0, 0, 9], target: [0, 0, 0], fov_y_deg: 40 }} }}\n\
             materials: {{ m: {{ color: 1 }} }}\nlights: []\nobjects:\n{objects}"
        );
        scene_in_world(&parse(&text))
    })
}

fn primitive(shape: Shape) -> Primitive {
    Primitive::new(shape, None, ObjectId(0), MaterialId(0))
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn all_find_the_same_hits(scene in scene(), rays in prop::collection::vec(ray(), 40)) {
        compare(&scene.primitives, &rays)?;
    }

    #[test]
    fn all_find_the_same_hits_of_coherent_rays(scene in scene(), rays in bundle()) {
        compare(&scene.primitives, &rays)?;
    }

    /// From points on surfaces, or as far from them as the renderer starts rays.
    #[test]
    fn all_find_the_same_hits_of_rays_from_surfaces(scene in scene(), rays in prop::collection::vec(ray(), 40)) {
        let brute = Accel::new(&scene, Acceleration::BruteForce);
        let from_hit = |(ray, next): (&Ray, &Ray)| {
            let hit = brute.nearest(ray, &mut NoProbe)?;
            let primitive = &scene.primitives[hit.primitive as usize];
            let (position, normal) = primitive.project(ray.at(hit.t));
            let at = [position, normal];
            let leaving = |error| Ray::leaving(at, error, next.direction);
            Some([leaving(0.0), leaving(primitive.rounding(at))])
        };
        let rays: Vec<Ray> = rays.iter().zip(&rays[1..]).filter_map(from_hit).flatten().collect();
        compare(&scene.primitives, &rays)?;
    }

    #[test]
    fn all_find_the_same_hits_at_any_scale(
        shapes in prop::collection::vec(generators::shape(), 1..100),
        rays in prop::collection::vec(ray(), 40),
        exponent in -12_i32..13,
    ) {
        let scale = 10_f32.powi(exponent);
        let transform = Transform::new(&DAffine3::from_scale(DVec3::splat(scale.into())));
        let scaled = |shape| Primitive::new(shape, transform.as_ref(), ObjectId(0), MaterialId(0));
        let primitives: Vec<Primitive> = shapes.into_iter().map(scaled).collect();
        let scaled = |ray: Ray| Ray { origin: scale * ray.origin, ..ray };
        let rays: Vec<Ray> = rays.into_iter().map(scaled).collect();
        compare(&primitives, &rays)?;
    }

    #[test]
    fn probes_change_no_hit(scene in scene(), ray in ray()) {
        let is_plane = |primitive: &&Primitive| primitive.is_unbounded();
        let n_planes = scene.primitives.iter().filter(is_plane).count();
        for quality in QUALITIES {
            let bvh = Accel::new(&scene, Acceleration::Bvh(quality));
            let mut cost = Cost::default();
            prop_assert_eq!(bvh.nearest(&ray, &mut cost), bvh.nearest(&ray, &mut NoProbe));
            let statistics = bvh.statistics().unwrap();
            prop_assert!(cost.node_visits <= statistics.n_nodes as u64);
            prop_assert!(cost.primitive_tests <= (n_planes + statistics.n_references) as u64);
        }
    }
}

fn spheres(text: &str) -> Scene {
    let text = format!(
        "image: {{ width: 1, height: 1 }}\n\
         camera: {{ look_at: {{ eye: [0, 0, 9], target: [0, 0, 0], fov_y_deg: 40 }} }}\n\
         materials: {{ m: {{ color: 1 }} }}\nlights: []\nobjects:\n{text}"
    );
    scene_in_world(&parse(&text))
}

/// Thousands of spheres at one point: no plane separates their centers, so that
/// the build has to halve them, and the depth has to stay bounded.
#[test]
fn coincident_spheres_make_a_shallow_tree() {
    let scene = spheres(
        "  - sphere_grid: { counts: [20000, 1, 1], min: [1, 1, 1], max: [1, 1, 1], radius: 0.5 }\n    material: m\n",
    );
    let bvh = Accel::new(&scene, Acceleration::default());
    let statistics = bvh.statistics().unwrap();
    assert!(statistics.depth <= 20, "{statistics:?}");
    let ray = Ray {
        origin: Vec3::new(1.0, 1.0, 5.0),
        direction: -Vec3::Z,
    };
    let hit = bvh.nearest(&ray, &mut NoProbe).unwrap();
    assert_eq!((hit.t, hit.primitive), (3.5, 0));
}

/// Radii and gaps that double: the worst case for the depth of a tree built by
/// the surface area heuristic.
#[test]
fn every_sphere_of_a_geometric_series_is_hit() {
    let objects: String = (-40..40)
        .map(|i| {
            let x = 2.0_f64.powi(i);
            format!(
                "  - sphere: {{ center: [{x:e}, 0, 0], radius: {:e} }}\n    material: m\n",
                x / 8.0
            )
        })
        .collect();
    let scene = spheres(&objects);
    let bvh = Accel::new(&scene, Acceleration::default());
    let brute = Accel::new(&scene, Acceleration::BruteForce);
    for i in -40..40 {
        let x = 2.0_f32.powi(i);
        let ray = Ray {
            origin: Vec3::new(x, x, 0.0),
            direction: -Vec3::Y,
        };
        let hit = brute.nearest(&ray, &mut NoProbe);
        assert_eq!(hit.unwrap().primitive, (i + 40) as u32);
        assert_eq!(bvh.nearest(&ray, &mut NoProbe), hit);
    }
}

/// Thin triangles in all directions, most of whose boxes are empty.
fn needles(n: u64) -> Vec<Primitive> {
    let needle = |i| {
        let point = |corner| {
            let [x, y, z, _] = uniform([5, i, corner]);
            Vec3::new(x, y, z)
        };
        let [from, along, across] = [0, 1, 2].map(point);
        let along = 0.2 * (along - 0.5);
        let vertices = [from, from + along, from + 0.001 * across];
        primitive(Shape::Triangle(Triangle { vertices }))
    };
    (0..n).map(needle).collect()
}

#[test]
fn better_quality_means_less_cost_and_fewer_tests() {
    let primitives = needles(20_000);
    let rays: Vec<Ray> = (0..500)
        .map(|i| {
            let [x, y, u, v] = uniform([6, i, 0]);
            let origin = Vec3::new(x, y, 2.0);
            let direction = (Vec3::new(u, v, 0.0) - origin).normalize();
            Ray { origin, direction }
        })
        .collect();
    let measure = |quality| {
        let bvh = Accel::new(&primitives, Acceleration::Bvh(quality));
        let mut cost = Cost::default();
        for ray in &rays {
            bvh.nearest(ray, &mut cost);
        }
        (bvh.statistics().unwrap(), cost)
    };
    let [fast, balanced, high] = QUALITIES.map(measure);
    assert_eq!(fast.0.n_references, primitives.len());
    for (worse, better) in [(fast, balanced), (fast, high)] {
        assert!(better.0.sah_cost < worse.0.sah_cost, "{better:?} {worse:?}");
        assert!(
            better.1.primitive_tests < worse.1.primitive_tests,
            "{better:?} {worse:?}"
        );
    }
}

#[test]
fn the_leaf_cost_is_the_sum_over_leaves() {
    let primitives = needles(2_000);
    for quality in QUALITIES {
        let accel = Accel::new(&primitives, Acceleration::Bvh(quality));
        let leaves = accel.nodes().into_iter().filter(|node| node.is_leaf);
        let sum: f64 = leaves.map(|leaf| f64::from(leaf.sah_cost)).sum();
        let found = f64::from(accel.statistics().unwrap().leaf_cost);
        assert!((found - sum).abs() < 1e-5 * sum, "{found} {sum}");
    }
}

/// The parallel build does not depend on the threads.
#[test]
fn the_tree_is_the_same_on_any_number_of_threads() {
    let scene = spheres(
        "  - sphere_cloud: { count: 100000, min: [-1, -1, -1], max: [1, 1, 1], radius: [0.001, 0.02], seed: 3 }\n    material: m\n",
    );
    for (primitives, quality) in [
        (scene.primitives, Quality::Fast),
        (ellipsoids(20_000), Quality::Fast),
        (needles(70_000), Quality::Balanced),
        (needles(10_000), Quality::High),
    ] {
        let tree = |n_threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
            let build = || Accel::new(&primitives, Acceleration::Bvh(quality));
            pool.build().unwrap().install(build)
        };
        let one = tree(1);
        for n_threads in [2, 5] {
            assert!(one.index() == tree(n_threads).index(), "{quality:?}");
        }
        let statistics = one.statistics().unwrap();
        // The check of the available memory assumes this.
        assert!(statistics.bytes / primitives.len() < 128, "{statistics:?}");
    }
}

/// Ellipsoids, which the kernel tests one by one.
fn ellipsoids(n: u64) -> Vec<Primitive> {
    let stretch = TransformStep::Scale(Vec3::new(1.0, 2.0, 3.0));
    let transform = Transform::new(&world_from_object(&[stretch]));
    let ellipsoid = |i| {
        let [x, y, z, size] = uniform([8, i, 0]);
        let sphere = Sphere {
            center: Vec3::new(x, y, z),
            radius: 0.01 + 0.02 * size,
        };
        let shape = Shape::Sphere(sphere);
        Primitive::new(shape, transform.as_ref(), ObjectId(0), MaterialId(0))
    };
    (0..n).map(ellipsoid).collect()
}
