//! Rooflines: runs are compared with limits that are measured once, and foreign limits stay
//! unchanged. All tests but one use given limits instead of measured ones.

use std::fs;
use std::path::Path;
use std::process::Output;

use crate::common::{assert_success, in_repository, raycost};
use serde_json::{Value, json};

const STUDY: &str = "
title: A small roofline
scenes: [scene.yaml]
vary: { cost: [single_ray_time, counters] }
flags: [--width=12, --height=9]
repeats: 2
";

/// A temporary folder with the scene.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let scene = in_repository("configs/hall_of_mirrors.yaml");
    fs::copy(scene, folder.path().join("scene.yaml")).unwrap();
    folder
}

/// Runs the study with or without a roofline.
fn run(folder: &Path, roofline: bool) -> Output {
    let study = format!("{STUDY}roofline: {roofline}\n");
    fs::write(folder.join("study.yaml"), study).unwrap();
    let mut command = raycost();
    command.current_dir(folder).args(["study", "study.yaml"]);
    command.args(["--out", "out"]).output().unwrap()
}

fn text(folder: &Path, file: &str) -> String {
    fs::read_to_string(folder.join("out").join(file)).unwrap()
}

fn value(folder: &Path, file: &str) -> Value {
    serde_json::from_str(&text(folder, file)).unwrap()
}

/// Writes limits with three memory levels and the provenance of the runs.
fn write_limits(folder: &Path, instructions_per_second: Option<f64>) {
    let header: Value =
        serde_json::from_str(text(folder, "runs.jsonl").lines().next().unwrap()).unwrap();
    let block = |power: i32| {
        json!({
            "bytes": 2_f64.powi(14 + power),
            "latency_ns": 2_f64.powi(power / 2),
            "bandwidth_alone": 256.0 / 2_f64.powi(power / 2),
            "bandwidth_shared": 200.0 / 2_f64.powi(power / 2),
        })
    };
    let limits = json!({
        "raycost_limits": 1,
        "made_by": header["made_by"],
        "limits": {
            "caches": [{ "name": "L1", "bytes": 1 << 15 }, { "name": "L2", "bytes": 1 << 20 }],
            "n_threads": 2,
            "blocks": (0..10).map(block).collect::<Vec<_>>(),
            "instructions_per_second": instructions_per_second,
        },
    });
    fs::write(folder.join("out/limits.json"), limits.to_string()).unwrap();
}

/// Replaces a metric of each run: measured times may all be 0 on a coarse clock.
fn write_metric(folder: &Path, name: &str, value: f64) {
    let lines = text(folder, "runs.jsonl");
    let mut lines = lines
        .lines()
        .map(|line| serde_json::from_str(line).unwrap());
    let header: Value = lines.next().unwrap();
    let with_metric = |mut run: Value| {
        run["metrics"][name] = value.into();
        run
    };
    let lines = std::iter::once(header).chain(lines.map(with_metric));
    let lines: Vec<String> = lines.map(|line| line.to_string()).collect();
    fs::write(folder.join("out/runs.jsonl"), lines.join("\n") + "\n").unwrap();
}

#[test]
fn limits_are_measured_once_and_only_on_request() {
    let folder = folder();
    assert_success(&run(folder.path(), false));
    assert!(!folder.path().join("out/limits.json").exists());
    let runs = text(folder.path(), "runs.jsonl");
    assert_success(&run(folder.path(), true));
    let limits = text(folder.path(), "limits.json");
    let blocks = value(folder.path(), "limits.json")["limits"]["blocks"].clone();
    let blocks = blocks.as_array().unwrap();
    for (number, block) in blocks.iter().enumerate() {
        assert_eq!(block["bytes"], 16384.0 * 2_f64.powi(number as i32));
        for name in ["latency_ns", "bandwidth_alone", "bandwidth_shared"] {
            assert!(block[name].as_f64().unwrap() > 0.0, "{block}");
        }
    }
    assert_success(&run(folder.path(), true));
    assert_eq!(text(folder.path(), "limits.json"), limits);
    assert_eq!(
        text(folder.path(), "runs.jsonl"),
        runs,
        "no run is repeated"
    );
}

