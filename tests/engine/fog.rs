//! Fog, against formulas.

use glam::Vec3;

use crate::common::{mean, radiance};

#[test]
fn fog_that_absorbs_nothing_is_invisible_in_a_white_furnace() {
    for (anisotropy, material) in [
        (0.0, "{ color: 1 }"),
        (0.7, "{ color: 1 }"),
        (-0.5, "{ dielectric: { index: 1.5 } }"),
        (
            0.3,
            "{ conductor: { index: 0, extinction: 1 }, roughness: 0.5 }",
        ),
    ] {
        let radiance = radiance(&format!(
            "image: {{ width: 16, height: 16, samples_per_pixel: 64, sampler: sobol }}
camera: {{ look_at: {{ eye: [0, 0, 4], target: [0, 0, 0], fov_y_deg: 60 }} }}
shading: {{ model: path, max_depth: 255 }}
background: 1
fog: {{ mean_free_path: 1.5, anisotropy: {anisotropy}, radius: 3 }}
materials: {{ white: {material} }}
lights: []
objects: [{{ sphere: {{ center: [0, 0, 0], radius: 1 }}, material: white }}]
"
        ));
        let mean = mean(&radiance);
        assert!(
            (mean - 1.0).abs().max_element() < 2e-3,
            "{anisotropy}, {material}: {mean}"
        );
    }
}

/// A camera that looks at a lamp of radiance 2, 4 units away behind 3 units of fog.
fn lamp_in_fog(model: &str) -> Vec3 {
    let radiance = radiance(&format!(
        "image: {{ width: 8, height: 8, samples_per_pixel: 256, sampler: sobol }}
camera: {{ orthographic: {{ eye: [0, 0, 4], target: [0, 0, 0], height: 0.001 }} }}
shading: {{ model: {model} }}
fog: {{ mean_free_path: 2, color: [0, 0, 0.5], radius: 3 }}
materials: {{ lamp: {{ emission: 2, two_sided: false }} }}
lights: []
objects: [{{ disk: {{ center: [0, 0, 0], normal: [0, 0, 1], radius: 0.1 }}, material: lamp }}]
"
    ));
    mean(&radiance)
}

#[test]
fn light_fades_exponentially_toward_the_color_of_the_fog() {
    let left = (-1.5_f32).exp();
    let faded = lamp_in_fog("blinn_phong");
    let expected = Vec3::new(2.0 * left, 2.0 * left, 2.0 * left + 0.5 * (1.0 - left));
    assert!(faded.abs_diff_eq(expected, 1e-5), "{faded} {expected}");
    let absorbed = lamp_in_fog("path").x;
    assert!((absorbed - 2.0 * left).abs() < 5e-3, "{absorbed}");
}

#[test]
fn a_light_in_fog_has_the_halo_of_the_integral() {
    // A point light beside a ray: light scattered once.
    let (intensity, extinction, side) = (3.0, 0.4, 0.7);
    for anisotropy in [0.0, 0.6, -0.6] {
        let radiance = radiance(&format!(
            "image: {{ width: 8, height: 8, samples_per_pixel: 1024, sampler: sobol }}
camera: {{ orthographic: {{ eye: [0, 0, 0], target: [0, 0, -1], height: 0.001 }} }}
shading: {{ model: path, max_depth: 1 }}
fog: {{ mean_free_path: 2.5, color: 0.8, anisotropy: {anisotropy}, radius: 50 }}
materials: {{ black: {{ color: 0 }} }}
lights:
  - point: {{ position: [{side}, 0, -2], intensity: {intensity}, falloff: inverse_square }}
objects: [{{ disk: {{ center: [0, 0, -5], normal: [0, 0, 1], radius: 0.1 }}, material: black }}]
"
        ));
        let n = 100_000_u32;
        let step = 5.0 / n as f32;
        let expected: f32 = (0..n)
            .map(|i| {
                let t = step * (i as f32 + 0.5);
                let to_light = Vec3::new(side, 0.0, t - 2.0);
                let distance = to_light.length();
                // A white surface that faces the light has its intensity as radiance.
                let arriving = std::f32::consts::PI * intensity / distance.powi(2);
                let cos = -to_light.z / distance;
                let g: f32 = anisotropy;
                let phase = (1.0 - g * g)
                    / (4.0 * std::f32::consts::PI * (1.0 + g * g - 2.0 * g * cos).powf(1.5));
                let left = (-extinction * (t + distance)).exp();
                0.8 * extinction * left * arriving * phase * step
            })
            .sum();
        let found = mean(&radiance).x;
        assert!(
            (found / expected - 1.0).abs() < 5e-3,
            "{anisotropy}: {found} {expected}"
        );
    }
}
