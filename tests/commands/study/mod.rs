//! Studies run each point once a round, and continue after an interruption.

mod changed;
mod checked;
mod metrics;
mod refused;
mod several;
mod statistics;
mod steps;
#[cfg(target_os = "linux")]
mod stopped;

use std::fs;
use std::path::Path;
use std::process::Output;

use crate::common::{assert_success, in_repository, raycost};
use serde_json::Value;

const STUDY: &str = "
title: A small study
scenes: [scene.yaml]
vary: { tile_size: [4, 8], max_depth: [0, 3] }
flags: [--width=12, --height=9]
repeats: 3
plots:
  - { x: tile_size, y: render_wall_ms, fit: true }
  - { x: n_pixels, y: [rays, node_visits], scale: linear }
  - { x: scene, y: render_cpu_ms }
";

/// A temporary folder with a study and its scene.
fn folder(study: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("study.yaml"), study).unwrap();
    let scene = in_repository("configs/hall_of_mirrors.yaml");
    fs::copy(scene, folder.path().join("scene.yaml")).unwrap();
    folder
}

/// Runs the study of a folder.
fn run(folder: &Path, flags: &[&str]) -> Output {
    let mut command = raycost();
    command.current_dir(folder).args(["study", "study.yaml"]);
    command.args(["--out", "out"]).args(flags).output().unwrap()
}

