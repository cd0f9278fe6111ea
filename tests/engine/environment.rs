//! Pictures and skies around scenes, as backgrounds and as lights.

use std::path::Path;

use glam::{DVec3, Vec3};
use math::simd::Vector;
use scene::config::OptionalOutput;
use world::light::LitPoint;
use world::scene::{LightNumbers, Scene};

use crate::common::{film, in_repository, parse, scene_of};

const SPOTS: &str = "tests/files/sky.hdr";

/// A picture of one pixel.
fn pixel(folder: &Path, gray: u8) -> String {
    let path = folder.join(format!("{gray}.png"));
    image::RgbImage::from_pixel(1, 1, image::Rgb([gray; 3]))
        .save(&path)
        .unwrap();
    path.display().to_string()
}

/// A floor of albedo 1 seen from above, with z upward, below an environment map.
fn floor(keys: &str, shading: &str, material: &str) -> String {
    format!(
        "image: {{ width: 4, height: 4, samples_per_pixel: 1024, sampler: sobol }}
camera: {{ orthographic: {{ eye: [0, 0, 1], target: [0, 0, 0], height: 0.001 }} }}
cost: counters
shading: {{ {shading} }}
background: {{ environment_map: {{ {keys} }} }}
materials: {{ floor: {{ {material} }}, lamp: {{ emission: 3 }} }}
lights: []
objects: [{{ plane: {{ point: [0, 0, 0], normal: [0, 0, 1] }}, material: floor }}]
"
    )
}

/// The mean radiance of all pixels.
fn seen(text: &str) -> Vec3 {
    let mut config = parse(text);
    config.output.add(OptionalOutput::Radiance);
    let film = film(&config, 2);
    let radiance: Vec<Vec3> = film.values(|strip| &strip.radiance).collect();
    radiance.iter().sum::<Vec3>() / radiance.len() as f32
}

/// The mean of the background over the hemisphere around z, weighted by the cosine.
fn integral(scene: &Scene) -> Vec3 {
    const N: u32 = 1000;
    let mut sum = DVec3::ZERO;
    for i in 0..N * N {
        let [u, v] = [i / N, i % N].map(|k| (f64::from(k) + 0.5) / f64::from(N));
        let (radius, angle) = (u.sqrt(), std::f64::consts::TAU * v);
        let direction = DVec3::new(radius * angle.cos(), radius * angle.sin(), (1.0 - u).sqrt());
        let color = scene.background.without_sun(direction.as_vec3().into());
        sum += Vec3::from(color).as_dvec3();
    }
    (sum / f64::from(N * N)).as_vec3()
}

/// The same by light samples alone.
fn by_light_samples(scene: &Scene) -> Vec3 {
    const N: u32 = 500;
    let [position, normal] = [Vec3::ZERO, Vec3::Z].map(Vector::from);
    let at = LitPoint {
        position,
        normal,
        geometric_normal: normal,
        error: 0.0,
    };
    let mut sum = DVec3::ZERO;
    for i in 0..N * N {
        let numbers = LightNumbers {
            source: [0.0; 2],
            shape: [0.0; 2],
            point: [i / N, i % N].map(|k| (k as f32 + 0.5) / N as f32),
        };
        let (light, _) = scene.lights.illuminate(0, &at, &numbers);
        let cos = light.direction.z.max(0.0);
        sum += (Vec3::from(light.radiance) * cos).as_dvec3();
    }
    (sum / f64::from(N * N)).as_vec3()
}

#[test]
fn irradiance_is_the_integral_over_the_map() {
    let folder = tempfile::tempdir().unwrap();
    let white = pixel(folder.path(), 255);
    let spots = in_repository(SPOTS).display().to_string();
    for keys in [
        format!("file: {white}"),
        format!("file: {spots}"),
        // With the brightest spot above the floor.
        format!("file: {spots}, rotation_deg: 190, intensity: 0.25"),
    ] {
        for shading in [
            "model: path",
            "model: path, light_sampling: each",
            "model: path, max_depth: 1",
        ] {
            let text = floor(&keys, shading, "color: 1");
            let scene = scene_of(&parse(&text));
            let expected = integral(&scene);
            for found in [seen(&text), by_light_samples(&scene)] {
                assert!(
                    (found / expected - 1.0).abs().max_element() < 0.005,
                    "{keys} {shading}: {found}, expected {expected}"
                );
            }
        }
    }
}

#[test]
fn mirrors_and_rough_metals_reflect_the_map() {
    let spots = in_repository(SPOTS).display().to_string();
    let keys = format!("file: {spots}, rotation_deg: 30");
    let metal = "conductor: { index: 0, extinction: 1 }";
    let scene = scene_of(&parse(&floor(&keys, "model: path", metal)));
    let above = Vec3::from(scene.background.color(Vec3::Z.into()));
    // The picture is linear between its texels, so that narrow facets keep its mean.
    for (roughness, tolerance) in [(0.0, 1e-3), (0.1, 0.02)] {
        let material = format!("{metal}, roughness: {roughness}");
        let found = seen(&floor(&keys, "model: path", &material));
        assert!(
            (found / above - 1.0).abs().max_element() < tolerance,
            "{roughness}: {found}, expected {above}"
        );
    }
}

