//! A mirrored object looks as the object does in a mirror.

use glam::Vec3;
use proptest::prelude::*;

use crate::common::generators::{cases, direction};
use crate::common::{mean, parse, radiance, scene_in_world};
use tracer::accel::Accel;
use tracer::cost::{NoProbe, RayKind};
use tracer::trace::{SurfacePoint, Tracer};
use world::geometry::{Patch, Ray};
use world::scene::Scene;

/// One object of each kind, about as large as the unit sphere.
const OBJECTS: [&str; 13] = [
    "sphere: { center: [0.1, 0, 0], radius: 0.8 }",
    "box: { min: [-0.7, -0.5, -0.6], max: [0.6, 0.7, 0.5] }",
    "disk: { center: [0, 0, 0.2], normal: [1, 2, 3], radius: 0.9 }",
    "triangle: { vertices: [[-0.9, -0.8, 0], [0.9, -0.6, 0.3], [0.1, 0.9, 0]] }",
    "rectangle: { corner: [-0.8, -0.7, 0.1], edges: [[1.5, 0.2, 0], [0.3, 1.3, 0.4]] }",
    "plane: { point: [0, -0.2, 0], normal: [0.2, 1, 0.3] }",
    "cylinder: { ends: [[-0.5, -0.6, 0], [0.3, 0.7, 0.2]], radius: 0.4 }",
    "cone: { ends: [[-0.5, -0.6, 0], [0.3, 0.7, 0.2]], radius: [0.6, 0.2] }",
    "capsule: { ends: [[-0.3, -0.4, 0], [0.3, 0.5, 0.2]], radius: 0.4 }",
    "mesh: { file: meshes/spot.obj, normals: smooth }",
    "mesh: { file: meshes/spot.obj }",
    "mesh: { file: data/elbow.vtu }",
    "instances: { mesh: { file: meshes/spot.obj }, places: [[{ scale: [0.9, -0.8, 0.7] }]] }",
];

/// A scene of one object in world space, placed by steps of a transform.
fn placed(object: &str, steps: &str) -> Scene {
    let material = if object.contains("spot.obj") {
        "{ color: { image: { file: pictures/spot.png } }, \
           normal_map: { image: { file: pictures/plank_normals.png } } }"
    } else if object.contains("elbow.vtu") {
        "{ color: { array: { name: temperature, map: viridis } } }"
    } else {
        "{ color: 0.5, normal_map: { image: { file: pictures/plank_normals.png, \
           mapping: { planar: { right: [0, 1, 0], up: [0, 0, 1] } } } } }"
    };
    scene_in_world(&parse(&format!(
        "image: {{ width: 4, height: 3 }}\n\
         camera: {{ look_at: {{ eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 40 }} }}\n\
         materials: {{ m: {material} }}\nlights: []\n\
         objects:\n  - {object}\n    material: m\n    transform: {steps}\n"
    )))
}

fn in_mirror(v: Vec3) -> Vec3 {
    Vec3::new(-v.x, v.y, v.z)
}

/// The surface point that a ray hits in a scene.
fn hits(scene: &Scene, rays: &[Ray]) -> Vec<Option<SurfacePoint>> {
    let accel = Accel::new(scene, Default::default());
    let tracer = Tracer::new(scene, &accel);
    let trace = |ray| tracer.trace(ray, RayKind::Camera, &mut NoProbe);
    rays.iter().map(trace).collect()
}

/// Returns true if one point is the other in the mirror, but for rounding errors.
fn is_in_mirror(one: &SurfacePoint, other: &SurfacePoint) -> bool {
    let is_near = |a: Vec3, b: Vec3| a.abs_diff_eq(in_mirror(b), 1e-3);
    is_near(one.position, other.position)
        && is_near(one.geometric_normal, other.geometric_normal)
        && is_near(one.normal, other.normal)
        && one.color.abs_diff_eq(other.color, 2e-3)
        && one.is_flipped == other.is_flipped
}

/// The triangles of a cell, counterclockwise as a viewer takes its outside.
fn triangles(patch: &Patch) -> Vec<[Vec3; 3]> {
    let fan = |c: &[Vec3]| (2..c.len()).map(|i| [c[0], c[i - 1], c[i]]).collect();
    match patch {
        Patch::Ball { .. } => Vec::new(),
        Patch::Triangle(corners) => vec![*corners],
        Patch::Polygon(corners) => fan(corners),
        // The first face of VTK's hexahedron is counterclockwise as seen from inside.
        Patch::Box([a, b, c, d, ..]) => fan(&[*d, *c, *b, *a]),
        Patch::Strip(corners) => {
            let windows = corners.windows(3).enumerate();
            let turned = |(i, c): (usize, &[Vec3])| [c[i % 2], c[1 - i % 2], c[2]];
            windows.map(turned).collect()
        }
    }
}

