//! `raycost check` checks studies and their scenes without a run.

use std::fs;

use super::{STUDY, assert_success, folder, raycost, stderr_of};

/// Runs `raycost check` with these arguments in a folder.
fn check(folder: &tempfile::TempDir, arguments: &[&str]) -> std::process::Output {
    let mut command = raycost();
    let command = command.current_dir(folder.path()).arg("check");
    command.args(arguments).output().unwrap()
}

#[test]
fn a_study_is_checked_with_its_scenes() {
    let quick = "quick: { vary: { tile_size: [4] }, repeats: 1 }";
    let folder = folder(&format!("{STUDY}\n{quick}"));
    let output = check(&folder, &["study.yaml"]);
    assert_success(&output);
    let expected = "\
study   study.yaml is fine: A small study
scenes  scene
points  4: 1 scene, 2 of tile_size, 2 of max_depth
runs    16: 1 warm-up run and 3 measured runs of each point; 2 with `raycost study --quick`
plots   3
files   in out/studies/study
";
    assert_eq!(String::from_utf8_lossy(&output.stdout), expected);
    assert!(!folder.path().join("out").exists());

    let refused = |study: &str, expected: &str| {
        fs::write(folder.path().join("study.yaml"), study).unwrap();
        let output = check(&folder, &["study.yaml"]);
        let message = stderr_of(&output);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(expected), "{message}");
    };
    refused(
        &STUDY.replace("y: render_cpu_ms", "y: cpu"),
        "--> study.yaml:10:",
    );
    refused(
        &STUDY.replace("repeats: 3", "repeat: 3"),
        "did you mean `repeats`?",
    );
    let mistaken = "quick: { vary: { max_deep: [1] } }";
    refused(&format!("{STUDY}\n{mistaken}"), "did you mean `max_depth`?");
    let scene = folder.path().join("scene.yaml");
    let broken = fs::read_to_string(&scene)
        .unwrap()
        .replace("radius:", "radios:");
    fs::write(&scene, broken).unwrap();
    refused(STUDY, "--> ./scene.yaml:");
}

#[test]
fn flags_of_a_scene_are_refused_with_a_study() {
    let folder = folder(STUDY);
    for flag in ["--width=3", "--set=image.seed=1", "--out=there"] {
        let output = check(&folder, &["study.yaml", flag]);
        assert_eq!(output.status.code(), Some(2));
        let message = stderr_of(&output);
        assert!(message.contains("do not change a study"), "{message}");
    }
}

/// All of them, whatever is wrong with the first.
#[test]
fn several_files_are_checked_in_one_call() {
    let folder = folder(STUDY);
    let output = check(&folder, &["scene.yaml", "study.yaml"]);
    assert_success(&output);
    let report = String::from_utf8(output.stdout).unwrap();
    assert!(report.contains("scene.yaml is fine") && report.contains("study.yaml is fine"));

    fs::write(folder.path().join("bad.yaml"), "image: {}\n").unwrap();
    let output = check(&folder, &["bad.yaml", "scene.yaml", "none.yaml"]);
    assert_eq!(output.status.code(), Some(2));
    let report = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(report.contains("scene.yaml is fine"), "{report}");
    let message = stderr_of(&output);
    let told = ["--> bad.yaml", "cannot read the scene `none.yaml`"];
    assert!(told.iter().all(|told| message.contains(told)), "{message}");
}
