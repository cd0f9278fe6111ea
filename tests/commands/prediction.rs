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

/// The bytes that a line of `raycost check` states behind some words.
fn stated(text: &str, line: &str, words: &str) -> f64 {
    let line = text.lines().find(|found| found.starts_with(line)).unwrap();
    let (_, rest) = line.split_once(words).unwrap();
    let words: Vec<&str> = rest.trim_start().split([' ', ';']).collect();
    let unit = match words[1] {
        "kB" => 1e3,
        "MB" => 1e6,
        "GB" => 1e9,
        other => panic!("{other}: {line}"),
    };
    words[0].parse::<f64>().unwrap() * unit
}

/// What a rendering took.
struct Taken {
    /// The peak of memory.
    memory: f64,
    /// The bytes of the files but the pictures, and of the PNGs.
    files: f64,
    pictures: f64,
}

impl Taken {
    fn of(out: &Path) -> Self {
        let text = std::fs::read(out.join("summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_slice(&text).unwrap();
        let bytes = |is_counted: fn(&str) -> bool| -> f64 {
            let files = summary["files"].as_array().unwrap().iter();
            let counted = files.filter(|file| is_counted(file["file"].as_str().unwrap()));
            counted.map(|file| file["bytes"].as_f64().unwrap()).sum()
        };
        Self {
            memory: summary["peak_memory_bytes"].as_f64().unwrap(),
            files: bytes(|name| !name.ends_with(".png") && !name.ends_with(".exr")),
            pictures: bytes(|name| name.ends_with(".png")),
        }
    }
}

/// Checks and renders a scene; what was predicted of the memory, the files and the pictures, as
/// parts of what was taken, and what was taken.
fn predicted(scene: &str, flags: &[&str]) -> ([f64; 3], Taken) {
    let folder = tempfile::tempdir().unwrap();
    let text = run("check", scene, flags, folder.path()).stdout;
    let text = String::from_utf8(text).unwrap();
    run(
        "render",
        scene,
        &[flags, &["--quiet"]].concat(),
        folder.path(),
    );
    let taken = Taken::of(folder.path());
    let ratios = [
        stated(&text, "memory", "about") / taken.memory,
        stated(&text, "disk", "about") / taken.files,
        stated(&text, "disk", ", and") / taken.pictures,
    ];
    println!("{scene} {flags:?}: memory, files, pictures {ratios:.3?}");
    (ratios, taken)
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
        let ([memory, files, _], taken) = predicted(scene, flags);
        assert!(
            taken.memory < 2e8 || (memory - 1.0).abs() < 0.1,
            "{scene}: {memory}"
        );
        // Numbers have three digits.
        assert!((files - 1.0).abs() < 0.015, "{scene}: {files}");
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
    let ([memory, files, _], taken) = predicted("seed_sphere", &flags);
    assert!(taken.memory < 2.1e8);
    assert!((memory - 1.0).abs() < 0.15, "{memory}");
    assert!((files - 1.0).abs() < 0.02, "{files}");
}

/// About 10 %, as the docs say, and more where scenes have details in few places.
#[test]
fn compressed_files_and_pictures_are_predicted_by_some_rows() {
    for (scene, flags) in [
        // More rows than are rendered to know it.
        ("spot", &["--compress=lz4", "--cost=counters"][..]),
        ("textures", &["--compress=zlib", "--cost=none"]),
        // All rows.
        ("seed_extended", &["--compress=zlib", "--repeats=1"]),
    ] {
        let ([_, files, pictures], _) = predicted(scene, flags);
        assert!((files - 1.0).abs() < 0.15, "{scene}: {files}");
        assert!((pictures - 1.0).abs() < 0.2, "{scene}: {pictures}");
    }
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
