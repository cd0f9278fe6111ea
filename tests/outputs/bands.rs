//! Pictures that are larger than the memory that they may use.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;

use output::results::{LoadedArray, Results};

use super::parts::{Folder, squares};
use crate::common::data_set::{Array, DataSet};
use crate::common::same_output::summary;
use crate::common::{assert_success, names};

/// A picture of some 80 MB in memory.
const SIZE: [&str; 3] = ["--width=1024", "--height=900", "--spp=1"];
/// Enough for some of its rows.
const MEMORY: &str = "--memory=72M";

/// Whether an array differs from run to run.
fn is_timed(name: &str) -> bool {
    name.contains("time_") || name == "thread"
}

/// Checks that pieces have the pixels and the points of one file each.
fn assert_same_data(whole: &Path, bands: &Path) {
    let [one, other] = [whole, bands].map(|folder| Results::open(folder).unwrap());
    let check = |found: &LoadedArray, expected: &LoadedArray| {
        assert_eq!(found.name, expected.name);
        assert_eq!(found.values.len(), expected.values.len(), "{}", found.name);
        let is_same = found.values.bytes() == expected.values.bytes();
        assert!(
            is_same || is_timed(&found.name),
            "{}: {} differs",
            bands.display(),
            found.name
        );
    };
    let [frame, pieces] = [&one, &other].map(|results| results.frame().unwrap());
    assert_eq!(frame.arrays(), pieces.arrays());
    for array in frame.arrays().to_vec() {
        let [found, expected] = [&pieces, &frame].map(|file| file.read(&array.name).unwrap());
        check(&found, &expected);
        let (columns, rows) = ([0, 7, 1023], [0, 1, 31, 32, 500, 899]);
        let [found, expected] =
            [&pieces, &frame].map(|file| file.read_selected(&array.name, &columns, &rows).unwrap());
        check(&found, &expected);
    }
    let [hits, pieces] = [&one, &other].map(|results| results.hits().unwrap());
    assert_eq!(hits.arrays(), pieces.arrays());
    assert!(hits.read_points().unwrap() == pieces.read_points().unwrap());
    for array in hits.arrays().to_vec() {
        let [found, expected] = [&pieces, &hits].map(|file| file.read(&array.name).unwrap());
        check(&found, &expected);
    }
    let pixels = |folder: &Path| image::open(folder.join("image.png")).unwrap();
    assert!(pixels(whole) == pixels(bands));
    let [one, other] = [whole, bands].map(summary);
    let totals = |summary: &serde_json::Value| {
        let mut totals = summary["cost"]["totals"].clone();
        if let Some(totals) = totals.as_object_mut() {
            totals.retain(|name, _| !is_timed(name));
        }
        totals
    };
    assert_eq!(totals(&one), totals(&other));
    assert_eq!(one["n_hits"], other["n_hits"]);
}

/// The pieces in a folder.
fn n_pieces(folder: &Path) -> usize {
    let names = names(folder);
    let begins = |begin: &str| names.iter().filter(|name| name.starts_with(begin)).count();
    assert_eq!(begins("frame_"), begins("hits_"));
    begins("frame_")
}

impl Folder {
    /// Renders a scene within the limit, in pieces.
    fn render_in_bands(&self, scene: &str, flags: &[&str], out: &str) {
        self.render_within(72, scene, flags, out);
    }

    /// Renders a scene within so many MiB, in pieces.
    fn render_within(&self, most: u64, scene: &str, flags: &[&str], out: &str) {
        let (scene, memory) = (format!("configs/{scene}.yaml"), format!("--memory={most}M"));
        let command = ["render", &scene, "--quiet", "--out", out, &memory];
        assert_success(&self.run(&[&command, &SIZE[..], flags].concat()));
        let found = summary(&self.path(out));
        assert!(n_pieces(&self.path(out)) > 1);
        let peak = found["peak_memory_bytes"].as_u64().unwrap();
        assert!(peak < most << 20, "{peak} bytes");
        assert!(!self.path(out).join("unfinished.tiles").exists());
    }

