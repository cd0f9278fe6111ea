//! Path tracing, area lights and ambient occlusion, against formulas.

use crate::common::{mean, radiance};

/// A camera above the origin that sees a small part of what is there.
const DOWN: &str = "image: { width: 4, height: 4, samples_per_pixel: 1024, sampler: sobol }
camera: { orthographic: { eye: [0, 0, 1], target: [0, 0, 0], height: 0.001 } }
cost: counters
";

/// One of these 2.4 million paths meets a facet of frosted glass edge-on.
#[test]
fn a_facet_that_is_seen_edge_on_does_not_light_up() {
    let radiance = radiance(
        "image: { width: 48, height: 48, samples_per_pixel: 1024, sampler: sobol }
camera: { look_at: { eye: [0, 0, 4], target: [0, 0, 0], fov_y_deg: 30 } }
shading: { model: path, max_depth: 100 }
cost: counters
background: 1
materials: { frosted: { dielectric: { index: 1.5 }, roughness: 0.3 } }
lights: []
objects: [{ sphere: { center: [0, 0, 0], radius: 1 }, material: frosted }]
",
    );
    let brightest = radiance
        .iter()
        .fold(0.0, |max: f32, of| max.max(of.max_element()));
    assert!(brightest < 1.1, "{brightest}");
}

#[test]
fn a_convex_body_that_absorbs_nothing_is_invisible_in_a_white_furnace() {
    for material in [
        "{ color: 1 }",
        "{ color: 1, reflection: 1 }",
        "{ color: 1, diffuse: 0.3, reflection: 0.7 }",
        "{ dielectric: { index: 1.5 } }",
        "{ color: 1, diffuse: 0.4, specular: 0.6, exponent: 10 }",
        "{ conductor: { index: 0, extinction: 1 }, roughness: 0.4 }",
        "{ conductor: { index: 0, extinction: 1 }, roughness: 1 }",
        "{ dielectric: { index: 1.5 }, roughness: 0.3 }",
        "{ dielectric: { index: 1.5 }, roughness: 0.9 }",
        "{ color: 1, principled: { roughness: 0 } }",
        "{ color: 1, principled: { roughness: 0.5 } }",
        "{ color: 1, principled: { roughness: 1, index: 2 } }",
        "{ color: 1, principled: { metallic: 0.6, roughness: 0.8 } }",
        "{ color: 1, principled: { transmission: 1, roughness: 0.2 } }",
        "{ color: 1, principled: { metallic: 0.2, transmission: 0.5, roughness: 0.7 } }",
    ] {
        let radiance = radiance(&format!(
            "image: {{ width: 24, height: 24, samples_per_pixel: 256, sampler: sobol }}
camera: {{ look_at: {{ eye: [0, 0, 4], target: [0, 0, 0], fov_y_deg: 30 }} }}
shading: {{ model: path, max_depth: 100 }}
cost: counters
background: 1
materials: {{ white: {material} }}
lights: []
objects: [{{ sphere: {{ center: [0, 0, 0], radius: 1 }}, material: white }}]
"
        ));
        let mean = mean(&radiance);
        // Paths through rough media are noisier: with a hundred times as many samples they
        // are within 1e-3, too.
        let tolerance = if material.contains("transmission") {
            3e-3
        } else {
            1e-3
        };
        assert!(
            (mean - 1.0).abs().max_element() < tolerance,
            "{material}: {mean}"
        );
    }
}

#[test]
fn a_rough_mirror_loses_the_light_between_its_facets() {
    // At roughness 1 and seen from above, the integral of the facets has a closed form;
    // narrow facets lose next to nothing.
    for (roughness, multiple_scattering, expected, tolerance) in [
        (0.1, false, 1.0, 1e-3),
        (0.2, false, 0.997, 3e-3),
        (1.0, false, 1.0 - 2.0_f32.ln(), 1e-3),
        (1.0, true, 1.0, 1e-3),
    ] {
        let radiance = radiance(&format!(
            "{DOWN}shading: {{ model: path }}
background: 1
materials:
  mirror:
    conductor: {{ index: 0, extinction: 1 }}
    roughness: {roughness}
    multiple_scattering: {multiple_scattering}
lights: []
objects: [{{ plane: {{ point: [0, 0, 0], normal: [0, 0, 1] }}, material: mirror }}]
"
        ));
        let found = mean(&radiance).x;
        assert!((found - expected).abs() < tolerance, "{roughness}: {found}");
    }
}

