//! `raycost check` says what memory and disk a rendering will take.

use std::path::Path;
use std::process::Output;

use crate::common::{assert_success, in_repository, raycost};

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

/// The bytes that a line of `raycost check` states behind the word "about".
fn about(text: &str, line: &str) -> f64 {
    let line = text.lines().find(|found| found.starts_with(line)).unwrap();
    let (_, rest) = line.split_once("about ").unwrap();
    let words: Vec<&str> = rest.split([' ', ';']).collect();
    let unit = match words[1] {
        "kB" => 1e3,
        "MB" => 1e6,
        "GB" => 1e9,
        other => panic!("{other}: {line}"),
    };
    words[0].parse::<f64>().unwrap() * unit
}

/// The peak memory of a rendering, and the bytes of its files but the pictures.
fn taken(out: &Path) -> [f64; 2] {
    let text = std::fs::read(out.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_slice(&text).unwrap();
    let files = summary["files"].as_array().unwrap();
    let is_raw = |name: &str| !name.ends_with(".png") && !name.ends_with(".exr");
    let raw = files
        .iter()
        .filter(|file| is_raw(file["file"].as_str().unwrap()));
    let bytes: f64 = raw.map(|file| file["bytes"].as_f64().unwrap()).sum();
    [summary["peak_memory_bytes"].as_f64().unwrap(), bytes]
}

/// The memory is that of this build on this system; a debug build takes as much.
#[test]
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn memory_is_predicted_within_ten_percent_and_disk_within_one() {
    let few = "--set=output.arrays=[object, distance]";
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
        // Its times.
        (
            "seed_sphere",
            &["--width=2400", "--height=1600", "--repeats=2", few],
        ),
        // The hierarchy.
        ("million_spheres", &["--spp=1", "--cost=counters"]),
        // The costs of primitives and nodes.
        (
            "million_spheres",
            &["--spp=1", "--cost=counters", "--also=surface,bvh"],
        ),
        // A small picture, whose disk is known.
        ("spot", &["--width=301", "--height=199"]),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let text = run("check", scene, flags, folder.path()).stdout;
        let text = String::from_utf8(text).unwrap();
        let flags = [flags, &["--quiet"]].concat();
        run("render", scene, &flags, folder.path());
        let [memory, disk] = taken(folder.path());
        let [of_memory, of_disk] = [about(&text, "memory") / memory, about(&text, "disk") / disk];
        println!("{scene} {flags:?}: memory {of_memory:.3}, disk {of_disk:.3}");
        assert!(
            memory < 2e8 || (of_memory - 1.0).abs() < 0.1,
            "{scene}: {of_memory}"
        );
        // Numbers have three digits.
        assert!((of_disk - 1.0).abs() < 0.015, "{scene}: {of_disk}");
    }
}

#[test]
fn what_is_compressed_is_stated_before_compression() {
    let folder = tempfile::tempdir().unwrap();
    let flags = ["--width=60", "--height=40", "--compress=lz4", "--also=exr"];
    let text = run("check", "seed_extended", &flags, folder.path()).stdout;
    let text = String::from_utf8(text).unwrap();
    let disk = text.lines().find(|line| line.starts_with("disk")).unwrap();
    assert!(disk.starts_with("disk    up to "), "{disk}");
    assert!(
        disk.contains(") before compression by LZ4, and up to "),
        "{disk}"
    );
    assert!(disk.ends_with(" of pictures before compression"), "{disk}");
}
