//! A scene of any size, at any place, has the same picture.

use proptest::prelude::*;
use render::film::{Film, Strip};
use scene::config::{Config, CostMode, ShadingModel};

use crate::common::generators::cases;
use crate::common::moved::{Similarity, Turn};
use crate::common::scenes::{RandomScene, scenes as random_scenes};
use crate::common::{film, in_repository, mean, parse, radiance};

const SIZE: [u32; 2] = [40, 30];

/// The film of a small picture of a scene.
fn small(config: Config) -> Film {
    let n_samples = config.image.samples_per_pixel.min(4);
    sampled(config, n_samples)
}

/// The film of a small picture of a scene with this number of samples.
fn sampled(mut config: Config, n_samples: u32) -> Film {
    [config.image.width, config.image.height] = SIZE;
    config.image.samples_per_pixel = n_samples;
    config.image.adaptive = None;
    config.cost = CostMode::Counters;
    film(&config, 2)
}

/// The scenes of `configs/`, without those of the course's model, whose rays start at a
/// distance in world units.
fn scenes() -> Vec<(String, String)> {
    let folder = std::fs::read_dir(in_repository("configs")).unwrap();
    let files = folder.map(|entry| entry.unwrap().path());
    let mut scenes: Vec<_> = files
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "yaml")
        })
        .map(|path| {
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            let text = std::fs::read_to_string(&path).unwrap();
            let same = Similarity {
                scale: 1.0,
                shift: [0.0; 3],
            };
            (name, same.of_text(&text))
        })
        .filter(|(name, text)| {
            // A million spheres take their time.
            name != "million_spheres" && parse(text).shading.model != ShadingModel::Seed
        })
        .collect();
    scenes.sort();
    assert!(scenes.len() > 15);
    scenes
}

fn colors(film: &Film) -> Vec<u8> {
    film.values(|strip: &Strip| &strip.rgb).flatten().collect()
}

/// Makes sure that the scene, scaled by a power of two, has the same film.
fn check_scaled(name: &str, text: &str, original: &Film, exponent: i32) {
    let scale = f64::from(exponent).exp2();
    let similarity = Similarity {
        scale,
        shift: [0.0; 3],
    };
    let scaled = small(parse(&similarity.of_text(text)));
    assert!(
        colors(&scaled) == colors(original),
        "{name} times 2^{exponent}"
    );
    assert_eq!(scaled.totals, original.totals, "{name} times 2^{exponent}");
    let [a, b] = [original, &scaled].map(|film| film.values(|strip| &strip.distance));
    for (a, b) in a.zip(b) {
        let scaled = (f64::from(a) * scale) as f32;
        assert!(b == scaled || (a.is_nan() && b.is_nan()), "{name}: {a} {b}");
    }
}

/// The share of the pixels that differ by more than eight levels, and the difference of the
/// means in levels.
fn difference(a: &Film, b: &Film) -> [f64; 2] {
    let [a, b] = [a, b].map(colors);
    let differs = |(a, b): (&[u8], &[u8])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 8);
    let n = a
        .chunks(3)
        .zip(b.chunks(3))
        .filter(|pixels| differs(*pixels))
        .count();
    let mean = |levels: &[u8]| levels.iter().map(|level| f64::from(*level)).sum::<f64>();
    let n_levels = a.len() as f64;
    [
        3.0 * n as f64 / n_levels,
        (mean(&a) - mean(&b)).abs() / n_levels,
    ]
}

#[test]
fn powers_of_two_change_no_byte() {
    for (name, text) in scenes() {
        let original = small(parse(&text));
        for exponent in [-30, 30] {
            check_scaled(&name, &text, &original, exponent);
        }
    }
}

/// Other sizes, and places that are whole periods of all patterns away.
fn similarities() -> [Similarity; 3] {
    [(1e-6, 240.0), (1e9, -1.2e5), (1.0, 2.4e7)].map(|(scale, sizes)| Similarity {
        scale,
        shift: [1.0, -0.5, 0.75].map(|along| along * sizes * scale),
    })
}

