//! Light through clear media, against formulas.

use glam::Vec3;

use crate::common::{mean, parse, radiance, scene_of};
use render::attribution::{Observer, RayTree};
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
    Observer::new(tracer, &scene.sensor(&config), None).observe((2, 2), &mut tree);
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