    fn render_whole(&self, scene: &str, flags: &[&str], out: &str) {
        let scene = format!("configs/{scene}.yaml");
        let command = ["render", &scene, "--quiet", "--out", out];
        assert_success(&self.run(&[&command, &SIZE[..], flags].concat()));
        assert_eq!(n_pieces(&self.path(out)), 0);
    }

    /// The message of a command that is refused.
    fn message(&self, arguments: &[&str], code: i32) -> String {
        let output = self.run(arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{message}");
        message
    }
}

#[test]
fn pieces_have_the_pixels_of_a_whole_picture() {
    let folder = Folder::new();
    let variants: [(&str, &[&str]); 5] = [
        ("seed_sphere", &["--cost=counters"]),
        ("spot", &["--cost=counters", "--set=tiles.size=9"]),
        ("seed_extended", &["--cost=time", "--repeats=1"]),
        (
            "seed_sphere",
            &["--cost=single_ray_time", "--also=radiance"],
        ),
        ("seed_extended", &["--cost=counters", "--set=film.bits=16"]),
    ];
    for (i, (scene, flags)) in variants.into_iter().enumerate() {
        let [whole, bands] = ["whole", "bands"].map(|name| format!("{name}{i}"));
        folder.render_whole(scene, flags, &whole);
        folder.render_in_bands(scene, flags, &bands);
        assert_same_data(&folder.path(&whole), &folder.path(&bands));
    }
    // The same run, but for times, which have to be alike.
    let run = |out: &str| Results::open(&folder.path(out)).unwrap().summary.run;
    assert_eq!(run("whole0"), run("bands0"));
    assert_ne!(run("whole1"), run("bands0"));
}

/// A tile of a moved grid may be in two pieces.
#[test]
fn repeats_of_pieces_move_groups() {
    let folder = Folder::new();
    let cost = "--cost=time";
    folder.render_whole("seed_extended", &[cost, "--repeats=3"], "whole");
    for (repeats, has_squares) in [("--repeats=1", true), ("--repeats=3", false)] {
        let out = format!("bands{repeats}");
        folder.render_in_bands("seed_extended", &[cost, repeats], &out);
        let out = folder.path(&out);
        assert_eq!(squares(&out).is_some(), has_squares);
        if !has_squares {
            assert_same_data(&folder.path("whole"), &out);
        }
        // Each rendering has a sum.
        let summary = summary(&out);
        let shares = &summary["thread_time"];
        let [pixels, busy] = ["pixels_ns", "busy_ns"].map(|key| shares[key].as_f64().unwrap());
        assert!(pixels > 0.5 * busy, "{shares}");
    }
}

#[test]
fn hints_look_at_all_pieces() {
    let folder = Folder::new();
    let command = ["render", "configs/seed_sphere.yaml", "--out=out", MEMORY];
    for (flags, hint) in [
        (
            &["--set=lights=[]", "--set=shading.ambient=0"][..],
            Some("is black: nothing shines"),
        ),
        (&[], None),
    ] {
        let output = folder.run(&[&command, &SIZE[..], &["--cost=none"], flags].concat());
        assert_success(&output);
        let text = String::from_utf8(output.stdout).unwrap();
        assert_eq!(text.contains("hint "), hint.is_some(), "{text}");
        assert!(text.contains(hint.unwrap_or_default()), "{text}");
        assert!(n_pieces(&folder.path("out")) > 1);
    }
}

#[test]
fn the_output_in_pieces_is_read_by_all_commands() {
    let folder = Folder::new();
    folder.render_whole("seed_sphere", &["--cost=counters"], "whole");
    folder.render_in_bands("seed_sphere", &["--cost=counters"], "bands");
    for command in [
        &["view", "bands"][..],
        &["check", "bands"],
        &["diff", "whole", "bands", "--out", "difference"],
    ] {
        assert_success(&folder.run(command));
    }
    // The upper rows have tests of a plane and no node visits.
    let hottest = |out: &str, flags: &[&str]| {
        let scene = "configs/seed_extended.yaml";
        let command = ["render", scene, "--cost=counters", "--out", out];
        let output = folder.run(&[&command, &SIZE[..], flags].concat());
        let text = String::from_utf8(output.stdout).unwrap();
        let line = text.lines().find(|line| line.starts_with("hottest "));
        line.unwrap().to_owned()
    };
    assert_eq!(hottest("one", &[]), hottest("pieces", &[MEMORY]));
    let diff = Results::open(&folder.path("bands")).unwrap();
    assert_eq!(diff.frame_name(), "frame.pvti");
    let page = fs::read_to_string(folder.path("bands/view.html")).unwrap();
    assert!(page.contains("node_visits"));
    // A piece that is not as it was written.
    let piece = folder.path("bands/hits_1.vtu");
    let bytes = fs::read(&piece).unwrap();
    fs::write(&piece, &bytes[..bytes.len() - 5]).unwrap();
    let message = folder.message(&["view", "bands"], 2);
    assert!(message.contains("hits_1.vtu"), "{message}");
    fs::remove_file(&piece).unwrap();
    let message = folder.message(&["view", "bands"], 2);
    assert!(message.contains("hits_1.vtu"), "{message}");
}

#[test]
fn check_says_how_a_picture_will_be_written() {
    let folder = Folder::new();
    folder.render_in_bands("seed_sphere", &["--cost=counters"], "out");
    let arguments = [
        "check",
        "configs/seed_sphere.yaml",
        "--cost=counters",
        MEMORY,
    ];
    let output = folder.run(&[&arguments, &SIZE[..]].concat());
    let text = String::from_utf8(output.stdout).unwrap();
    // The memory of the program itself may differ by a piece.
    let n_pieces = n_pieces(&folder.path("out"));
    let said = |n: usize| text.contains(&format!("; image.png; {n} pieces of "));
    assert!(
        (n_pieces - 1..=n_pieces + 1).any(said),
        "{n_pieces}: {text}"
    );
    assert!(text.contains("; until the end "), "{text}");
    assert!(
        folder
            .message(&["check", "configs/seed_sphere.yaml", "--memory=1M"], 2)
            .contains("the program itself takes")
    );
}

#[test]
fn pieces_of_an_earlier_run_are_replaced_and_those_of_others_kept() {
    let folder = Folder::new();
    folder.render_in_bands("seed_sphere", &["--cost=counters"], "out");
    folder.render_whole("seed_sphere", &["--cost=counters"], "out");
    assert!(!folder.path("out/frame.pvti").exists());
    folder.render_in_bands("seed_sphere", &["--cost=counters"], "out");
    assert!(!folder.path("out/frame.vti").exists());
    fs::create_dir(folder.path("other")).unwrap();
    for name in ["other/frame_0.vti", "other/frame_00.vti"] {
        fs::write(folder.path(name), "of another program").unwrap();
    }
    let arguments = [
        "render",
        "configs/seed_sphere.yaml",
        "--out=other",
        MEMORY,
        "--cost=counters",
    ];
    let message = folder.message(&[&arguments, &SIZE[..]].concat(), 1);
    assert!(message.contains("frame_0"), "{message}");
    assert_eq!(names(&folder.path("other")).len(), 2);
}

#[test]
fn parts_are_merged_within_the_memory() {
    let folder = Folder::new();
    folder.render_whole("seed_sphere", &["--cost=counters"], "whole");
    for part in ["--part=1/3", "--part=2/3", "--part=3/3"] {
        let command = [
            "render",
            "configs/seed_sphere.yaml",
            "--quiet",
            "--out=parts",
        ];
        let flags = ["--cost=counters", part, "--memory=60M"];
        assert_success(&folder.run(&[&command, &SIZE[..], &flags].concat()));
    }
    assert_success(&folder.run(&["merge", "parts", MEMORY]));
    assert!(n_pieces(&folder.path("parts")) > 1);
    assert_same_data(&folder.path("whole"), &folder.path("parts"));
}

#[test]
fn a_timeout_leaves_pieces_that_a_later_run_completes() {
    let folder = Folder::new();
    let flags = ["--cost=counters", "--set=tiles.order=scanline"];
    folder.render_whole("spot", &flags, "whole");
    let arguments = [
        "render",
        "configs/spot.yaml",
        "--out=out",
        MEMORY,
        "--quiet",
    ];
    let with = |more: &[&str]| folder.run(&[&arguments, &SIZE[..], &flags, more].concat());
    assert_eq!(with(&["--timeout=1ms"]).status.code(), Some(4));
    let partial = summary(&folder.path("out"));
    assert!(partial["partial"]["n_missing_tiles"].as_u64().unwrap() > 0);
    assert!(n_pieces(&folder.path("out")) > 1);
    assert_success(&with(&["--resume"]));
    assert_same_data(&folder.path("whole"), &folder.path("out"));
}

#[test]
fn too_little_memory_and_what_needs_a_whole_picture_are_refused() {
    let folder = Folder::new();
    let refused = |flags: &[&str]| {
        let command = ["render", "configs/seed_extended.yaml", "--out=out"];
        let message = folder.message(&[&command, &SIZE[..], flags].concat(), 2);
        assert!(!folder.path("out/summary.json").exists());
        message
    };
    let message = refused(&["--memory=1M"]);
    assert!(
        message.contains("the program itself takes") && message.contains("give `--memory 32M`"),
        "{message}"
    );
    // The advice is enough.
    let small = "render configs/seed_extended.yaml --out=small --width=600 --height=400 --also=exr";
    let small: Vec<&str> = small.split(' ').collect();
    let message = folder.message(&[&small[..], &["--memory=40M"]].concat(), 2);
    assert!(message.contains("left of `--memory`"), "{message}");
    let (_, enough) = message.split_once("give `--memory ").unwrap();
    let enough = enough.split('`').next().unwrap();
    assert_success(&folder.run(&[&small[..], &["--memory", enough]].concat()));
    let message = refused(&[MEMORY, "--cost=counters", "--also=exr"]);
    assert!(message.contains("image.exr"), "{message}");
    let message = refused(&["--memory=lots"]);
    assert!(message.contains("such as 500M or 4G"), "{message}");
}

/// The pieces as VTK joins them.
#[test]
#[ignore = "needs PyPI's vtk: run tests/with-paraview"]
fn pieces_by_vtk() {
    let folder = Folder::new();
    folder.render_whole("seed_extended", &["--cost=counters"], "whole");
    for (codec, most) in [("none", 72), ("lz4", 100)] {
        let (out, flags) = (codec, ["--cost=counters", "--compress", codec]);
        folder.render_within(most, "seed_extended", &flags, out);
        for [file, pieces] in [["frame.vti", "frame.pvti"], ["hits.vtu", "hits.pvtu"]] {
            let expected = DataSet::read_with_vtk(&folder.path("whole").join(file));
            let found = DataSet::read_with_vtk(&folder.path(out).join(pieces));
            assert_eq!(found.extent, expected.extent);
            assert_eq!(found.n_points, expected.n_points);
            assert_eq!(found.normals, expected.normals);
            // The codec is part of the run.
            let names = |data: &DataSet| {
                data.texts
                    .iter()
                    .map(|(name, _)| name.clone())
                    .collect::<Vec<_>>()
            };
            assert_eq!(names(&found), names(&expected));
            // VTK may join cells as wider integers.
            let is_of_points = |array: &&Array| {
                !["connectivity", "offsets", "types", "thread"].contains(&&*array.name)
            };
            for array in expected.arrays.iter().filter(is_of_points) {
                assert!(
                    found.array(&array.name).bytes == array.bytes,
                    "{}",
                    array.name
                );
            }
        }
    }
}