#[test]
fn any_size_and_place_has_the_same_picture() {
    for (name, text) in scenes() {
        let original = small(parse(&text));
        // Among chairs and books, rounding sends long paths elsewhere: that is noise, which falls
        // with the number of samples.
        let most = if name == "reading_room" { 0.1 } else { 0.02 };
        for similarity in similarities() {
            let moved = small(parse(&similarity.of_text(&text)));
            let [share, mean] = difference(&original, &moved);
            assert!(
                share < most && mean < 0.5,
                "{name} at {similarity:?}: {share} {mean}"
            );
        }
    }
}

/// The mean level of each block of 10 x 10 pixels.
fn block_means(film: &Film) -> Vec<f64> {
    let [width, height] = SIZE.map(|n| n as usize);
    let n_columns = width / 10;
    let mut means = vec![0.0; n_columns * height / 10];
    for (i, level) in colors(film).into_iter().enumerate() {
        let [x, y] = [i / 3 % width, i / 3 / width];
        means[n_columns * (y / 10) + x / 10] += f64::from(level) / 300.0;
    }
    means
}

/// Makes sure that other scenes have the same picture within noise.
fn check_equal(name: &str, text: &str, others: &[String]) {
    let blocks = |text: &str| block_means(&sampled(parse(text), 128));
    let original = blocks(text);
    for other in others {
        let pairs = original.iter().zip(blocks(other));
        let differences: Vec<f64> = pairs.map(|(a, b)| a - b).collect();
        let mean = differences.iter().sum::<f64>() / differences.len() as f64;
        let is_noise = differences.iter().all(|block| block.abs() < 12.0);
        assert!(
            is_noise && mean.abs() < 1.5,
            "{name}: {mean}, {differences:?}"
        );
    }
}

const TURN: Turn = Turn { angle_deg: 37.0 };

#[test]
fn a_turned_scene_has_the_same_picture() {
    let mut n_turned = 0;
    for (name, text) in scenes() {
        if let Some(turned) = TURN.of_text(&text) {
            check_equal(&name, &text, &[turned]);
            n_turned += 1;
        }
    }
    assert!(n_turned >= 8);
}

proptest! {
    #![proptest_config(cases(40))]

    #[test]
    fn powers_of_two_change_no_byte_of_random_scenes(
        scene in random_scenes(),
        exponent in -30..=30,
    ) {
        if scene.model != "seed" {
            let scene = RandomScene { size: SIZE, acceleration: "bvh", ..scene };
            let text = scene.text();
            check_scaled("random", &text, &small(parse(&text)), exponent);
        }
    }
}

proptest! {
    #![proptest_config(cases(12))]

    #[test]
    fn random_scenes_of_any_size_place_and_direction_have_the_same_picture(scene in random_scenes()) {
        if scene.model != "seed" {
            let scene = RandomScene { size: SIZE, acceleration: "bvh", ..scene };
            let text = scene.text();
            let others = similarities().map(|similarity| similarity.of_text(&text));
            let others: Vec<String> = others.into_iter().chain(TURN.of_text(&text)).collect();
            check_equal("random", &text, &others);
        }
    }
}

/// The light that a floor reflects below the middle of a lamp: the mean over a small picture,
/// and the analytic value.
fn below_lamp(lamp: &str, [size, height]: [f64; 2], model: &str, place: f64) -> f64 {
    // The part of the floor that is seen is small against the lamp and its distance.
    let seen = 1e-3 * size.min(height);
    let half = 0.5 * size;
    let (top, eye) = (place + height, place + 0.5 * height);
    let shape = match lamp {
        "disk" => format!("disk: {{ center: [0, {top}, 0], normal: [0, -1, 0], radius: {half} }}"),
        "sphere" => {
            let center = top + half;
            format!("sphere: {{ center: [0, {center}, 0], radius: {half} }}")
        }
        _ => format!(
            "rectangle: {{ corner: [-{half}, {top}, -{half}], edges: [[{size}, 0, 0], [0, 0, {size}]] }}"
        ),
    };
    let target = place;
    let width = 10.0 * (size + height);
    let side = 2.0 * width;
    mean(&radiance(&format!(
        "image: {{ width: 16, height: 16, samples_per_pixel: 256 }}
camera: {{ orthographic: {{ eye: [0, {eye}, 0], target: [0, {target}, 0], up: [0, 0, 1], height: {seen} }} }}
shading: {{ model: {model} }}
materials:
  floor: {{ color: 0.5 }}
  lamp: {{ color: 0, emission: 1 }}
objects:
  - rectangle: {{ corner: [-{width}, {place}, -{width}], edges: [[0, 0, {side}], [{side}, 0, 0]] }}
    material: floor
  - {shape}
    material: lamp
lights: []
"
    )))
    .x
    .into()
}

