//! Holes in surfaces: rays go through them as if nothing were there.

use std::fmt::Write;

use glam::Vec3;
use proptest::prelude::*;
use scene::config::Acceleration;
use scene::geometry::{Ray, RenderSpace};
use scene::world::{Geometries, Scene};
use tracer::accel::{Accel, ShadowRay};
use tracer::cost::{Cost, NoProbe, RayKind};
use tracer::trace::Tracer;

use crate::common::parse;

/// A scene whose rectangles with the material `cut` have a hole for x > 0, and a wall behind.
fn scene(objects: &str) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let texel = |x, _| image::Rgba([255, 255, 255, if x == 0 { 255 } else { 0 }]);
    let mask = image::RgbaImage::from_fn(2, 1, texel);
    mask.save(folder.path().join("mask.png")).unwrap();
    let mut config = parse(&format!(
        "
image: {{ width: 4, height: 4 }}
camera: {{ look_at: {{ eye: [0, 0, 4], target: [0, 0, 0], fov_y_deg: 50 }} }}
materials:
  solid: {{ color: 1 }}
  cut:
    color: 1
    cutout:
      image:
        file: mask.png
        filter: nearest
        mapping: {{ planar: {{ origin: [-2, 0, 0], right: [1, 0, 0], up: [0, 1, 0] }} }}
        size: [4, 1]
objects:
  - plane: {{ point: [0, 0, -4.005], normal: [0, 0, 1] }}
    material: solid
{objects}
lights: []
"
    ));
    let geometries = Geometries::read(&mut config, folder.path(), u64::MAX).unwrap();
    // Rays are given in world space.
    Scene::in_space(&config, geometries, RenderSpace::default()).unwrap()
}

/// Rectangles from x = -2 to `right`, one behind the other.
fn layers(n: u32, right: f32, material: &str) -> String {
    let mut objects = String::new();
    for i in 0..n {
        let (z, width) = (-0.01 * i as f32, right + 2.0);
        writeln!(
            objects,
            "  - rectangle: {{ corner: [-2, -1, {z}], edges: [[{width}, 0, 0], [0, 2, 0]] }}
    material: {material}"
        )
        .unwrap();
    }
    objects
}

proptest! {
    #[test]
    fn layers_with_holes_are_hit_like_layers_of_half_the_size(
        from in prop::array::uniform3(-2.0_f32..2.0), to in prop::array::uniform2(-1.5_f32..1.5),
        t_max in 0.1_f32..20.0, n in 1_u32..5,
    ) {
        prop_assume!(from[2] > 0.1 && to[0].abs() > 0.2 && (from[0] - to[0]).abs() < 2.0);
        let [cut, half] = [layers(n, 2.0, "cut"), layers(n, 0.0, "solid")].map(|objects| scene(&objects));
        let origin = Vec3::from(from);
        let direction = (Vec3::new(to[0], to[1], 0.0) - origin).normalize();
        let ray = Ray { origin, direction };
        let found = [&cut, &half].map(|scene| {
            let accel = Accel::new(scene, Acceleration::default());
            let tracer = Tracer::new(scene, &accel);
            let point = tracer.trace(&ray, RayKind::Camera, &mut NoProbe);
            let shadow = ShadowRay { ray, t_max, ignored: None };
            let steps = &mut Vec::new();
            let recorded = [tracer.record(&ray, steps), tracer.record_shadow(&shadow, steps)];
            let is_shadowed = tracer.is_shadowed(&shadow, &mut NoProbe);
            assert_eq!(point.map(|point| point.distance), recorded[0].map(|hit| hit.t));
            assert_eq!(is_shadowed, recorded[1].is_some());
            (point, is_shadowed)
        });
        let [(Some(cut), is_dark), (Some(half), is_half_dark)] = found else { unreachable!() };
        prop_assert!((cut.distance - half.distance).abs() < 1e-4 * half.distance);
        prop_assert!((cut.position - half.position).length() < 1e-4 * half.distance);
        prop_assert_eq!(cut.object, half.object);
        let is_near_end = (half.distance - t_max).abs() < 1e-3;
        prop_assert!(is_dark == is_half_dark || is_near_end);
    }
}

#[test]
fn a_ray_through_many_holes_is_one_ray_that_visits_more() {
    let scene = scene(&layers(1000, 2.0, "cut"));
    let accel = Accel::new(&scene, Acceleration::default());
    let tracer = Tracer::new(&scene, &accel);
    let ray = |x: f32| Ray {
        origin: Vec3::new(x, 0.3, 4.0),
        direction: -Vec3::Z,
    };
    let [solid, holes] = [-0.5, 0.5].map(|x| {
        let mut cost = Cost::default();
        let point = tracer.trace(&ray(x), RayKind::Camera, &mut cost).unwrap();
        (point, cost)
    });
    assert!((solid.0.distance - 4.0).abs() < 1e-4, "{:?}", solid.0);
    assert!((holes.0.distance - 8.005).abs() < 1e-3, "{:?}", holes.0);
    assert_eq!(solid.1.rays, holes.1.rays);
    assert!(holes.1.primitive_tests > 400, "{:?}", holes.1);
}
