//! Light through clear media, against formulas.

use glam::Vec3;
use scene::build::Sensor;

use crate::common::{mean, parse, radiance, scene_of};
use render::attribution::{PathObserver, RayTree};
use tracer::accel::Accel;
use tracer::cost::RayKind;
use tracer::trace::Tracer;

/// The rays of the pixel in the middle of five, which sees a medium under a white sky.
fn under_white_sky(max_depth: u32, medium: &str, objects: &str) -> RayTree {
    let config = parse(&format!(
        "
image: {{ width: 5, height: 5 }}
camera: {{ look_at: {{ eye: [0, 0, 3], target: [0, 0, 0], fov_y_deg: 40 }} }}
background: 1
shading: {{ max_depth: {max_depth} }}
materials:
  medium: {{ dielectric: {medium} }}
  water: {{ dielectric: {{ index: 1.33 }} }}
lights: []
objects: [{objects}]
"
    ));
    let scene = scene_of(&config);
    let accel = Accel::new(&scene, config.acceleration);
    let tracer = Tracer::new(&scene, &accel);
    let mut tree = RayTree::default();
    PathObserver::new(tracer, &Sensor::new(&scene, &config), None).observe((2, 2), &mut tree);
    tree
}

/// A slab before the camera, 0.8 thick.
const SLAB: &str = "{ box: { min: [-9, -9, -0.5], max: [9, 9, 0.3] }, material: medium }";

#[test]
fn a_slab_transmits_what_the_series_of_its_reflections_says() {
    for (medium, index, absorption) in [
        (
            "{ index: 1.5, absorption: [0, 0.5, 4] }",
            1.5,
            [0.0, 0.5, 4.0],
        ),
        ("{ index: 2.4, absorption: 0.2 }", 2.4, [0.2; 3]),
    ] {
        let found = under_white_sky(60, medium, SLAB).color();
        let fresnel = ((index - 1.0) / (index + 1.0_f32)).powi(2);
        // Reflected at the first surface, or after any number of passes through the slab.
        let expected = absorption.map(|absorption: f32| {
            let pass = (-absorption * 0.8).exp();
            fresnel + (1.0 - fresnel).powi(2) * pass / (1.0 - fresnel * pass)
        });
        let difference = (found - Vec3::from(expected)).abs().max_element();
        // Rays of little weight are left out.
        assert!(difference < 1e-3, "{found} {expected:?}");
    }
}

#[test]
fn a_clear_sphere_in_a_white_furnace_is_invisible() {
    for offset in [0.0, 0.1, 0.2, 0.29] {
        let sphere =
            format!("{{ sphere: {{ center: [{offset}, 0, 0], radius: 0.3 }}, material: medium }}");
        let tree = under_white_sky(60, "{ index: 1.5 }", &sphere);
        let color = tree.color();
        assert!((color - Vec3::ONE).abs().max_element() < 1e-3, "{color}");
        let n_refracted = tree
            .rays
            .iter()
            .filter(|ray| ray.kind == RayKind::Refraction);
        assert!(n_refracted.count() >= 2);
    }
}

#[test]
fn a_medium_inside_of_an_equal_one_is_invisible() {
    let in_water =
        format!("{{ box: {{ min: [-9, -9, -0.9], max: [9, 9, 0.9] }}, material: water }}, {SLAB}");
    let tree = under_white_sky(8, "{ index: 1.33 }", &in_water);
    let alone = under_white_sky(8, "{ index: 1.33 }", SLAB);
    // Into the water, through both surfaces of the slab, and out of it.
    assert!(tree.rays.len() > alone.rays.len());
    assert!((tree.color() - Vec3::ONE).abs().max_element() < 1e-3);
}

#[test]
fn rays_end_at_the_greatest_depth() {
    for max_depth in [0, 1, 3] {
        let tree = under_white_sky(max_depth, "{ index: 1.5 }", SLAB);
        let deepest = tree.rays.iter().map(|ray| ray.bounce).max();
        assert_eq!(deepest, Some(max_depth));
    }
}

#[test]
fn water_weakens_the_light_of_a_lamp_inside_of_it() {
    // The lamp is 0.5 above a floor that is seen through 1 of water.
    let below_water = |absorption: f32, lamp: &str| {
        let radiance = radiance(&format!(
            "image: {{ width: 4, height: 4, samples_per_pixel: 256, sampler: sobol }}
camera: {{ orthographic: {{ eye: [0, 0, 3], target: [0, 0, 0], height: 0.001 }} }}
shading: {{ model: path, max_depth: 2 }}
materials:
  floor: {{ color: 0.5 }}
  lamp: {{ emission: 40 }}
  water: {{ dielectric: {{ index: 1, absorption: [0, 0, {absorption}] }} }}
{lamp}
  - box: {{ min: [-9, -9, -1], max: [9, 9, 1] }}
    material: water
  - disk: {{ center: [0, 0, 0], normal: [0, 0, 1], radius: 5 }}
    material: floor
"
        ));
        mean(&radiance)
    };
    let point = "lights: [point: { position: [0.3, 0, 0.4] }]
objects:";
    let sphere = "lights: []
objects:
  - sphere: { center: [0.3, 0, 0.4], radius: 0.02 }
    material: lamp";
    for lamp in [point, sphere] {
        let [clear, blue] = [0.0, 0.8].map(|absorption| below_water(absorption, lamp));
        let left = blue.z / blue.x;
        let expected = (-0.8_f32 * (0.5 + 1.0)).exp();
        assert!(
            clear.x > 0.01 && (clear.x - clear.z).abs() < 1e-6,
            "{clear}"
        );
        assert!((left / expected - 1.0).abs() < 0.02, "{left} {expected}");
    }
}