/// The irradiance of a lamp of radiance 1, over pi.
fn form_factor(lamp: &str, [size, height]: [f64; 2]) -> f64 {
    let half = 0.5 * size;
    match lamp {
        "disk" => half * half / (half * half + height * height),
        "sphere" => (half / (half + height)).powi(2),
        _ => {
            // Four rectangles with a corner above the point: Howell's catalog, B-4.
            let (a, root) = (half / height, (1.0 + (half / height).powi(2)).sqrt());
            4.0 * (a / root) * (a / root).atan() / std::f64::consts::PI
        }
    }
}

#[test]
fn lamps_light_what_is_near_and_what_is_far() {
    for lamp in ["disk", "sphere", "rectangle"] {
        for model in ["blinn_phong", "path"] {
            let model = if model == "path" {
                "path"
            } else {
                "blinn_phong, ambient: 0"
            };
            for distance in [1e-4, 1e-2, 0.3, 1.0, 30.0, 1e4] {
                // Points of a disk are chosen by area: hardly ever those just above.
                if lamp == "disk" && model != "path" && distance < 0.1 {
                    continue;
                }
                for (size, place) in [(1.0, 0.0), (0.1, 0.0), (1e-5, 0.0), (2.0, 10.0), (3e4, 1e6)]
                {
                    let shape = [size, size * distance];
                    let found = below_lamp(lamp, shape, model, place);
                    let expected = 0.5 * form_factor(lamp, shape);
                    let error = found / expected - 1.0;
                    assert!(
                        error.abs() < 5e-3,
                        "{lamp}, {model}, size {size} at {place}, distance {distance}: {found}, not {expected}"
                    );
                }
            }
        }
    }
}

/// The light of a lamp of unit height above a floor of half this width, as the camera sees it.
fn on_floor(lamp: &str, floor: &str, model: &str) -> f64 {
    mean(&radiance(&format!(
        "image: {{ width: 16, height: 12, samples_per_pixel: 64 }}
camera: {{ look_at: {{ eye: [0.3, 1.2, 3], target: [0, 0, 0], fov_y_deg: 20 }} }}
shading: {{ model: {model}, max_depth: 1 }}
materials: {{ floor: {{ color: 0.5 }}, lamp: {{ color: 0, emission: 100 }} }}
objects:
  - {{ {floor}, material: floor }}
  - {{ {lamp}, material: lamp }}
lights: []
"
    )))
    .x
    .into()
}

#[test]
fn a_large_floor_is_lit_as_a_small_one() {
    let lamps = [
        "box: { min: [-.05, 2, -.05], max: [.05, 2.1, .05] }",
        "cylinder: { ends: [[-.5, 2, 0], [.5, 2, 0]], radius: .002 }",
        "capsule: { ends: [[-.5, 2, 0], [.5, 2, 0]], radius: .02 }",
        "cone: { ends: [[-.5, 2, 0], [.5, 2, 0]], radius: [.05, .01] }",
        "rectangle: { corner: [-.5, .1, -.5], edges: [[1, 0, 0], [0, 0, 1]] }",
        "disk: { center: [0, .1, 0], radius: .5, normal: [0, -1, 0] }",
        "sphere: { center: [0, .6, 0], radius: .5 }",
    ];
    let floors: [fn(f64) -> String; 2] = [
        |half| {
            let side = 2.0 * half;
            format!(
                "rectangle: {{ corner: [-{half}, 0, -{half}], edges: [[0, 0, {side}], [{side}, 0, 0]] }}"
            )
        },
        |half| format!("box: {{ min: [-{half}, -{half}, -{half}], max: [{half}, 0, {half}] }}"),
    ];
    for lamp in lamps {
        for floor in floors {
            for model in ["path", "blinn_phong, ambient: 0"] {
                let small = on_floor(lamp, &floor(10.0), model);
                for half in [500.0, 5e4] {
                    let large = on_floor(lamp, &floor(half), model);
                    let error = large / small - 1.0;
                    assert!(error.abs() < 1e-4, "{lamp}, {half}, {model}: {error}");
                }
            }
        }
    }
}