#[test]
fn without_instructions_the_plot_shows_rays_over_bytes() {
    let folder = folder();
    assert_success(&run(folder.path(), false));
    let runs = text(folder.path(), "runs.jsonl");
    write_metric(folder.path(), "render_ns_per_ray", 500.0);
    write_limits(folder.path(), None);
    let output = run(folder.path(), true);
    assert_success(&output);
    let report = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(report.contains("bound   2 points are limited:"), "{report}");
    let svg = text(folder.path(), "roofline.svg");
    for shown in [
        "bytes of the hierarchy per ray",
        "rays per second",
        "L1 ",
        "L2 ",
        "DRAM ",
    ] {
        assert!(svg.contains(shown), "{shown}\n{svg}");
    }
    let png = image::open(folder.path().join("out/roofline.png")).unwrap();
    let n_drawn = png
        .to_rgb8()
        .pixels()
        .filter(|pixel| pixel.0 != [255; 3])
        .count();
    assert!(n_drawn > 1000, "{n_drawn} pixels are not white");
    // Costs per ray follow from the counters and the BVH.
    for run in runs.lines().skip(1) {
        let run: Value = serde_json::from_str(run).unwrap();
        let metric = |name: &str| run["metrics"][name].as_f64().unwrap();
        let of_nodes = 256.0 * metric("node_visits");
        let of_leaves = metric("bvh_bytes_per_test") * metric("primitive_tests");
        let bytes = metric("bytes_per_ray") * metric("rays");
        assert!((bytes / (of_nodes + of_leaves) - 1.0).abs() < 1e-9);
        let ns = metric("render_ns_per_ray") * metric("rays");
        assert!((ns - 1e6 * metric("render_cpu_ms")).abs() <= 1e-9 * ns);
        assert!(metric("fetches_per_ray") > metric("node_visits_per_ray"));
        let in_flight = if run["point"]["cost"] == "single_ray_time" {
            1.0
        } else {
            32.0
        };
        assert_eq!(metric("rays_in_flight"), in_flight);
    }
}

#[test]
fn with_instructions_the_plot_is_a_roofline() {
    let folder = folder();
    assert_success(&run(folder.path(), false));
    write_limits(folder.path(), Some(1e10));
    write_metric(folder.path(), "instructions_per_ray", 700.0);
    write_metric(folder.path(), "render_ns_per_ray", 500.0);
    let output = run(folder.path(), true);
    assert_success(&output);
    let report = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(report.contains("its 700 instructions"), "{report}");
    let svg = text(folder.path(), "roofline.svg");
    for shown in ["instructions per byte", "10 G instructions/s", "DRAM "] {
        assert!(svg.contains(shown), "{shown}\n{svg}");
    }
    for point in value(folder.path(), "statistics.json")["roofline"]
        .as_array()
        .unwrap()
    {
        let ns = point["render_ns_per_ray"]["median"].as_f64().unwrap();
        let share = point["instruction_share"].as_f64().unwrap();
        assert!((share - 700.0 / 10.0 / ns).abs() < 1e-9, "{point}");
    }
}

#[test]
fn foreign_limits_stay_unchanged() {
    let folder = folder();
    assert_success(&run(folder.path(), false));
    let file = folder.path().join("out/limits.json");
    fs::remove_file(folder.path().join("out/statistics.csv")).unwrap();
    for (held, expected) in [
        ("the notes of somebody", "holds no limits"),
        ("{\"raycost_limits\":1,\"made_by\":{}}", "holds no limits"),
        (
            "{\"raycost_limits\":9,\"made_by\":{},\"limits\":{\"caches\":[],\"n_threads\":1,\"blocks\":[]}}",
            "has format 9",
        ),
        (
            "{\"raycost_limits\":1,\"made_by\":{},\"limits\":{\"caches\":[],\"n_threads\":1,\"blocks\":[]}}",
            "measured with another machine",
        ),
    ] {
        fs::write(&file, held).unwrap();
        let refused = run(folder.path(), true);
        let message = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(2), "{message}");
        assert!(message.contains(expected), "{message}");
        assert_eq!(fs::read_to_string(&file).unwrap(), held);
        assert!(!folder.path().join("out/statistics.csv").exists());
    }
}
