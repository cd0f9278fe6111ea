//! A scene with every default written out is the same scene.

use std::fs;
use std::path::Path;

use proptest::prelude::*;
use scene::config::Config;
use scene::yaml::Source;

use crate::common::generators::cases;
use crate::common::{assert_success, in_repository, raycost};
use crate::mutations::originals;

/// Checks that the text of the resolved scene is the same scene.
pub fn assert_resolves(config: &Config) {
    let text = config.resolved(Path::new(""), Path::new("")).unwrap();
    let read: Config = Source::new("resolved.yaml", text.as_str())
        .parse()
        .unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert!(read == config.filled(), "{config:?}\n{text}");
}

#[test]
fn every_scene_resolves_to_itself() {
    for text in originals() {
        let source = Source::new("scene.yaml", text);
        if let Ok(config) = source.parse::<Config>() {
            assert_resolves(&config);
        }
    }
}

/// Multiplies the numbers with a decimal point by factors.
fn scaled(text: &str, factors: &[f64]) -> String {
    let mut factors = factors.iter().cycle();
    let is_number = |c: char| c.is_ascii_digit() || c == '.' || c == '-';
    let words = text.split_inclusive(|c: char| !is_number(c));
    let scaled = |word: &str| {
        let number = word.trim_end_matches(|c: char| !is_number(c));
        match number.parse::<f64>() {
            Ok(value) if number.contains('.') => {
                let product = value * factors.next().unwrap_or(&1.0);
                format!("{product:?}{}", &word[number.len()..])
            }
            _ => word.to_owned(),
        }
    };
    words.map(scaled).collect()
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn scenes_of_random_numbers_keep_every_bit(
        text in prop::sample::select(originals()),
        factors in prop::collection::vec(0.5_f64..1.5, 1..40),
    ) {
        let source = Source::new("scene.yaml", scaled(&text, &factors));
        if let Ok(config) = source.parse::<Config>() {
            assert_resolves(&config);
        }
    }
}

/// Renders a scene of several files, and what it resolves to in another folder. Returns the pictures.
fn pictures(included: &str) -> [Vec<u8>; 2] {
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = ["first", "second"].map(|name| folder.path().join(name));
    for scene in [&first, &second] {
        fs::create_dir_all(scene.join("library")).unwrap();
        let copy = |from: &str, to: &Path| fs::copy(in_repository(from), to).unwrap();
        copy("configs/pictures/planks.png", &scene.join("planks.png"));
        let cow = scene.join(included).with_file_name("spot.obj");
        copy("configs/meshes/spot.obj", &cow);
    }
    let cow = "
lights: [{ spot: { position: [1, 3, 2], target: [0.1, 0, 0.3], angle_deg: 71 } }]
objects:
  - mesh: { file: spot.obj }
    material: planks
    transform: [{ rotate: { axis: [1, 2, 3], angle_deg: 10 } }]
";
    fs::write(first.join(included), cow).unwrap();
    let scene = format!(
        "include: [{included}]
image: {{ width: 40, height: 30, filter: tent }}
camera:
  look_at:
    eye: [1.1, 1, -3]
    target: [0, 0, 0]
    focal_length_mm: 30
    lens: {{ f_number: 2, blades: 5 }}
materials:
  planks: {{ color: {{ image: {{ file: planks.png, mapping: spherical }} }}, specular: 0.3 }}
"
    );
    fs::write(first.join("scene.yaml"), scene).unwrap();
    let run = |scene: &Path, arguments: &[&str]| {
        let mut command = raycost();
        let output = command.current_dir(scene).args(arguments).output();
        let output = output.unwrap();
        assert_success(&output);
        output.stdout
    };
    let resolved = run(&first, &["check", "scene.yaml", "--resolved"]);
    fs::write(second.join("scene.yaml"), resolved).unwrap();
    [&first, &second].map(|scene| {
        run(scene, &["render", "scene.yaml", "-q", "-o", "image.png"]);
        fs::read(scene.join("image.png")).unwrap()
    })
}

/// The file has the run's ID, a hash of the settings: it is the same, too.
#[test]
fn a_resolved_scene_gives_the_same_bytes() {
    let [given, resolved] = pictures("cow.yaml");
    assert!(given == resolved);
}

#[test]
fn paths_of_included_files_start_from_the_scene() {
    let [given, resolved] = pictures("library/cow.yaml");
    let pixels = |png: &[u8]| image::load_from_memory(png).unwrap().into_rgb8();
    assert!(pixels(&given) == pixels(&resolved) && given != resolved);
}

#[test]
fn only_scenes_are_resolved() {
    let mut command = raycost();
    let study = in_repository("configs/studies/tiles.yaml");
    let output = command.arg("check").arg(study).arg("--resolved").output();
    let output = output.unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("is a study"), "{message}");
    assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0));
}