/// Makes sure that the outside of the cells of primitives is where their normals point.
fn check_cells(scene: &Scene) {
    for primitive in scene.primitives.iter().take(20) {
        let Some(patch) = primitive.patch() else {
            continue;
        };
        for [a, b, c] in triangles(&patch) {
            let (_, normal) = primitive.project((a + b + c) / 3.0);
            let area = (b - a).cross(c - a);
            assert!(area.dot(normal) >= -1e-6, "{primitive:?}");
        }
    }
}

proptest! {
    #![proptest_config(cases(6))]

    /// Points, normals, colors and sides of all kinds of objects under any transform.
    #[test]
    fn surface_points_are_those_in_the_mirror(
        axis in direction(),
        angle in 0.0_f32..360.0,
        scale in prop::array::uniform3(prop_oneof![-1.4_f32..-0.6, 0.6_f32..1.4]),
        is_similar in any::<bool>(),
        shift in prop::array::uniform3(-2.0_f32..2.0),
        seed in any::<u64>(),
    ) {
        let scale = if is_similar { [scale[0]; 3] } else { scale };
        let steps = format!(
            "{{ scale: {scale:?} }}, {{ rotate: {{ axis: [{}, {}, {}], angle_deg: {angle} }} }}, {{ translate: {shift:?} }}",
            axis.x, axis.y, axis.z
        );
        let ray = |i: u64| {
            let [x, y, z, w] = math::sampling::uniform([seed, i, 0]);
            let from = 9.0 * (Vec3::new(x, y, z) - 0.5).normalize();
            let target = 0.6 * (Vec3::new(w, x + y, y + w) - 0.75);
            let origin = from + Vec3::from(shift);
            Ray { origin, direction: (target - from).normalize() }
        };
        let rays: Vec<Ray> = (0..400).map(ray).collect();
        let mirrored_ray = |ray: &Ray| Ray {
            origin: in_mirror(ray.origin),
            direction: in_mirror(ray.direction),
        };
        let rays_in_mirror: Vec<Ray> = rays.iter().map(mirrored_ray).collect();
        for object in OBJECTS {
            let one = placed(object, &format!("[{steps}]"));
            let other = placed(object, &format!("[{steps}, {{ scale: [-1, 1, 1] }}]"));
            let pairs = hits(&one, &rays).into_iter().zip(hits(&other, &rays_in_mirror));
            let mut n_hits = 0;
            let mut n_different = 0;
            for (a, b) in pairs {
                n_hits += u32::from(a.is_some());
                n_different += u32::from(match (a, b) {
                    (Some(a), Some(b)) => !is_in_mirror(&a, &b),
                    (a, b) => a.is_some() != b.is_some(),
                });
            }
            // Rounding decides at edges.
            prop_assert!(n_hits > 10 && n_different <= n_hits / 50, "{object} {n_different} of {n_hits}");
            check_cells(&one);
            check_cells(&other);
        }
    }
}

/// Lamps that shine outward only light the same side of a floor; glass bends light as before.
#[test]
fn light_leaves_and_enters_mirrored_objects_as_before() {
    let light = |object: &str, material: &str, steps: &str| {
        mean(&radiance(&format!(
            "image: {{ width: 24, height: 24, samples_per_pixel: 64, sampler: sobol }}\n\
             camera: {{ orthographic: {{ eye: [0, 9, 0], target: [0, 0, 0], up: [0, 0, 1], height: 3 }} }}\n\
             shading: {{ model: path, max_depth: 8 }}\nlights: []\n\
             background: {{ gradient: {{ bottom: [0.1, 0.2, 0.3], top: [0.9, 0.5, 0.1] }} }}\n\
             materials:\n  floor: {{ color: 0.7 }}\n  \
             lamp: {{ color: 0, emission: 3, two_sided: false }}\n  \
             glass: {{ dielectric: {{ index: 1.5, absorption: [0, 0.5, 1] }} }}\n\
             objects:\n  - plane: {{ point: [0, -1.2, 0], normal: [0, 1, 0] }}\n    material: floor\n  \
             - {object}\n    material: {material}\n    transform: {steps}\n"
        )))
    };
    let lamps = [OBJECTS[3], OBJECTS[4], OBJECTS[9]].map(|object| (object, "lamp"));
    for (object, material) in lamps.into_iter().chain([(OBJECTS[9], "glass")]) {
        for tilt in [-60, 60] {
            let steps = format!("{{ rotate: {{ axis: [1, 0, 0], angle_deg: {tilt} }} }}");
            let one = light(object, material, &format!("[{steps}]"));
            let mirrored = light(
                object,
                material,
                &format!("[{steps}, {{ scale: [-1, 1, 1] }}]"),
            );
            let difference = (one - mirrored).abs().max_element();
            assert!(
                difference < 0.02 * one.max_element(),
                "{object} {one} {mirrored}"
            );
        }
    }
}
