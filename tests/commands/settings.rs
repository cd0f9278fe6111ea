//! `--set` sets one value of a scene, and messages point at the setting if it is wrong.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use host::text::Diagnostic;
use scene::config::Config;
use scene::yaml::{Document, Source};

use crate::common::{assert_success, raycost};

pub const SCENE: &str = "\
image: { width: 40, height: 30 }
camera: { look_at: { eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 40 } }
acceleration: bvh
film:
materials: { chrome: { color: [1, 0, 0] }, a.b: { color: 1 } }
lights: [{ point: { position: [5, 5, 5] } }]
objects:
  - sphere: { center: [0, 0, 0], radius: 1 }
    material: chrome
  - box: { min: [0, 0, 0], max: [1, 1, 1] }
    material: a.b
";

fn with(settings: &[&str]) -> Result<Config, Diagnostic> {
    let mut document = Document::new(Source::new("scene.yaml", SCENE), Config::MERGING)?;
    settings
        .iter()
        .try_for_each(|setting| document.set(setting))?;
    document.parse()
}

#[test]
fn a_setting_does_what_an_edit_of_the_file_does() {
    for (setting, old, new) in [
        (
            "camera.look_at.fov_y_deg=30.5",
            "fov_y_deg: 40",
            "fov_y_deg: 30.5",
        ),
        (
            "objects[0].sphere.center[2]=-1e-3",
            "[0, 0, 0], radius",
            "[0, 0, -1e-3], radius",
        ),
        (
            "objects[1].material=chrome",
            "material: a.b",
            "material: chrome",
        ),
        (
            "materials.\"a.b\".color=\"#ff0000\"",
            "{ color: 1 }",
            "{ color: \"#ff0000\" }",
        ),
        (
            "image={ width: 4, height: 3, seed: 7 }",
            "width: 40, height: 30",
            "width: 4, height: 3, seed: 7",
        ),
        // Keys that the file leaves out.
        (
            "image.samples_per_pixel = 4",
            "height: 30",
            "height: 30, samples_per_pixel: 4",
        ),
        (
            "shading.max_depth=2",
            "acceleration",
            "shading: { max_depth: 2 }\nacceleration",
        ),
        ("film.exposure=1", "film:", "film: { exposure: 1 }"),
        (
            "materials.chrome.specular=0.5",
            "[1, 0, 0] }",
            "[1, 0, 0], specular: 0.5 }",
        ),
        (
            "objects[0].name=7",
            "material: chrome",
            "material: chrome\n    name: 7",
        ),
        ("lights=[]", "[{ point: { position: [5, 5, 5] } }]", "[]"),
    ] {
        let edited = SCENE.replacen(old, new, 1);
        assert_ne!(edited, SCENE, "{setting}");
        // A key may be followed by blanks.
        let setting = setting.replace(" = ", "=");
        let expected: Config = Source::new("scene.yaml", edited).parse().unwrap();
        assert_eq!(with(&[&setting]).unwrap(), expected, "{setting}");
    }
}

#[test]
fn later_settings_win() {
    let config = with(&[
        "image.seed=1",
        "image={ width: 8, height: 8 }",
        "image.seed=3",
    ])
    .unwrap();
    assert_eq!((config.image.width, config.image.seed), (8, 3));
}