/// The radiance of a floor of albedo 0.5 below an object that emits light of radiance 3.
fn below_lamp(model: &str, lamp: &str) -> f32 {
    let radiance = radiance(&format!(
        "{DOWN}shading: {{ {model}, max_depth: 1 }}
materials:
  floor: {{ color: 0.5 }}
  lamp: {{ emission: 3 }}
lights: []
objects:
  - plane: {{ point: [0, 0, 0], normal: [0, 0, 1] }}
    material: floor
  - {{ {lamp}, material: lamp }}
"
    ));
    mean(&radiance).x
}

/// The fraction of the hemisphere, weighted by the cosine, that a rectangle takes at a
/// height above a corner: Howell, "A Catalog of Radiation Heat Transfer Configuration
/// Factors", B-3.
fn above_corner(a: f32, b: f32, height: f32) -> f32 {
    let (a, b) = (a / height, b / height);
    let (of_a, of_b) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
    let sum = a / of_a * (b / of_a).atan() + b / of_b * (a / of_b).atan();
    sum / std::f32::consts::TAU
}

#[test]
fn irradiance_is_that_of_the_closed_forms() {
    let quarters = [(1.0, 2.0), (1.0, 0.5), (0.4, 2.0), (0.4, 0.5)];
    let rectangle: f32 = quarters.map(|(a, b)| above_corner(a, b, 2.0)).iter().sum();
    let sphere = (0.5_f32 / 3.0).powi(2);
    // Howell, B-13, for a disk that faces the floor.
    let disk = 1.0 / (1.0 + 2.0_f32.powi(2));
    let triangle = above_corner(1.0, 1.0, 2.0);
    for model in [
        "model: path",
        "model: path, light_sampling: each",
        "model: blinn_phong, ambient: 0",
    ] {
        for (lamp, expected) in [
            (
                "rectangle: { corner: [-0.4, -0.5, 2], edges: [[1.4, 0, 0], [0, 2.5, 0]] }",
                rectangle,
            ),
            ("sphere: { center: [0, 0, 3], radius: 0.5 }", sphere),
            (
                "disk: { center: [0, 0, 2], normal: [0, 0, 1], radius: 1 }",
                disk,
            ),
            ("box: { min: [0, 0, 2], max: [1, 1, 3] }", triangle),
        ] {
            let found = below_lamp(model, lamp) / (0.5 * 3.0);
            assert!(
                (found / expected - 1.0).abs() < 0.01,
                "{model} {lamp}: {found}, expected {expected}"
            );
        }
    }
}

/// Half of a lamp's light comes from a row of large facets below the floor, the other half from
/// 255 rows of small ones above it; together they are a rectangle.
#[test]
fn small_facets_of_a_mesh_get_their_share_of_samples() {
    // A little more than half: 24 bits that choose one of 2^18 facets have six left to decide.
    const SHARE: f32 = (0.5 + 1.0 / 128.0) * 255.0 / 256.0;
    let lamp = tempfile::NamedTempFile::with_suffix(".ply").unwrap();
    let mut ply = "ply\nformat binary_little_endian 1.0\nelement vertex 132354\n\
                   property float x\nproperty float y\nproperty float z\n\
                   element face 262144\nproperty list uchar int vertex_indices\nend_header\n"
        .as_bytes()
        .to_vec();
    let small = (0..256).map(|row| [row as f32 / 255.0, 2.0]);
    let large = [0.0, (1.0 - SHARE) / SHARE].map(|y| [y, -1.0]);
    for [y, z] in small.chain(large) {
        let places = (0..=512).flat_map(|column| [column as f32 / 512.0, y, z]);
        ply.extend(places.flat_map(f32::to_le_bytes));
    }
    for row in (0..255).chain([256]) {
        for column in 0..512 {
            let at = [0, 513, 1, 1, 513, 514].map(|corner| row * 513 + column + corner);
            for facet in at.as_chunks::<3>().0 {
                ply.push(3);
                ply.extend(facet.iter().flat_map(|corner: &i32| corner.to_le_bytes()));
            }
        }
    }
    std::fs::write(&lamp, ply).unwrap();
    let expected = above_corner(1.0, 1.0, 2.0);
    for model in ["model: path", "model: blinn_phong, ambient: 0"] {
        let mesh = format!("mesh: {{ file: {:?}, normals: flat }}", lamp.path());
        let found = below_lamp(model, &mesh) / (0.5 * 3.0);
        assert!(
            (found / expected - 1.0).abs() < 3e-3,
            "{model}: {found}, expected {expected}"
        );
    }
}

