//! `raycost check` says what memory and disk a rendering will take.

use std::path::Path;
use std::process::Output;

use serde_json::Value;

use crate::common::{assert_success, in_repository, raycost};

/// The greatest error of an estimate; a picture that is plain but for a few lines has more.
const ERROR: f64 = 0.25;
const ERROR_OF_PICTURES: f64 = 0.3;

/// The program without a scene: typically, and at most.
const PROGRAM: [f64; 2] = [13e6, 32e6];

/// Runs a command on a scene of `configs/`.
fn run(command: &str, scene: &str, flags: &[&str], out: &Path) -> Output {
    let mut raycost = raycost();
    raycost
        .arg(command)
        .arg(in_repository(&format!("configs/{scene}.yaml")));
    let output = raycost.args(flags).arg("--out").arg(out).output().unwrap();
    assert_success(&output);
    output
}

/// Checks and renders a scene, and compares the files, the pictures, and a peak of memory that the
/// scene dominates. Returns the peak in bytes.
fn assert_predicted(scene: &str, flags: &[&str]) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    let text = run(
        "check",
        scene,
        &[flags, &["--json"]].concat(),
        folder.path(),
    )
    .stdout;
    let check: Value = serde_json::from_slice(&text).unwrap();
    let flags = [flags, &["--quiet"]].concat();
    run("render", scene, &flags, folder.path());
    let text = std::fs::read(folder.path().join("summary.json")).unwrap();
    let summary: Value = serde_json::from_slice(&text).unwrap();
    let number = |value: &Value| value.as_f64().unwrap();
    let sum = |list: &Value, is_counted: fn(&str) -> bool| -> f64 {
        let files = list.as_array().unwrap().iter();
        let counted = files.filter(|file| is_counted(file["file"].as_str().unwrap()));
        counted.map(|file| number(&file["bytes"])).sum()
    };
    let (memory, disk) = (&check["memory"], &check["disk"]);
    let files = sum(&disk["arrays"], |_| true) + number(&disk["texts"]);
    let peak = number(&summary["peak_memory_bytes"]);
    let within = number(&memory["at_most"]) / (1.0 + ERROR);
    let ratios = [
        files / sum(&summary["files"], |name| !name.ends_with(".png")),
        number(&disk["pictures"]) / sum(&summary["files"], |name| name.ends_with(".png")),
        number(&memory["peak"]) / peak,
        (within + PROGRAM[0]) / peak,
    ];
    println!("{scene} {flags:?}: files, pictures, peak, estimate {ratios:.3?} of {peak:.2e}");
    let n_compared = if peak > 1.2e8 { 4 } else { 2 };
    let most = [ERROR, ERROR_OF_PICTURES, ERROR, ERROR];
    for (ratio, most) in ratios.iter().zip(most).take(n_compared) {
        assert!((ratio - 1.0).abs() < most, "{scene} {flags:?}: {ratios:?}");
    }
    let at_most = number(&memory["at_most"]) + PROGRAM[1];
    assert!(peak < at_most, "{scene} {flags:?}: {peak} < {at_most}");
    peak
}

/// The memory is that of this build on this system; a debug build takes as much.
#[test]
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn memory_and_disk_are_estimated_within_a_quarter() {
    let few = "--set=output.arrays=[object, distance]";
    let map = "--set=metrics={ tests_per_visit: primitive_tests / node_visits }";
    for (scene, flags) in [
        // The film.
        (
            "seed_extended",
            &["--width=3000", "--height=2000", "--cost=none", few][..],
        ),
        // Its counters, too.
        (
            "seed_extended",
            &["--width=3000", "--height=1600", "--cost=counters", few],
        ),
        // Its times, with a map of counters: a map of times compresses worse beside other programs.
        (
            "seed_sphere",
            &["--width=2400", "--height=1600", "--repeats=2", few, map],
        ),
        // The hierarchy.
        ("million_spheres", &["--spp=1", "--cost=counters"]),
        // A film as large as the build.
        (
            "million_spheres",
            &[
                "--width=1800",
                "--height=1400",
                "--spp=1",
                "--cost=counters",
            ],
        ),
        // The costs of primitives and nodes.
        (
            "million_spheres",
            &["--spp=1", "--cost=counters", "--also=surface,bvh"],
        ),
        // Ellipsoids.
        (
            "million_spheres",
            &[
                "--spp=1",
                "--cost=counters",
                "--set=objects[0].transform=[{ scale: [1, 2, 1] }]",
            ],
        ),
        // A small picture, whose disk is known.
        ("spot", &["--width=301", "--height=199"]),
        // Compressed files, more rows than are rendered to know them, and all rows.
        ("spot", &["--compress=lz4", "--cost=counters"]),
        ("textures", &["--compress=zlib", "--cost=none"]),
        ("seed_extended", &["--compress=zlib", "--repeats=1"]),
    ] {
        assert_predicted(scene, flags);
    }
}

/// Bands of rows.
#[test]
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn a_picture_larger_than_memory_is_predicted_as_well() {
    let flags = [
        "--width=3000",
        "--height=2400",
        "--memory=200M",
        "--cost=counters",
        "--set=output.arrays=[object, distance, RGB]",
    ];
    assert!(assert_predicted("seed_sphere", &flags) < 2e8);
}

#[test]
fn what_is_not_known_is_stated_before_compression() {
    let folder = tempfile::tempdir().unwrap();
    let flags = [
        "--width=60",
        "--height=40",
        "--compress=lz4",
        "--also=exr,surface",
    ];
    let text = run("check", "seed_extended", &flags, folder.path()).stdout;
    let text = String::from_utf8(text).unwrap();
    let disk = text.lines().find(|line| line.starts_with("disk")).unwrap();
    let (known, unknown) = disk.split_once("; before compression ").unwrap();
    assert!(known.starts_with("disk    about "), "{disk}");
    assert!(known.contains(" compressed by LZ4), and "), "{disk}");
    let names = ["surface.vtu ", "image.exr "];
    assert!(names.iter().all(|name| unknown.contains(name)), "{disk}");
}
