//! The hierarchy against its slow twin: the same hits on random scenes.

mod common;

use common::{parse, scene_of};
use glam::Vec3;
use proptest::prelude::*;
use raycost::accel::{Accel, Simd};
use raycost::config::{Acceleration, Quality};
use raycost::cost::{Cost, NoProbe};
use raycost::geometry::{Ray, Shape, Sphere, Transform, TransformStep, Triangle};
use raycost::sampling::uniform;
use raycost::scene::{MaterialId, ObjectId, Primitive, Scene};

const QUALITIES: [Quality; 3] = [Quality::Fast, Quality::Balanced, Quality::High];

/// A number that is often one of a few round ones, so that rays run along
/// axes and through edges, and primitives coincide.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        3 => -4.0_f32..4.0,
        1 => prop::sample::select(vec![-2.0_f32, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0]),
    ]
}

fn triple() -> impl Strategy<Value = [f32; 3]> {
    [coordinate(), coordinate(), coordinate()]
}

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
        1 => (triple(), triple())
            .prop_filter("a plane needs a normal", |(_, n)| Vec3::from(*n).length() > 0.1)
            .prop_map(|(p, n)| format!("plane: {{ point: {}, normal: {} }}", list(p), list(n))),
    ]
}

/// A transform that makes ellipsoids and turned boxes of half of the shapes.
fn transform() -> impl Strategy<Value = String> {
    let steps = (
        [0.3_f32..3.0, 0.3_f32..3.0, 0.3_f32..3.0],
        0.0_f32..360.0,
        triple(),
    );
    let turned = steps.prop_map(|(scale, angle, by)| {
        format!(
            "\n    transform: [{{ scale: {} }}, {{ rotate: {{ axis: [1, 2, 3], angle_deg: {angle} }} }}, {{ translate: {} }}]",
            list(scale),
            list(by)
        )
    });
    prop_oneof![Just(String::new()), turned]
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
        scene_of(&parse(&text))
    })
}

fn ray() -> impl Strategy<Value = Ray> {
    let far_or_near = prop_oneof![4 => Just(1.0_f32), 1 => Just(100.0)];
    (triple(), triple(), far_or_near)
        .prop_filter("a ray needs a direction", |(_, d, _)| {
            Vec3::from(*d).length() > 0.1
        })
        .prop_map(|(origin, direction, scale)| Ray {
            origin: scale * Vec3::from(origin),
            direction: Vec3::from(direction).normalize(),
        })
}

/// A sphere or a triangle, often one of a few, so that some coincide.
fn bare_primitive() -> impl Strategy<Value = Shape> {
    let few = prop_oneof![Just(0.5_f32), Just(1.0), 0.01_f32..2.0];
    prop_oneof![
        (triple(), few).prop_map(|(center, radius)| {
            let center = center.into();
            Shape::Sphere(Sphere { center, radius })
        }),
        [triple(), triple(), triple()]
            .prop_map(|vertices| vertices.map(Vec3::from))
            .prop_filter("a triangle needs an area", |[a, b, c]| {
                (*b - *a).cross(*c - *a).length() > 1e-2
            })
            .prop_map(|vertices| Shape::Triangle(Triangle { vertices })),
    ]
}

/// Three corners that a builder may stumble over: those of a needle, of a
/// sheet along an axis, of something huge, of a line or of a point.
fn awkward_vertices() -> impl Strategy<Value = [Vec3; 3]> {
    let vector = || triple().prop_map(Vec3::from);
    let width = prop::sample::select(vec![0.0_f32, 1e-6, 1e-3, 0.1]);
    let length = prop::sample::select(vec![0.0_f32, 0.1, 1.0, 20.0, 1000.0]);
    prop_oneof![
        4 => (vector(), vector(), vector(), width, length).prop_map(
            |(from, along, across, width, length)| {
                [from, from + length * along, from + width * across]
            }
        ),
        1 => (vector(), triple(), 0_usize..3).prop_map(|(from, [x, y, _], axis)| {
            let (mut b, mut c) = (from, from);
            b[(axis + 1) % 3] += 3.0 * x;
            c[(axis + 2) % 3] += y;
            [from, b, c]
        }),
    ]
}

/// The hierarchies of each quality on every instruction set of this machine.
fn builds(primitives: &[Primitive]) -> Vec<Vec<Accel<'_>>> {
    let kernels = |quality| {
        let built = Accel::new(primitives, Acceleration::Bvh(quality));
        let on = |simd| built.clone().with_simd(simd);
        Simd::available().into_iter().map(on).collect()
    };
    QUALITIES.into_iter().map(kernels).collect()
}

fn brute_force(primitives: &[Primitive]) -> Accel<'_> {
    Accel::new(primitives, Acceleration::BruteForce)
}

fn primitive(shape: Shape) -> Primitive {
    Primitive::new(shape, None, ObjectId(0), MaterialId(0))
}

/// All qualities and kernels give the answers of brute force.
fn compare(builds: &[Vec<Accel>], brute: &Accel, ray: &Ray) -> Result<(), TestCaseError> {
    builds
        .iter()
        .try_for_each(|kernels| compare_kernels(kernels, brute, ray))
}