/// Views from inside of water in front of a lamp of radiance 1, and the distances through water to it.
#[test]
fn an_eye_in_water_sees_through_it() {
    let box_of = |min: f32, max: f32| {
        format!("box: {{ min: [{min}, {min}, {min}], max: [{max}, {max}, {max}] }}")
    };
    let eye = "look_at: { eye: [0, 0, 0], target: [2, 0, 0], fov_y_deg: 1";
    let pinhole = format!("{eye} }}");
    let lens = format!("{eye}, lens: {{ radius: 0.2, focus_distance: 2 }} }}");
    let panorama = "panorama: { eye: [0, 0, 0], target: [2, 0, 0] }".to_owned();
    let parallel = "orthographic: { eye: [0, 0, 0], target: [2, 0, 0], height: 1 }".to_owned();
    let bubble = "  - sphere: { center: [0, 0, 0], radius: 0.5 }\n    material: air\n";
    let around = "  - sphere: { center: [0, 0, 0], radius: 2 }\n    material: lamp\n";
    let plane = "plane: { point: [0, 3, 0], normal: [0, 1, 0] }".to_owned();
    for (camera, water, more, distance) in [
        (&pinhole, box_of(-3.0, 3.0), "", 2.0),
        (&pinhole, plane.clone(), "", 2.0),
        (&pinhole, box_of(-3.0, 1.0), "", 1.0),
        // A bubble of air is a medium of a higher priority.
        (&pinhole, box_of(-3.0, 3.0), bubble, 1.5),
        // Behind water, and behind its plane.
        (&pinhole, box_of(-8.0, -4.0), "", 0.0),
        (
            &pinhole,
            "plane: { point: [0, -3, 0], normal: [0, 1, 0] }".to_owned(),
            "",
            0.0,
        ),
        (&lens, box_of(-3.0, 3.0), "", 2.0),
        (&panorama, box_of(-3.0, 3.0), around, 2.0),
        (&parallel, box_of(-3.0, 3.0), "", 2.0),
    ] {
        for (mode, model) in [
            ("none", "path"),
            ("single_ray_time", "path"),
            ("none", "blinn_phong"),
            ("single_ray_time", "blinn_phong"),
        ] {
            let radiance = radiance(&in_water(mode, model, camera, &water, more));
            let found = radiance[radiance.len() / 2 + 2];
            let expected = [0.5, 1.0, 2.0].map(|absorption: f32| (-absorption * distance).exp());
            let difference = (found - Vec3::from(expected)).abs().max_element();
            assert!(
                difference < 2e-3,
                "{mode} {model} {camera} {water}: {found} {expected:?}"
            );
        }
    }
}

/// A lamp around a camera in a medium that refracts no light, and around fog.
fn in_water(mode: &str, model: &str, camera: &str, water: &str, more: &str) -> String {
    format!(
        "image: {{ width: 4, height: 4, samples_per_pixel: 4, sampler: sobol }}
camera: {{ {camera} }}
shading: {{ model: {model}, max_depth: 10 }}
cost: {mode}
materials:
  water: {{ dielectric: {{ index: 1, absorption: [0.5, 1, 2] }} }}
  air: {{ dielectric: {{ index: 1, priority: 1 }} }}
  lamp: {{ emission: 1, color: 0 }}
lights: []
objects:
  - {water}
    material: water
  - rectangle: {{ corner: [2, -9, -9], edges: [[0, 0, 18], [0, 18, 0]] }}
    material: lamp
{more}"
    )
}

/// Parallel rays, and rays of a lens, start on both sides of a surface.
#[test]
fn rays_start_in_the_medium_at_their_origin() {
    let water = "box: { min: [-3, -3, -3], max: [3, 0, 3] }";
    let parallel = "orthographic: { eye: [0, 1, 0], target: [2, 1, 0], height: 4 }";
    let lens = "look_at: { eye: [0, 0.05, 0], target: [2, 0.05, 0], fov_y_deg: 0.1, \
                lens: { radius: 1, focus_distance: 1000 } }";
    let left = [0.5, 1.0, 2.0].map(|absorption: f32| (-absorption * 2.0).exp());
    for mode in ["none", "single_ray_time"] {
        let rows = radiance(&in_water(mode, "path", parallel, water, ""));
        for (i, found) in rows.iter().enumerate() {
            let expected = if i < 12 { Vec3::ONE } else { left.into() };
            assert!(
                (found - expected).abs().max_element() < 1e-3,
                "{mode} {i}: {found}"
            );
        }
        let mixed = mean(&radiance(&in_water(mode, "path", lens, water, "")));
        // Somewhat less than half of the lens is in water.
        let share = (Vec3::ONE - mixed) / (Vec3::ONE - Vec3::from(left));
        assert!((share - 0.47).abs().max_element() < 0.05, "{mode}: {share}");
    }
}

#[test]
fn a_clear_ball_around_the_eye_keeps_the_fog_out() {
    for (model, fog) in [
        ("blinn_phong", "{ mean_free_path: 0.5, color: 0 }"),
        ("path", "{ mean_free_path: 0.5, color: 0 }"),
    ] {
        let scene = in_water(
            "none",
            model,
            "look_at: { eye: [0, 0, 0], target: [2, 0, 0], fov_y_deg: 1 }",
            "sphere: { center: [-30, 0, 0], radius: 1 }",
            "  - sphere: { center: [0, 0, 0], radius: 1.5 }\n    material: air\n",
        );
        let found = mean(&radiance(&format!("{scene}fog: {fog}\n")));
        // Half of a unit is in fog: one mean free path.
        let tolerance = if model == "path" { 0.15 } else { 1e-3 };
        assert!(
            (found.x - (-1_f32).exp()).abs() < tolerance,
            "{model}: {found}"
        );
    }
}
