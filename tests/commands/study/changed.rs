//! Runs are never mixed with those of other flags, another scene, or another program.

use std::fs;
use std::path::Path;

use super::{STUDY, folder, lines, run, stderr_of};
use crate::common::{assert_success, in_repository};

/// Replaces a part of a text file, which it has.
fn replace(file: &Path, old: &str, new: &str) {
    let text = fs::read_to_string(file).unwrap();
    assert!(text.contains(old), "{text}");
    fs::write(file, text.replace(old, new)).unwrap();
}

/// Checks that the study is refused and its log stays as it is.
fn assert_refused(folder: &Path, flags: &[&str], expected: &str) {
    let log = folder.join("out/runs.jsonl");
    let before = fs::read(&log).unwrap();
    let refused = run(folder, flags);
    let message = stderr_of(&refused);
    assert_eq!(refused.status.code(), Some(2), "{message}");
    assert!(message.contains(expected), "{message}");
    let help = "give another folder by `--out`, or delete `out` to measure anew";
    assert!(message.contains(help), "{message}");
    assert_eq!(fs::read(&log).unwrap(), before);
}

#[test]
fn another_size_of_the_picture_is_refused() {
    let folder = folder(STUDY);
    let path = folder.path();
    assert_success(&run(path, &["--quick"]));
    replace(&path.join("study.yaml"), "--width=12", "--width=13");
    assert_refused(
        path,
        &["--quick"],
        "`out/runs.jsonl` were made with other flags",
    );
    // The small matrix has flags of its own.
    replace(&path.join("study.yaml"), "--width=13", "--width=12");
    let study = path.join("study.yaml");
    let text = fs::read_to_string(&study).unwrap();
    fs::write(&study, format!("{text}quick: {{ flags: [--width=6] }}\n")).unwrap();
    assert_refused(path, &["--quick"], "were made with other flags");
    // More levels and more rounds go on.
    fs::write(
        &study,
        text.replace("[4, 8]", "[4, 8, 16]")
            .replace("repeats: 3", "repeats: 4"),
    )
    .unwrap();
    assert_success(&run(path, &[]));
    assert_eq!(lines(path).len(), 1 + 6 * 5);
}

#[test]
fn a_changed_scene_is_refused() {
    let folder = folder(STUDY);
    let path = folder.path();
    let scene = path.join("scene.yaml");
    let whole = fs::read_to_string(&scene).unwrap();
    assert_success(&run(path, &["--quick"]));
    fs::write(&scene, format!("{whole}\n# changed\n")).unwrap();
    let expected = "another content of the scene `scene` or of a file that it names";
    assert_refused(path, &["--quick"], expected);
    fs::write(&scene, whole).unwrap();
    assert_success(&run(path, &["--quick"]));
    replace(
        &path.join("study.yaml"),
        "scenes: [",
        "scenes: [other.yaml, ",
    );
    fs::copy(&scene, path.join("other.yaml")).unwrap();
    assert_refused(path, &["--quick"], "other scenes, without `other`");
}

/// An included file, a mesh and a picture.
#[test]
fn a_changed_file_of_a_scene_is_refused() {
    let folder = folder(&STUDY.replace("repeats: 3", "repeats: 1"));
    let path = folder.path();
    for (from, to) in [
        ("configs/studies/tiles.yaml", "unused.yaml"),
        ("tests/files/tile.obj", "tile.obj"),
        ("configs/pictures/planks.png", "planks.png"),
    ] {
        fs::copy(in_repository(from), path.join(to)).unwrap();
    }
    let part = "lights: [{ point: { position: [5, 5, 5] } }]\n";
    fs::write(path.join("part.yaml"), part).unwrap();
    let scene = "
include: [part.yaml]
image: { width: 8, height: 6 }
camera: { look_at: { eye: [0, 1, 5], target: [0, 0, 0], fov_y_deg: 40 } }
materials: { red: { color: { image: { file: planks.png, mapping: planar } } } }
objects:
  - { sphere: { center: [0, 0, 0], radius: 1 }, material: red }
  - { mesh: { file: tile.obj }, material: red }
";
    fs::write(path.join("scene.yaml"), scene).unwrap();
    assert_success(&run(path, &[]));
    for file in ["part.yaml", "tile.obj", "planks.png"] {
        let kept = fs::read(path.join(file)).unwrap();
        let more: &[u8] = if file.ends_with(".png") {
            b"\n"
        } else {
            b"\n# more\n"
        };
        fs::write(path.join(file), [&kept, more].concat()).unwrap();
        assert_refused(path, &[], "another content of the scene `scene`");
        fs::write(path.join(file), kept).unwrap();
    }
    fs::write(path.join("unused.yaml"), "# not of the scene").unwrap();
    assert_success(&run(path, &[]));
}

#[test]
fn runs_of_another_program_or_number_of_threads_are_refused() {
    let folder = folder(STUDY);
    let path = folder.path();
    assert_success(&run(path, &["--quick"]));
    let log = path.join("out/runs.jsonl");
    let kept = fs::read_to_string(&log).unwrap();
    let header = &lines(path)[0]["made_by"];
    for (key, expected) in [
        ("program", "another program"),
        ("n_threads", "another number of threads"),
        ("build", "another build"),
    ] {
        let old = format!("\"{key}\":{}", header[key]);
        assert!(kept.contains(&old), "{kept}");
        fs::write(&log, kept.replace(&old, &format!("\"{key}\":0"))).unwrap();
        assert_refused(path, &["--quick"], expected);
    }
}

/// They would show fewer runs than there are.
#[test]
fn plots_that_the_study_no_longer_has_are_removed() {
    let folder = folder(STUDY);
    let path = folder.path();
    assert_success(&run(path, &["--quick"]));
    let plot = path.join("out/plot-1-render_wall_ms-over-tile_size.svg");
    assert!(plot.exists());
    replace(&path.join("study.yaml"), "y: render_wall_ms", "y: rays");
    assert_success(&run(path, &["--quick"]));
    assert!(!plot.exists());
    assert!(path.join("out/plot-1-rays-over-tile_size.svg").exists());
}

/// By folders, as far as needed.
#[test]
fn scenes_of_one_name_are_told_apart() {
    let scenes = "[a/scene.yaml, a/b/scene.yaml, scene.yaml, one.yaml]";
    let study = STUDY
        .replace("[scene.yaml]", scenes)
        .replace("repeats: 3", "repeats: 1");
    let folder = folder(&study);
    let path = folder.path();
    fs::create_dir_all(path.join("a/b")).unwrap();
    for copy in ["a/scene.yaml", "a/b/scene.yaml", "one.yaml"] {
        fs::copy(path.join("scene.yaml"), path.join(copy)).unwrap();
    }
    assert_success(&run(path, &[]));
    let lines = lines(path);
    assert_eq!(lines.len(), 1 + 4 * 4 * 2);
    let names = lines[1..]
        .iter()
        .map(|run| run["point"]["scene"].as_str().unwrap());
    let mut names: Vec<&str> = names.collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names, ["a/scene", "b/scene", "one", "scene"]);
}