/// The lines of the log of runs, the header first.
fn lines(folder: &Path) -> Vec<Value> {
    let text = fs::read_to_string(folder.join("out/runs.jsonl")).unwrap();
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

/// The error messages of a command.
fn stderr_of(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A law over the image size grows with the number of pixels; node visits are in proportion to them.
#[test]
fn a_law_over_image_sizes_is_one_of_pixels() {
    let study = "
title: Sizes
scenes: [scene.yaml]
vary: { image_size: [[16, 12], 32x24, 40] }
flags: [--cost=counters]
repeats: 1
plots: [{ x: image_size, y: rays, fit: true }]
";
    let folder = folder(study);
    let output = run(folder.path(), &[]);
    assert_success(&output);
    let text = fs::read_to_string(folder.path().join("out/statistics.json")).unwrap();
    let statistics: Value = serde_json::from_str(&text).unwrap();
    let exponent = statistics["fits"][0]["law"]["exponent"].as_f64().unwrap();
    assert!((0.9..1.1).contains(&exponent), "{exponent}");
    let shown = String::from_utf8(output.stdout).unwrap();
    let law = shown
        .lines()
        .find(|line| line.starts_with("law     rays = "));
    let law = law.unwrap_or_else(|| panic!("{shown}"));
    assert!(
        law.contains(&format!("x^{exponent:.3}")) && law.ends_with("x: image size (pixels)"),
        "{law}"
    );
    let runs = lines(folder.path());
    let sizes: Vec<&str> = (runs[1..].iter())
        .filter_map(|run| run["point"]["image_size"].as_str())
        .collect();
    assert!(
        ["16x12", "32x24", "40x40"]
            .iter()
            .all(|size| sizes.contains(size)),
        "{sizes:?}"
    );
}

#[test]
fn any_value_of_the_scene_is_a_factor() {
    let vary = "{ camera.look_at.fov_y_deg: [20, 40], 'objects[1].plane.normal': [[0, 1, 0]] }";
    let study = STUDY.replace("{ tile_size: [4, 8], max_depth: [0, 3] }", vary);
    let folder = folder(&study.replace("x: tile_size", "x: camera.look_at.fov_y_deg"));
    assert_success(&run(folder.path(), &["--quick"]));
    let points: Vec<Value> = lines(folder.path())[1..]
        .iter()
        .map(|run| run["point"].clone())
        .collect();
    for fov in [20, 40] {
        let point = serde_json::json!({
            "scene": "scene",
            "camera.look_at.fov_y_deg": fov,
            "objects[1].plane.normal": [0, 1, 0],
        });
        assert!(points.contains(&point), "{points:?}");
    }
    let table = fs::read_to_string(folder.path().join("out/statistics.csv")).unwrap();
    assert!(table.starts_with("scene,camera.look_at.fov_y_deg,objects[1].plane.normal,metric"));
    let plot = "out/plot-1-render_wall_ms-over-camera.look_at.fov_y_deg.svg";
    assert!(folder.path().join(plot).exists());
}

#[test]
fn every_point_is_measured_in_every_round() {
    let folder = folder(STUDY);
    assert_success(&run(folder.path(), &[]));
    let lines = lines(folder.path());
    assert_eq!(lines.len(), 1 + 4 * (1 + 3));
    for round in lines[1..].chunks(4) {
        let mut points: Vec<String> = round.iter().map(|run| run["point"].to_string()).collect();
        points.sort();
        points.dedup();
        assert_eq!(points.len(), 4);
        assert!(round.iter().all(|run| run["round"] == round[0]["round"]));
    }
    // Each run has the levels of its point.
    for run in &lines[1..] {
        let [depth, mirrored] = [
            &run["point"]["max_depth"],
            &run["metrics"]["reflection_rays"],
        ];
        assert_eq!(depth == 0, *mirrored == 0.0, "{run}");
        assert_eq!(run["metrics"]["n_pixels"], 108.0);
    }
    let shuffled = |round: usize| {
        lines[1 + 4 * round..]
            .iter()
            .take(4)
            .map(|run| &run["point"])
    };
    assert!(
        (1..4).any(|round| !shuffled(0).eq(shuffled(round))),
        "the order differs between rounds"
    );
}

#[test]
fn an_interrupted_study_continues() {
    let folder = folder(STUDY);
    assert_success(&run(folder.path(), &[]));
    let file = folder.path().join("out/runs.jsonl");
    let whole = fs::read_to_string(&file).unwrap();
    // Interrupted in the middle of the tenth run's line.
    let end: usize = whole.split_inclusive('\n').take(10).map(str::len).sum();
    fs::write(&file, &whole[..end + 30]).unwrap();
    assert_success(&run(folder.path(), &[]));
    let after = fs::read_to_string(&file).unwrap();
    assert_eq!(after[..end], whole[..end], "no run is measured again");
    assert_eq!(lines(folder.path()).len(), 17);
}

#[test]
fn the_time_budget_leaves_runs_for_the_next_command() {
    let folder = folder(&format!("{STUDY}\ntime_budget_s: 1e-12"));
    let first = run(folder.path(), &[]);
    assert_success(&first);
    assert_eq!(lines(folder.path()).len(), 1);
    let report = String::from_utf8_lossy(&first.stdout).into_owned();
    assert!(report.contains("left    16 runs"), "{report}");
}

/// The check of both points before the first run takes many times the memory of that run.
#[test]
#[cfg(any(target_os = "linux", target_os = "macos"))]
fn the_peak_memory_of_a_run_is_its_own() {
    let study = "
title: Little memory after much
scenes: [scene.yaml]
vary: { objects: [10, 500000] }
flags: [--width=12, --height=9, --threads=1, --cost=counters]
repeats: 1
warm_up: 0
plots:
  - { x: objects, y: peak_memory_bytes }
";
    let folder = folder(study);
    let cloud = fs::read_to_string(in_repository("configs/sphere_cloud.yaml")).unwrap();
    fs::write(folder.path().join("scene.yaml"), &cloud).unwrap();
    assert_success(&run(folder.path(), &[]));
    let of_objects = |n: u64| {
        let lines = lines(folder.path());
        let run = lines[1..].iter().find(|run| run["point"]["objects"] == n);
        run.unwrap()["metrics"]["peak_memory_bytes"]
            .as_f64()
            .unwrap()
    };
    let in_study = of_objects(10);
    assert!(of_objects(500_000) > 3.0 * in_study);

    let few = cloud.replace("count: 10000", "count: 10");
    assert_ne!(few, cloud);
    fs::write(folder.path().join("few.yaml"), few).unwrap();
    let mut alone = raycost();
    alone
        .current_dir(folder.path())
        .args(["render", "few.yaml"]);
    alone.args(["--width=12", "--height=9", "--threads=1", "--cost=counters"]);
    assert_success(&alone.args(["--out", "alone"]).output().unwrap());
    let summary = fs::read(folder.path().join("alone/summary.json")).unwrap();
    let summary: Value = serde_json::from_slice(&summary).unwrap();
    let alone = summary["peak_memory_bytes"].as_f64().unwrap();
    assert!(
        (0.5..2.0).contains(&(in_study / alone)),
        "{in_study}, {alone}"
    );
}

#[test]
fn quick_replaces_what_the_study_says() {
    let quick = "quick: { vary: { tile_size: [4] }, flags: [--width=6, --height=5], repeats: 1 }";
    let folder = folder(&format!("{STUDY}\n{quick}"));
    assert_success(&run(folder.path(), &["--quick"]));
    let lines = lines(folder.path());
    assert_eq!(lines.len(), 1 + 2);
    assert_eq!(lines[1]["metrics"]["n_pixels"], 30.0);
}
