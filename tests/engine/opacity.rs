//! Holes in surfaces, and surfaces that light passes in part: rays go on as if nothing were there.

use std::fmt::Write;

use glam::Vec3;
use proptest::prelude::*;
use scene::build::Geometries;
use scene::config::Acceleration;
use tracer::accel::{Accel, ShadowRay};
use tracer::cost::{Cost, NoProbe, RayKind};
use tracer::trace::Tracer;
use world::geometry::{Ray, RenderSpace};
use world::scene::Scene;

use crate::common::{mean, parse, radiance};

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
    scene::build::scene_in_space(&config, geometries, RenderSpace::default()).unwrap()
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
            let is_shadowed = tracer.light_along(&shadow, &mut NoProbe) == 0.0;
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

/// Returns the mean radiance of a scene seen from above, from z = 1: `keys` are those of the scene,
/// `panes` the distances of panes along the view, or behind the eye if they are negative.
fn seen(keys: &str, pane: &str, panes: impl IntoIterator<Item = f32>, floor: &str) -> f32 {
    let mut objects = String::new();
    for distance in panes {
        let z = 1.0 - distance;
        writeln!(
            objects,
            "  - plane: {{ point: [0, 0, {z}], normal: [0, 0, 1] }}\n    material: pane"
        )
        .unwrap();
    }
    let colors = radiance(&format!(
        "
image: {{ width: 8, height: 8, samples_per_pixel: 256 }}
camera: {{ orthographic: {{ eye: [0, 0, 1], target: [0, 0, 0], up: [0, 1, 0], height: 0.1 }} }}
{keys}
materials:
  pane: {{ {pane} }}
  lamp: {{ color: 0, emission: 8 }}
  floor: {{ color: 0.5 }}
objects:
{objects}{floor}"
    ));
    mean(&colors).x
}

#[test]
fn layers_are_blended_by_the_operator_over() {
    let layers = || (1..=12).map(|i| 0.02 * i as f32);
    let behind = 0.7_f32.powi(12);
    for (model, color, tolerance) in [
        ("{ model: blinn_phong, ambient: 1 }", 0.5, 1e-5),
        ("{ model: ambient_occlusion }", 0.0, 1e-5),
        ("{ model: path }", 0.0, 3e-3),
    ] {
        let keys = format!("shading: {model}\nbackground: 1\nlights: []");
        let found = seen(
            &keys,
            &format!("color: {color}, opacity: 0.3"),
            layers(),
            "",
        );
        let expected = color * (1.0 - behind) + behind;
        assert!(
            (found - expected).abs() < tolerance,
            "{model}: {found}, {expected}"
        );
    }
}

#[test]
fn a_share_of_light_passes_in_shadows() {
    let floor = "  - plane: { point: [0, 0, 0], normal: [0, 0, 1] }\n    material: floor\n";
    let lamp = "  - rectangle: { corner: [-1, -1, 3], edges: [[2, 0, 0], [0, 2, 0]] }
    material: lamp\n";
    let bulb = "lights: [{ point: { position: [1, 2, 5], intensity: 0.9 } }]";
    for (model, lights, objects, tolerance) in [
        (
            "{ model: blinn_phong, ambient: 0 }",
            bulb,
            floor.to_owned(),
            1e-5,
        ),
        ("{ model: path }", bulb, floor.to_owned(), 1e-5),
        (
            "{ model: path }",
            "lights: []",
            [floor, lamp].concat(),
            0.02,
        ),
    ] {
        let keys = format!("shading: {model}\n{lights}");
        let [free, shaded] = [vec![], vec![-1.0, -1.5]]
            .map(|panes| seen(&keys, "color: 0, opacity: 0.4", panes, &objects));
        let share = shaded / free;
        assert!((share - 0.36).abs() < tolerance, "{model}: {share}");
    }
}

/// Light from all sides has the radiance 1: a quarter of a shell, three quarters of the background.
#[test]
fn a_surface_emits_by_its_opacity() {
    let shell = "  - sphere: { center: [0, 0, 0], radius: 5 }\n    material: pane
  - sphere: { center: [0, 0, 0], radius: 0.5 }\n    material: floor\n";
    let keys = "shading: { model: path }\nbackground: 1\nlights: []";
    let found = seen(keys, "color: 0, emission: 1, opacity: 0.25", [], shell);
    assert!((found - 0.5).abs() < 1e-4, "{found}");
}
