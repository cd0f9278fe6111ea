//! A scene of several files is one scene, and messages name the file of the mistake.

use std::fs;
use std::path::Path;

use host::text::Diagnostic;
use scene::config::Config;
use scene::yaml::{Document, Source};

use crate::common::{assert_success, film, in_repository, raycost};
use crate::settings::{SCENE, stderr_of};

/// A folder with a scene of several files.
fn scene_of_files() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    write(
        "scene.yaml",
        "include: [library/metals.yaml, parts.yml, library/metals.yaml]
image: { width: 40, height: 30 }
materials: { red: { color: [1, 0, 0] }, zinc: { color: 0.5 } }
objects:
  - sphere: { center: [3, 0, 0], radius: 1 }
    material: red
",
    );
    write(
        "library/metals.yaml",
        "materials:\n  gold: { conductor: gold }\n  zinc: { color: 0.7 }\n",
    );
    write(
        "parts.yml",
        "include: [library/metals.yaml, more/floor.yaml]
camera: { look_at: { eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 40 } }
lights: [{ point: { position: [5, 5, 5] } }]
objects:
  - box: { min: [0, 0, 0], max: [1, 1, 1] }
    material: gold
",
    );
    write(
        "more/floor.yaml",
        "materials: { floor: { color: 0.2 } }
lights: []
objects:
  - mesh: { file: floor.obj }
    material: floor
",
    );
    write(
        "more/floor.obj",
        "v -9 -1 -9\nv 9 -1 -9\nv 0 -1 9\nf 1 2 3\n",
    );
    folder
}

fn read(path: &Path) -> Result<Config, Diagnostic> {
    Document::new(Source::read(path)?, Config::MERGING)?.parse()
}

#[test]
fn files_that_are_included_make_one_scene() {
    let folder = scene_of_files();
    let path = folder.path().join("scene.yaml");
    let config = read(&path).unwrap();
    let kinds: Vec<String> = config
        .objects
        .iter()
        .map(|o| o.geometry.to_string())
        .collect();
    assert_eq!(kinds, ["mesh", "box", "sphere"]);
    let materials: Vec<&String> = config.materials.keys().collect();
    assert_eq!(materials, ["gold", "zinc", "floor", "red"]);
    // The file's own material replaces that of the library.
    let alone: Config = crate::common::parse(&SCENE.replace("color: [1, 0, 0]", "color: 0.5"));
    assert_eq!(config.materials["zinc"], alone.materials["chrome"]);
    assert_eq!(config.lights, alone.lights);
    assert_eq!(config.camera, alone.camera);
    // The mesh is found beside the file that names it.
    let output = raycost().arg("check").arg(&path).output().unwrap();
    assert_success(&output);
    let set = ["--set", "objects[0].mesh.file=nowhere.obj"];
    let error = stderr_of(
        &raycost()
            .arg("check")
            .arg(&path)
            .args(set)
            .output()
            .unwrap(),
    );
    assert!(
        error.contains("`nowhere.obj`: ") && error.contains("--> --set:1:22"),
        "{error}"
    );
}

/// A file of the scene, what is replaced in it by what, and parts of the message.
const MISTAKES: &str = r#"more/floor.yaml | color: 0.2 | colour: 0.2 | more/floor.yaml:1:23 | unknown key `colour` | did you mean `color`?
more/floor.yaml | material: floor | material: flor | more/floor.yaml:5:15 | unknown material `flor` | did you mean `floor`?
more/floor.yaml | floor.obj | none.obj | more/floor.yaml:4:19 | none.obj`:  | expected a file
more/floor.yaml | lights: [] | lights: [ | more/floor.yaml:3:1 | invalid YAML syntax | is still open here
parts.yml | max: [1, 1, 1] | max: [1, 1] | parts.yml:5:33 | `objects[0].box.max` cannot be a list of 2
parts.yml | more/floor.yaml | more/flor.yaml | parts.yml:1:32 | more/flor.yaml`:  | starts from the folder
parts.yml | more/floor.yaml | more | parts.yml:1:32 | `more` is not a YAML file | .yaml or .yml
parts.yml | more/floor.yaml | more/floor.obj | parts.yml:1:32 | `more/floor.obj` is not a YAML file
parts.yml | [library/metals.yaml, more/floor.yaml] | more/floor.yaml | parts.yml:1:10 | `include` cannot be read | expected a list of files
parts.yml | more/floor.yaml | [x] | parts.yml:1:32 | `include[1]` cannot be read | list of files
parts.yml | camera: | camero: | parts.yml:2:1 | unknown key `camero` | did you mean `camera`?
more/floor.yaml | lights: [] | include: [../parts.yml] | more/floor.yaml:2:11 | parts.yml` includes itself | the circle closes here
more/floor.yaml | lights: [] | include: [../scene.yaml] | more/floor.yaml:2:11 | scene.yaml` includes itself
more/floor.yaml | floor: { | gold: { | more/floor.yaml:1:14 | `materials.gold` is given twice | metals.yaml` gives it, too
library/metals.yaml | materials: | camera: 1\nmaterials: | parts.yml:2:1 | `camera` is given twice | metals.yaml` gives it, too
library/metals.yaml | materials: | - materials: | library/metals.yaml:1:1 | an included file must have sections
scene.yaml | height: 30 | height: 0 | scene.yaml:2:29 | `image.height` cannot be `0`"#;

#[test]
fn mistakes_in_included_files_are_shown_there() {
    for case in MISTAKES.lines() {
        let parts: Vec<&str> = case.split(" | ").collect();
        let [file, old, new, ref expected @ ..] = parts[..] else {
            panic!("{case}")
        };
        let folder = scene_of_files();
        let path = folder.path().join(file);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains(old), "{file}: {old}");
        fs::write(&path, text.replacen(old, &new.replace("\\n", "\n"), 1)).unwrap();
        let scene = folder.path().join("scene.yaml");
        let error = stderr_of(&raycost().arg("check").arg(scene).output().unwrap());
        for expected in expected {
            assert!(
                error.contains(expected),
                "{case}: no {expected} in\n{error}"
            );
        }
    }
}

#[test]
fn no_scene_includes_files_without_end() {
    let folder = tempfile::tempdir().unwrap();
    for i in 0..400 {
        let text = format!("include: [{}.yaml]\n", i + 1);
        fs::write(folder.path().join(format!("{i}.yaml")), text).unwrap();
    }
    let error = read(&folder.path().join("0.yaml")).unwrap_err().to_string();
    assert!(error.contains("includes more than 256 files"), "{error}");
}

#[test]
fn every_material_of_the_library_renders() {
    let library = "include: [library/materials.yaml]\n";
    let path = in_repository("configs/scene.yaml").display().to_string();
    let document = |scene: String| Document::new(Source::new(&path, scene), Config::MERGING);
    let config: Config = document(library.to_owned() + SCENE)
        .unwrap()
        .parse()
        .unwrap();
    assert!(config.materials.len() > 12);
    for name in config.materials.keys() {
        let scene = SCENE.replace("material: chrome", &format!("material: {name}"));
        let config: Config = document(library.to_owned() + &scene)
            .unwrap()
            .parse()
            .unwrap();
        assert!(film(&config, 1).n_hits() > 100, "{name}");
    }
}