/// All kernels give the answers of brute force and the counters of the first
/// one.
fn compare_kernels(kernels: &[Accel], brute: &Accel, ray: &Ray) -> Result<(), TestCaseError> {
    let costs = |answer: &dyn Fn(&Accel, &mut Cost)| -> Vec<Cost> {
        let mut costs = vec![Cost::default(); kernels.len()];
        for (kernel, cost) in kernels.iter().zip(&mut costs) {
            answer(kernel, cost);
        }
        costs
    };
    let expected = brute.nearest(ray, &mut NoProbe);
    let all = costs(&|kernel, cost| assert_eq!(kernel.nearest(ray, cost), expected));
    prop_assert!(all.iter().all(|cost| *cost == all[0]), "{all:?}");
    for t_max in [f32::INFINITY, 2.0] {
        for ignored in [None, Some(ObjectId(0))] {
            let expected = brute.occluded(ray, t_max, ignored, &mut NoProbe);
            let all = costs(&|kernel, cost| {
                assert_eq!(kernel.occluded(ray, t_max, ignored, cost), expected);
            });
            prop_assert!(all.iter().all(|cost| *cost == all[0]), "{all:?}");
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..Default::default() })]

    #[test]
    fn all_find_the_same_hits(scene in scene(), rays in prop::collection::vec(ray(), 40)) {
        let builds = builds(&scene.primitives);
        let brute = brute_force(&scene.primitives);
        for ray in rays {
            compare(&builds, &brute, &ray)?;
        }
    }

    #[test]
    fn all_find_the_same_hits_at_any_scale(
        primitives in prop::collection::vec(bare_primitive(), 1..200),
        rays in prop::collection::vec(ray(), 20),
        exponent in -12_i32..13,
    ) {
        let scale = 10_f32.powi(exponent);
        let transform = Transform::of_steps(&[TransformStep::Scale(Vec3::splat(scale))]);
        let scaled = |shape| Primitive::new(shape, transform.as_ref(), ObjectId(0), MaterialId(0));
        let primitives: Vec<Primitive> = primitives.into_iter().map(scaled).collect();
        let builds = builds(&primitives);
        let brute = brute_force(&primitives);
        for ray in rays {
            let origin = scale * ray.origin;
            compare(&builds, &brute, &Ray { origin, ..ray })?;
            for direction in [Vec3::X, -Vec3::Y, Vec3::new(-0.0, 0.0, -1.0), Vec3::new(0.6, -0.0, 0.8)] {
                compare(&builds, &brute, &Ray { origin, direction })?;
            }
        }
    }

    #[test]
    fn all_find_the_same_hits_on_awkward_triangles(
        vertices in prop::collection::vec(awkward_vertices(), 1..150),
        rays in prop::collection::vec(ray(), 20),
    ) {
        let triangle = |vertices| primitive(Shape::Triangle(Triangle { vertices }));
        let primitives: Vec<Primitive> = vertices.into_iter().map(triangle).collect();
        let builds = builds(&primitives);
        let brute = brute_force(&primitives);
        for ray in rays {
            compare(&builds, &brute, &ray)?;
            for direction in [Vec3::X, -Vec3::Y, Vec3::Z] {
                compare(&builds, &brute, &Ray { direction, ..ray })?;
            }
        }
    }

    #[test]
    fn probes_change_no_hit(scene in scene(), ray in ray()) {
        let is_plane = |primitive: &&Primitive| primitive.is_unbounded();
        let n_planes = scene.primitives.iter().filter(is_plane).count();
        for quality in QUALITIES {
            let bvh = Accel::new(&scene.primitives, Acceleration::Bvh(quality));
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
    scene_of(&parse(&text))
}

/// Thousands of spheres at one point: no plane parts their centres, so the
/// builder has to halve them, and its depth has to stay bounded.
#[test]
fn coincident_spheres_make_a_shallow_tree() {
    let scene = spheres(
        "  - sphere_grid: { counts: [20000, 1, 1], min: [1, 1, 1], max: [1, 1, 1], radius: 0.5 }\n    material: m\n",
    );
    let bvh = Accel::new(&scene.primitives, Acceleration::default());
    let statistics = bvh.statistics().unwrap();
    assert!(statistics.depth <= 20, "{statistics:?}");
    let ray = Ray {
        origin: Vec3::new(1.0, 1.0, 5.0),
        direction: -Vec3::Z,
    };
    let hit = bvh.nearest(&ray, &mut NoProbe).unwrap();
    assert_eq!((hit.t, hit.primitive), (3.5, 0));
}

/// Radii and gaps that double: the worst case for the depth of a tree built
/// by cost.
#[test]
fn a_geometric_series_of_spheres_is_found_whole() {
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
    let bvh = Accel::new(&scene.primitives, Acceleration::default());
    let brute = Accel::new(&scene.primitives, Acceleration::BruteForce);
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

/// Needles of all directions, which fill their boxes least.
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

/// The parallel build makes no choice by thread.
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
        assert!(one == tree(2) && one == tree(5), "{quality}");
        let statistics = one.statistics().unwrap();
        // As the check of the memory assumes.
        assert!(statistics.bytes / primitives.len() < 128, "{statistics:?}");
    }
}

/// Ellipsoids, which are tested one by one.
fn ellipsoids(n: u64) -> Vec<Primitive> {
    let stretch = TransformStep::Scale(Vec3::new(1.0, 2.0, 3.0));
    let transform = Transform::of_steps(&[stretch]);
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