#[test]
fn other_lights_keep_their_share() {
    let spots = in_repository(SPOTS).display().to_string();
    let keys = format!("file: {spots}, rotation_deg: 30");
    let lamp = "  - { sphere: { center: [0, 0, 3], radius: 0.5 }, material: lamp }";
    let of = |sampling: &str| {
        let shading = format!("model: path, light_sampling: {sampling}");
        let text = floor(&keys, &shading, "color: 0.5");
        seen(
            &text
                .replace("objects: [{", "objects:\n  - {")
                .replace("}]", &format!("}}\n{lamp}")),
        )
    };
    let (each, power) = (of("each"), of("power"));
    assert!(
        (each / power - 1.0).abs().max_element() < 0.005,
        "{each} {power}"
    );
}

#[test]
fn irradiance_is_that_of_the_sky_and_of_the_sun() {
    for sun in [
        "{ elevation_deg: 20, azimuth_deg: 160 }",
        "{ elevation_deg: 60, azimuth_deg: 0 }",
    ] {
        let sky = format!("{{ sky: {{ sun: {sun}, intensity: 0.5 }} }}");
        for sampling in ["each", "power"] {
            let shading = format!("model: path, light_sampling: {sampling}");
            let text = floor("file: sky.hdr", &shading, "color: 1")
                .replace("{ environment_map: { file: sky.hdr } }", &sky);
            let scene = scene_of(&parse(&text));
            let sun = scene.background.sun().unwrap();
            let center = sun.illuminate([0.5; 2]).direction;
            let expected = integral(&scene) + sun.white_radiance() * center.z.max(0.0);
            let found = seen(&text);
            assert!(
                (found / expected - 1.0).abs().max_element() < 0.005,
                "{sky} {sampling}: {found}, expected {expected}"
            );
        }
    }
}

#[test]
fn the_edge_of_a_shadow_in_the_sun_is_as_soft_as_the_sun_is_wide() {
    // A wall 10 high, and the sun at 45 degrees: its disk is a 107th of the way wide.
    let text = "image: { width: 200, height: 1, samples_per_pixel: 256, sampler: sobol }
camera: { orthographic: { eye: [10, 5, 5], target: [10, 0, 5], up: [0, 0, -1], height: 0.002 } }
cost: counters
shading: { model: path, max_depth: 1 }
background: { sky: { sun: { elevation_deg: 45, azimuth_deg: -90 }, ground: 0 } }
materials: { floor: { color: 1 }, wall: { color: 0 } }
lights: []
objects:
  - plane: { point: [0, 0, 0], normal: [0, 1, 0] }
    material: floor
  - box: { min: [-1, 0, -1000], max: [0, 10, 1000] }
    material: wall
";
    let mut config = parse(text);
    config.output.add(OptionalOutput::Radiance);
    let film = film(&config, 2);
    let red: Vec<f32> = film
        .values(|strip| &strip.radiance)
        .map(|of| of.x)
        .collect();
    let [dark, bright] = [red[0], red[199]];
    // The quarters of the disk's light are 0.404 of its radius from the center.
    let half = 10.0 * 2.0_f32.sqrt() * 2.0_f32.sqrt() * 0.2666_f32.to_radians();
    let place = |share: f32| {
        let is_brighter = |light: &f32| *light > dark + share * (bright - dark);
        red.iter().position(is_brighter).unwrap() as f32 / 500.0 - 0.2
    };
    for (share, expected) in [(0.25, -0.404), (0.5, 0.0), (0.75, 0.404)] {
        let found = place(share) / half;
        assert!(
            (found - expected).abs() < 0.08,
            "{share}: {found}, expected {expected}"
        );
    }
}

#[test]
fn a_black_map_is_no_light() {
    let folder = tempfile::tempdir().unwrap();
    let black = pixel(folder.path(), 0);
    let text = floor(&format!("file: {black}"), "model: path", "color: 1");
    assert_eq!(scene_of(&parse(&text)).lights.n_sources(), 0);
    assert_eq!(seen(&text), Vec3::ZERO);
}

#[test]
fn only_path_tracing_is_lit_by_the_map() {
    let spots = in_repository(SPOTS).display().to_string();
    for model in ["blinn_phong, ambient: 0", "ambient_occlusion", "seed"] {
        let shading = format!("model: {model}");
        let text = floor(&format!("file: {spots}"), &shading, "color: 1");
        let scene = scene_of(&parse(&text.replace(", lamp: { emission: 3 }", "")));
        let n_sources = usize::from(model == "ambient_occlusion");
        assert_eq!(scene.lights.n_sources(), n_sources, "{model}");
        assert!(scene.background.environment_map().is_some());
    }
}