/// Settings of [`SCENE`], the column of the mistake, and parts of the message.
const WRONG_SETTINGS: &str = r#"camera.lookat.fov_y_deg=3 | 8 | the scene has no `camera.lookat` | no such key in the scene | did you mean `look_at`? (the only key there is `look_at`)
materials.chrme.color=1 | 11 | the scene has no `materials.chrme` | no such key in the scene | did you mean `chrome`? (the keys there are `chrome`, `a.b`)
materials.chrme={ color: 1 } | 11 | the scene has no `materials.chrme` | no such key in the scene | did you mean `chrome`?
camera.look_at.fov=3 | 16 | unknown key `fov` | no such key here | did you mean `fov_y_deg`?
flim.exposure=1 | 1 | unknown key `flim` | no such key here | did you mean `film`?
objects[0].sphere.radius=-1 | 26 | `objects[0].sphere.radius` cannot be `-1` | expected a number greater than 0
image={ width: 10, heigth: 3 } | 20 | unknown key `heigth` | no such key here | did you mean `height`?
image={ width: 1_000, height: 3 } | 16 | `image.width` cannot be the text "1_000" | expected a whole number | did you mean `1000`?
objects[2].name=x | 8 | the scene has no `objects[2]` | expected [0] to [1]
objects.name=x | 9 | `objects` is a list | expected the number of an item
image[0]=1 | 6 | `image` is not a list | expected `.` and a key, or `=`
acceleration.quality=high | 14 | `acceleration` is `bvh`, which has no keys | no such key | --set 'acceleration={ … }'
objects[0].material=chrme | 21 | unknown material `chrme` | expected a key of `materials` | did you mean `chrome`?
objects[0].material=[chrome, x] | 21 | a sphere has one material, not 2 | expected one name
include=[a.yaml] | 1 | a setting cannot include files | another section
image.width=[1 | 13 | invalid YAML syntax | never closed | bracket
image.width=!x 1 | 13 | the tag `!x` has no meaning | without `!`
image.width=#ff | 12 | the setting has no value | expected a value | but in quotes
objects[0]name=1 | 11 | the path goes on without a `.` | expected `.`
image.width | 1 | the setting has no `=` | expected `key=value` | --set image.seed=7
image.width= | 12 | the setting has no value | expected a value
.width=1 | 1 | a key is missing | expected a name
objects[first]=1 | 8 | an item of a list is named by its number | `[0]` for the first"#;

#[test]
fn a_wrong_setting_is_shown_with_a_caret() {
    for case in WRONG_SETTINGS.lines() {
        let (setting, expected) = case.split_once(" | ").unwrap();
        let (column, expected) = expected.split_once(" | ").unwrap();
        let error = match with(&[setting]) {
            Err(error) => error.to_string(),
            // A mistake that only the other sections show.
            Ok(_) => stderr_of(&check(Path::new("."), SCENE, &["--set", setting])),
        };
        let position = format!("--> --set:1:{column}\n");
        for expected in expected.split(" | ").chain([position.as_str()]) {
            assert!(
                error.contains(expected),
                "{setting}: no {expected} in\n{error}"
            );
        }
    }
}

/// Keys that exist, but do not fit others.
#[test]
fn a_known_key_is_not_called_unknown() {
    for (settings, expected) in [
        (
            ["camera.look_at.focal_length_mm=50"].as_slice(),
            "two angles of view",
        ),
        (
            &["shading.model=path", "shading.shadows=false"],
            "cannot choose whether",
        ),
        (
            &["materials.chrome.roughness=0.4"],
            "cannot have a `roughness`",
        ),
    ] {
        let error = with(settings).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

/// Two wrong settings: the message is that of a plain mistake.
#[test]
fn a_setting_and_its_path_have_a_depth() {
    let steps = "a.".repeat(64);
    for (setting, is_fine) in [
        (format!("foo={}1", "- ".repeat(20_000)), false),
        (format!("{}b=1", "a.".repeat(20_000)), false),
        (
            format!("{steps}b={}{}", "[".repeat(63), "]".repeat(63)),
            true,
        ),
        (
            format!("{steps}b={}{}", "[".repeat(64), "]".repeat(64)),
            false,
        ),
    ] {
        let error = with(&[&setting]).unwrap_err().to_string();
        assert_eq!(error.contains("nested too deeply"), !is_fine, "{error}");
        assert!(error.contains(" --> --set:1:"), "{error}");
    }
}

#[test]
fn a_mistake_of_the_file_is_shown_in_the_file() {
    let broken = SCENE.replace("radius: 1", "radios: 1");
    let mut document = Document::new(Source::new("scene.yaml", broken), Config::MERGING).unwrap();
    document.set("film.exposure=1").unwrap();
    let error = document.parse::<Config>().unwrap_err().to_string();
    assert!(
        error.contains("--> scene.yaml:8:34\n") && error.contains("`radius`?"),
        "{error}"
    );
}

/// Runs `raycost check -` in a folder.
fn check(folder: &Path, scene: &str, arguments: &[&str]) -> Output {
    of_input(
        raycost().args(["check", "-"]).args(arguments),
        folder,
        scene,
    )
}

fn of_input(command: &mut Command, folder: &Path, input: &str) -> Output {
    use std::io::Write;

    command.current_dir(folder).stdin(Stdio::piped());
    let mut child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child
        .stdin
        .take()
        .unwrap()
        .write_all(input.as_bytes())
        .unwrap();
    child.wait_with_output().unwrap()
}

/// The message of a run that refused its input.
pub fn stderr_of(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn a_scene_from_standard_input_is_rendered_and_its_mistakes_are_shown() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    fs::write(folder.path().join("mesh.obj"), mesh).unwrap();
    let scene = SCENE.replace(
        "sphere: { center: [0, 0, 0], radius: 1 }",
        "mesh: { file: mesh.obj }",
    );
    let rendered = of_input(
        raycost().args(["render", "-", "--set", "image.seed=5"]),
        folder.path(),
        &scene,
    );
    assert_success(&rendered);
    assert!(
        !String::from_utf8(rendered.stdout)
            .unwrap()
            .contains("raycost trace")
    );
    let summary = fs::read(folder.path().join("out/stdin/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_slice(&summary).unwrap();
    assert_eq!(summary["scene"]["set"], serde_json::json!(["image.seed=5"]));
    assert_eq!(summary["image"]["seed"], 5);
    let error = stderr_of(&check(folder.path(), "image: 3\n", &[]));
    assert!(error.contains("--> stdin:1:8"), "{error}");
}