#[test]
fn a_sphere_above_the_floor_occludes_its_share_of_the_sky() {
    for (keys, expected) in [
        ("", 1.0 - (0.5_f32 / 3.0).powi(2)),
        ("occlusion_distance: 2.6, ", 1.0 - (0.5_f32 / 3.0).powi(2)),
        ("occlusion_distance: 2.4, ", 1.0),
    ] {
        let radiance = radiance(&format!(
            "{DOWN}shading: {{ {keys}model: ambient_occlusion }}
materials: {{ floor: {{ color: 1 }} }}
lights: []
objects:
  - plane: {{ point: [0, 0, 0], normal: [0, 0, 1] }}
    material: floor
  - sphere: {{ center: [0, 0, 3], radius: 0.5 }}
    material: floor
"
        ));
        let found = mean(&radiance).x;
        // Short rays reach a part of the sphere.
        let tolerance = if keys.contains("2.6") { 0.025 } else { 1e-3 };
        assert!(
            (found - expected).abs() < tolerance,
            "{keys}{found} {expected}"
        );
    }
}

#[test]
fn a_penumbra_is_as_wide_as_geometry_says() {
    // A lamp 2 wide at a height of 4, and the edge of a wall at a height of 1: the shadow
    // fades from x = -1/3 to x = 1/3, of which the wall hides the left half.
    let radiance = radiance(
        "image: { width: 100, height: 1, samples_per_pixel: 1024, sampler: sobol }
camera: { orthographic: { eye: [0.25, 0, 2], target: [0.25, 0, 0], up: [0, 1, 0], height: 0.005 } }
shading: { model: path, max_depth: 1 }
cost: counters
materials:
  floor: { color: 1 }
  black: { color: 0 }
  lamp: { emission: 1 }
lights: []
objects:
  - plane: { point: [0, 0, 0], normal: [0, 0, 1] }
    material: floor
  - rectangle: { corner: [-9, -9, 1], edges: [[9, 0, 0], [0, 18, 0]] }
    material: black
  - rectangle: { corner: [-1, -0.01, 4], edges: [[2, 0, 0], [0, 0.02, 0]] }
    material: lamp
",
    );
    let lit = radiance[99].x;
    let at = |x: f32| radiance[(100.0 * (2.0 * x)) as usize].x / lit;
    assert!((at(0.003) - 0.5).abs() < 0.03, "{}", at(0.003));
    assert!(
        at(0.30) < 0.99 && at(0.345) > 0.99,
        "{} {}",
        at(0.30),
        at(0.345)
    );
}

#[test]
fn surfaces_of_one_side_are_black_from_behind() {
    let seen = |material: &str, normal: &str| {
        let radiance = radiance(&format!(
            "{DOWN}shading: {{ model: path }}
background: 1
materials: {{ m: {{ {material} }} }}
lights: []
objects: [{{ plane: {{ point: [0, 0, 0], normal: {normal} }}, material: m }}]
"
        ));
        mean(&radiance).x
    };
    let (front, back) = ("[0, 0, 1]", "[0, 0, -1]");
    assert_eq!(seen("emission: 2", front), 2.0);
    assert_eq!(seen("emission: 2", back), 2.0);
    assert_eq!(seen("emission: 2, two_sided: false", front), 2.0);
    assert_eq!(seen("emission: 2, two_sided: false", back), 0.0);
    assert!((seen("color: 0.5, two_sided: false", front) - 0.5).abs() < 1e-5);
    assert_eq!(seen("color: 0.5, two_sided: false", back), 0.0);
}

#[test]
fn russian_roulette_and_choosing_one_light_keep_the_mean() {
    let box_of = |keys: &str| {
        mean(&radiance(&format!(
            "image: {{ width: 16, height: 16, samples_per_pixel: 256, sampler: sobol }}
camera: {{ look_at: {{ eye: [0, 0, 2.9], target: [0, 0, 0], fov_y_deg: 60 }} }}
shading: {{ model: path, {keys} }}
cost: counters
materials:
  wall: {{ color: [0.8, 0.7, 0.6] }}
  lamp: {{ emission: [4, 5, 6] }}
  other: {{ emission: [9, 1, 1] }}
lights: [point: {{ position: [1, 1, 1], falloff: inverse_square }}]
objects:
  - box: {{ min: [-3, -3, -3], max: [3, 3, 3] }}
    material: wall
  - sphere: {{ center: [-1, 1, 0], radius: 0.4 }}
    material: lamp
  - disk: {{ center: [1, -1, 0], normal: [0, 1, 0.3], radius: 0.5 }}
    material: other
"
        )))
    };
    let each = box_of("light_sampling: each, max_depth: 40");
    let by_power = box_of("light_sampling: power, max_depth: 40");
    assert!(
        (each / by_power - 1.0).abs().max_element() < 0.015,
        "{each} {by_power}"
    );
    let direct = box_of("max_depth: 1");
    assert!(each.x > 1.4 * direct.x, "{each} {direct}");
}

/// A scene of `n` lights of all kinds and a sky over a floor. Some are much brighter than others, and
/// some light nothing of it.
fn under_lights(n: u32, sampling: &str, n_samples: u32) -> String {
    let [mut materials, mut lights, mut objects] = [const { String::new() }; 3];
    for i in 0..n {
        let (x, z) = (0.37 * f64::from(i % 7) - 1.0, 2.0 + 0.01 * f64::from(i));
        let intensity = if i.is_multiple_of(5) { 3.0 } else { 0.1 };
        let place = format!("position: [{x}, 0.5, 1], intensity: {intensity}");
        let light = match i % 7 {
            0 => format!("spot: {{ {place}, target: [0, 0, 0], angle_deg: 80, falloff: inverse }}"),
            1 => format!("spot: {{ {place}, target: [{x}, 9, 1], angle_deg: 30 }}"),
            2 => format!("point: {{ {place}, falloff: inverse_square }}"),
            3 => format!("point: {{ {place}, color: [0, 0, 1] }}"),
            4 => format!("directional: {{ direction: [{x}, 0, -1], intensity: {intensity} }}"),
            kind => {
                let shape = match kind {
                    5 => format!("sphere: {{ center: [{x}, 1, {z}], radius: 0.05 }}"),
                    _ => format!(
                        "rectangle: {{ corner: [{x}, -1, {z}], edges: [[0, 0.3, 0], [0.2, 0, 0]] }}"
                    ),
                };
                let emission = 20.0 * intensity;
                materials += &format!("  lamp{i}: {{ color: 0, emission: {emission} }}\n");
                objects += &format!("- {{ {shape}, material: lamp{i} }}\n");
                continue;
            }
        };
        lights += &format!("- {light}\n");
    }
    format!(
        "image: {{ width: 8, height: 8, samples_per_pixel: {n_samples}, sampler: sobol }}
camera: {{ orthographic: {{ eye: [0, 0, 1], target: [0, 0, 0], height: 2 }} }}
cost: none
shading: {{ model: path, max_depth: 1, light_sampling: {sampling} }}
background: {{ sky: {{ sun: {{ elevation_deg: 30, azimuth_deg: 120 }}, intensity: 0.1 }} }}
materials:
  floor: {{ color: 0.8 }}
{materials}lights:
{lights}objects:
- plane: {{ point: [0, 0, 0], normal: [0, 0, 1] }}
  material: floor
{objects}"
    )
}

#[test]
fn a_choice_of_lights_finds_the_light_of_all() {
    for n in [1, 2, 7, 14, 15, 40, 1000] {
        let n_samples = if n < 100 { 64 } else { 16 };
        let each = mean(&radiance(&under_lights(n, "each", n_samples)));
        let by_power = mean(&radiance(&under_lights(n, "power", 1024)));
        let ratio = by_power / each;
        let tolerance = if n < 100 { 5e-3 } else { 0.02 };
        assert!(
            (ratio - 1.0).abs().max_element() < tolerance,
            "{n}: {each} {by_power}"
        );
    }
}

#[test]
fn a_point_light_shines_through_frosted_glass_as_a_small_lamp_does() {
    let seen = |material: &str, lights: &str, objects: &str| {
        mean(&radiance(&format!(
            "{DOWN}shading: {{ model: path, max_depth: 1 }}
materials:
  pane: {material}
  lamp: {{ color: 0, emission: 5000 }}
lights: [{lights}]
objects:
  - plane: {{ point: [0, 0, 0], normal: [0, 0, 1] }}
    material: pane
{objects}"
        )))
    };
    // A sphere sends its radiance times its cross section; the unit of a point light is pi.
    let intensity = 5000.0 * 0.01 * 0.01;
    for (material, z) in [
        ("{ color: 0.7 }", 2.0),
        ("{ dielectric: { index: 1.5 }, roughness: 0.6 }", 2.0),
        ("{ dielectric: { index: 1.5 }, roughness: 0.6 }", -2.0),
        (
            "{ dielectric: { index: 1.2, absorption: [0.1, 0.3, 0.9] }, roughness: 0.5 }",
            -2.0,
        ),
        (
            "{ color: [0.9, 0.5, 0.2], principled: { transmission: 0.6, roughness: 0.7 } }",
            -2.0,
        ),
    ] {
        let light = format!(
            "point: {{ position: [0.3, 0, {z}], intensity: {intensity}, falloff: inverse_square }}"
        );
        let lamp = format!(
            "  - {{ sphere: {{ center: [0.3, 0, {z}], radius: 0.01 }}, material: lamp }}\n"
        );
        let (by_point, by_lamp) = (seen(material, &light, ""), seen(material, "", &lamp));
        assert!(
            (by_point / by_lamp - 1.0).abs().max_element() < 0.02,
            "{material} {z}: {by_point} {by_lamp}"
        );
    }
}
