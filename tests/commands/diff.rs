//! `raycost diff` tells what changed, to the last bit, and closes its gate for
//! a reason.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use serde_json::{Value, json};

use crate::common::data_set::{Array, DataSet};
use crate::common::{assert_success, raycost, replace_file};

/// Mirrors, a plane that no box holds, and a background.
const SCENE: &str = "
image: { width: 50, height: 40 }
camera:
  look_at: { eye: [0, 1, 5], target: [0, 0.5, 0], fov_y_deg: 40 }
materials:
  red: { color: [1, 0.2, 0.1], reflection: 0.3 }
lights:
  - point: { position: [3, 5, 9] }
objects:
  - sphere: { center: [0.5, 0.3, 0], radius: 1 }
    material: red
    name: ball
  - plane: { point: [0, -1, 0], normal: [0, 1, 0] }
    material: red
  - sphere_cloud: { count: 40, min: [-2, 0, -2], max: [2, 2, 2], radius: [0.05, 0.2], seed: 3 }
    material: red
";

/// Two outputs of the scene in a folder of their own: `a`, and `b` without a
/// hierarchy.
fn outputs(arguments: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let brute_force = format!("{SCENE}acceleration: brute_force\n");
    render(folder.path(), "a", SCENE, arguments);
    render(folder.path(), "b", &brute_force, arguments);
    folder
}

fn render(folder: &Path, name: &str, scene: &str, arguments: &[&str]) {
    let file = folder.join(name).with_extension("yaml");
    fs::write(&file, scene).unwrap();
    let output = raycost()
        .arg("render")
        .arg(file)
        .args(["--quiet", "--out"])
        .arg(folder.join(name))
        .args(arguments)
        .output();
    assert_success(&output.unwrap());
}

fn diff(folder: &Path, arguments: &[&str]) -> Output {
    raycost()
        .arg("diff")
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

/// What `--json` says, and the exit code.
fn json(folder: &Path, arguments: &[&str]) -> (Value, Option<i32>) {
    let output = diff(folder, &[arguments, &["--json"]].concat());
    let value = serde_json::from_slice(&output.stdout);
    (value.unwrap_or(Value::Null), output.status.code())
}

/// The error of a wrong call.
fn error(folder: &Path, arguments: &[&str]) -> String {
    let output = diff(folder, arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(output.stdout.is_empty(), "{message}");
    message
}

/// Writes `repeats` into the summary of an output.
fn repeat(output: &Path, busy_ns: &Value) {
    let file = output.join("summary.json");
    let mut summary: Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    summary["repeats"] = json!({ "n": 10, "busy_ns": busy_ns, "wall_ms": [] });
    fs::write(file, summary.to_string()).unwrap();
}

fn repeat_both(folder: &tempfile::TempDir, busy_ns: &Value) {
    for side in ["a", "b"] {
        repeat(&folder.path().join(side), busy_ns);
    }
}

fn frame(path: PathBuf) -> DataSet {
    DataSet::read(&path.join("frame.vti"))
}

/// The numbers of an array of four bytes each.
fn numbers(array: &Array) -> Vec<f64> {
    let number = |bytes: &[u8]| {
        let bytes = bytes.try_into().unwrap();
        match array.scalar.as_str() {
            "Float32" => f64::from(f32::from_ne_bytes(bytes)),
            "UInt32" => f64::from(u32::from_ne_bytes(bytes)),
            other => panic!("{other}"),
        }
    };
    array.bytes.chunks_exact(4).map(number).collect()
}

const COUNTERS: [&str; 7] = [
    "node_visits",
    "primitive_tests",
    "rays",
    "shadow_rays",
    "reflection_rays",
    "refraction_rays",
    "depth",
];

fn assert_differences(folder: &Path, arrays: &[&str]) {
    let [a, b] = ["a", "b"].map(|name| frame(folder.join(name)));
    let found = DataSet::read(&folder.join("out/diff-a-b/diff.vti"));
    assert_eq!(found.extent, a.extent);
    for name in arrays {
        let [a, b] = [&a, &b].map(|frame| numbers(frame.array(name)));
        let pairs = || a.iter().zip(&b);
        let difference = found.array(&format!("{name}_difference"));
        let expected: Vec<u8> = match *name {
            "time_ns" => pairs()
                .flat_map(|(a, b)| ((b - a) as f32).to_ne_bytes())
                .collect(),
            _ => pairs()
                .flat_map(|(a, b)| (*b as i64 - *a as i64).to_ne_bytes())
                .collect(),
        };
        assert!(difference.bytes == expected, "{name}_difference");
        // Nothing and nothing is no change; something for nothing is infinite.
        let ratio = |(a, b): (&f64, &f64)| match (*a, *b) {
            (0.0, 0.0) => 1.0,
            (0.0, _) => f32::INFINITY,
            (a, b) => (b / a) as f32,
        };
        let expected: Vec<u8> = pairs().flat_map(|pair| ratio(pair).to_ne_bytes()).collect();
        let ratios = &found.array(&format!("{name}_ratio")).bytes;
        assert!(*ratios == expected, "{name}_ratio");
    }
    assert_eq!(found.arrays.len(), 2 * arrays.len() + 3);
    for name in ["object", "tile"] {
        assert_eq!(found.array(name), b.array(name));
    }
}

#[test]
fn every_pixel_has_its_difference_and_its_ratio() {
    let folder = outputs(&["--cost=time"]);
    assert_success(&diff(folder.path(), &["a", "b"]));
    assert_differences(folder.path(), &[&["time_ns"][..], &COUNTERS].concat());
    // The other way round, there are visits where there were none.
    assert_success(&diff(folder.path(), &["b", "a", "--out", "back"]));
    let back = DataSet::read(&folder.path().join("back/diff.vti"));
    let ratios = |name: &str| numbers(back.array(&format!("{name}_ratio")));
    assert!(
        ratios("node_visits")
            .iter()
            .all(|ratio| *ratio == f64::INFINITY)
    );
    assert!(ratios("refraction_rays").iter().all(|ratio| *ratio == 1.0));
}

#[test]
fn arrays_that_one_output_lacks_are_left_out() {
    let folder = outputs(&["--cost=counters"]);
    render(folder.path(), "a", SCENE, &["--cost=time"]);
    let output = diff(folder.path(), &["a", "b"]);
    assert_success(&output);
    assert_differences(folder.path(), &COUNTERS);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("a time is missing in A or B"), "{text}");
    assert!(
        text.contains("cost.mode: \"time\" → \"counters\""),
        "{text}"
    );
}

#[test]
fn sums_of_pixels_objects_and_tiles_are_those_of_the_summaries() {
    let folder = outputs(&["--cost=counters"]);
    let (found, code) = json(folder.path(), &["a", "b"]);
    assert_eq!(code, Some(0));
    for side in ["a", "b"] {
        let summary = fs::read(folder.path().join(side).join("summary.json")).unwrap();
        let summary: Value = serde_json::from_slice(&summary).unwrap();
        for name in COUNTERS {
            let expected = &summary["cost"]["totals"][name];
            if !expected.is_null() {
                assert_eq!(&found["totals"][name][side], expected, "{name} of {side}");
            }
            for groups in ["objects", "tiles"].map(|groups| found[groups].as_array().unwrap()) {
                let costs = groups
                    .iter()
                    .map(|group| group["totals"][name][side].as_u64().unwrap());
                let together = match name {
                    "depth" => costs.max(),
                    _ => Some(costs.sum()),
                };
                assert_eq!(
                    json!(together),
                    found["totals"][name][side],
                    "{name} of {side}"
                );
            }
        }
    }
    let names: Vec<&str> = found["objects"]
        .as_array()
        .unwrap()
        .iter()
        .map(|object| object["name"].as_str().unwrap())
        .collect();
    for name in [
        "nothing",
        "ball",
        "plane (object 1)",
        "sphere_cloud (object 2)",
    ] {
        assert!(names.contains(&name), "{names:?}");
    }
    let tiles = found["tiles"].as_array().unwrap();
    assert_eq!(tiles.len(), 4 * 3);
    let last = tiles.iter().find(|tile| tile["name"] == "tile 11").unwrap();
    assert_eq!(
        (&last["x"], &last["y"]),
        (&json!([48, 49]), &json!([32, 39]))
    );
}

#[test]
fn an_output_does_not_differ_from_itself() {
    let folder = outputs(&["--cost=counters"]);
    let output = diff(folder.path(), &["a", "a", "--fail-above", "0%"]);
    assert_success(&output);
    let text = String::from_utf8(output.stdout).unwrap();
    for line in [
        "nodes + tests by tile: the same",
        "picture   the same colors\n",
        "settings  the same\n",
        "machine   the same\n",
        "gate      passed: +0.0 % of node visits + primitive tests; 0 % may be added\n",
    ] {
        assert!(text.contains(line), "{text}");
    }
    let mut files: Vec<_> = fs::read_dir(folder.path().join("out/diff-a-a"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    files.sort();
    assert_eq!(files, ["diff.json", "diff.png", "diff.pvsm", "diff.vti"]);
}

#[test]
fn another_picture_is_told() {
    let folder = outputs(&["--cost=counters"]);
    let moved = SCENE
        .replace("center: [0.5, ", "center: [0.6, ")
        .replace("0.2, 0.1]", "0.2, 0.2]");
    render(folder.path(), "b", &moved, &["--cost=counters"]);
    let (found, _) = json(folder.path(), &["a", "b"]);
    let [a, b] = ["a", "b"].map(|name| frame(folder.path().join(name)));
    let [rgb_a, rgb_b] = [&a, &b].map(|frame| frame.array("RGB").bytes.as_chunks::<3>().0);
    let apart = |(a, b): (&[u8; 3], &[u8; 3])| [0, 1, 2].map(|i| a[i].abs_diff(b[i]));
    let apart: Vec<[u8; 3]> = rgb_a.iter().zip(rgb_b).map(apart).collect();
    let n_pixels = apart.iter().filter(|apart| **apart != [0; 3]).count();
    assert!(n_pixels > 100);
    assert_eq!(found["picture"]["n_pixels"], json!(n_pixels));
    assert_eq!(found["picture"]["max"], json!(apart.iter().flatten().max()));
    let written = DataSet::read(&folder.path().join("out/diff-a-b/diff.vti"));
    let by_pixel: Vec<u8> = apart
        .iter()
        .map(|apart| *apart.iter().max().unwrap())
        .collect();
    assert!(written.array("RGB_difference").bytes == by_pixel);
    let [objects_a, objects_b] =
        [&a, &b].map(|frame| frame.array("object").bytes.as_chunks::<4>().0);
    let n_others = objects_a
        .iter()
        .zip(objects_b)
        .filter(|(a, b)| a != b)
        .count();
    assert_eq!(found["n_pixels_of_other_objects"], json!(n_others));
}

/// The sums of the pixels' times say something else than the repeats: the
/// ratio that is shown is everywhere the one that the interval belongs to.
#[test]
fn the_ratio_of_the_time_lies_within_its_interval() {
    let folder = outputs(&[]);
    for seed in 0..4 {
        let times = |salt: u64| -> Value {
            let time = |i: u64| {
                let [u, ..] = raycost::sampling::uniform([seed, salt, i]);
                f64::from(u).mul_add(3e8, 1e9)
            };
            (0..4 + seed + salt).map(time).collect()
        };
        repeat(&folder.path().join("a"), &times(0));
        repeat(&folder.path().join("b"), &times(1));
        let (found, _) = json(folder.path(), &["a", "b"]);
        let ratio = found["totals"]["time_ns"]["ratio"].as_f64().unwrap();
        let test = &found["noise"]["ratio"];
        let [low, high] = [0, 1].map(|end| test["interval"][end].as_f64().unwrap());
        assert!((low..=high).contains(&ratio), "{ratio} of {test}");
        assert_eq!(found["totals"]["time_ns"]["ratio"], test["estimate"]);
        let text = String::from_utf8(diff(folder.path(), &["a", "b"]).stdout).unwrap();
        let row = text
            .lines()
            .find(|line| line.starts_with("time  "))
            .unwrap();
        assert!(row.ends_with(&format!(" {ratio:.3}")), "{row}");
        let evidence = format!("B / A is {ratio:.3} (95 %: {low:.3} to {high:.3})");
        assert!(text.contains(&evidence), "{text}");
    }
}

#[test]
fn the_gate_closes_for_a_time_that_is_surely_too_high() {
    let folder = outputs(&[]);
    let times = |center: f64| -> Value {
        // Noise of 1 %.
        let noise = |i: i32| center * (1.0 + 0.002 * f64::from(i * 7 % 10 - 5));
        (0..10).map(noise).collect()
    };
    repeat(&folder.path().join("a"), &times(1e9));
    for (center, limit, verdict, code) in [
        (1.001e9, "0%", "within_noise", 0),
        (1.04e9, "0%", "slower", 3),
        (1.04e9, "5%", "slower", 0),
        // Above, but not surely so.
        (1.051e9, "5%", "slower", 0),
        (1.08e9, "5%", "slower", 3),
        (1.08e9, "12.5 %", "slower", 0),
        (0.5e9, "5%", "faster", 0),
    ] {
        repeat(&folder.path().join("b"), &times(center));
        let (found, found_code) = json(folder.path(), &["a", "b", "--fail-above", limit]);
        let context = format!(
            "{center} within {limit}: {}, {}",
            found["noise"], found["gate"]
        );
        assert_eq!(found_code, Some(code), "{context}");
        assert_eq!(found["noise"]["verdict"], json!(verdict), "{context}");
        assert_eq!(found["gate"]["passed"], json!(code == 0), "{context}");
        let estimate = found["noise"]["ratio"]["estimate"].as_f64().unwrap();
        assert!((estimate / center * 1e9 - 1.0).abs() < 0.01, "{context}");
    }
    repeat(&folder.path().join("b"), &times(1.2e9));
    let output = diff(folder.path(), &["a", "b", "--fail-above", "5%"]);
    assert_eq!(output.status.code(), Some(3));
    let message = String::from_utf8(output.stderr).unwrap();
    let expected = "error: B costs too much: +20.0 % of time, +19.3 % at least; 5 % may be added";
    assert!(message.starts_with(expected), "{message}");
    // What was found is shown and written all the same.
    assert!(!output.stdout.is_empty());
    assert!(folder.path().join("out/diff-a-b/diff.vti").exists());
}

#[test]
fn the_gate_is_exact_for_counters() {
    let folder = outputs(&["--cost=counters"]);
    let (found, _) = json(folder.path(), &["a", "b"]);
    let steps = |side: &str| {
        let counts = ["node_visits", "primitive_tests"].map(|name| &found["totals"][name][side]);
        counts
            .map(|count| count.as_f64().unwrap())
            .iter()
            .sum::<f64>()
    };
    let percent = 100.0 * (steps("b") / steps("a") - 1.0);
    assert!(percent > 1.0, "{percent}");
    for (limit, code) in [(percent + 0.001, 0), (percent - 0.001, 3)] {
        let limit = format!("{limit}%");
        assert_eq!(
            json(folder.path(), &["a", "b", "--fail-above", &limit]).1,
            Some(code)
        );
    }
}

#[test]
fn a_gate_without_enough_repeats_is_refused() {
    let folder = outputs(&["--repeats=1"]);
    let arguments = ["a", "b", "--fail-above", "5%"];
    let advice = "render both with `--repeats 10`, or with `--cost counters`: counters are exact";
    for (times, reason) in [
        (None, "a change of time: there are no repeats"),
        (
            Some(json!([1e9, 1.1e9, 1.2e9])),
            "a change of time with only 3 and 3 repeats",
        ),
    ] {
        if let Some(times) = times {
            repeat_both(&folder, &times);
        }
        let message = error(folder.path(), &arguments);
        assert!(
            message.contains(reason) && message.contains(advice),
            "{message}"
        );
    }
    assert!(!folder.path().join("out").exists());
    repeat(&folder.path().join("a"), &json!([1e9, -1e9]));
    let message = error(folder.path(), &["a", "b"]);
    assert!(
        message.contains("`a/summary.json`: the time of a repeat is not positive"),
        "{message}"
    );
}

#[test]
fn repeats_and_none_are_told_apart_on_the_terminal() {
    let folder = outputs(&["--repeats=1"]);
    let noise = || {
        let output = diff(folder.path(), &["a", "b"]);
        assert_success(&output);
        let text = String::from_utf8(output.stdout).unwrap();
        let line = text.lines().find(|line| line.starts_with("noise"));
        line.unwrap().to_owned()
    };
    assert_eq!(
        noise(),
        "noise     a change of time cannot be tested without repeats: render both with `--repeats 10`; \
         counters are exact"
    );
    let times: Value = (100..105).map(|time| f64::from(time) * 1e6).collect();
    repeat_both(&folder, &times);
    assert_eq!(
        noise(),
        "noise     the change of time is within noise: B / A is 1.000 (95 %: 0.971 to \
         1.030); Mann-Whitney p = 1.00, 5 and 5 repeats"
    );
}

#[test]
fn objects_that_rays_meet_are_compared_where_both_outputs_have_them() {
    let folder = outputs(&["--cost=counters"]);
    let table = |visits: [u32; 2]| {
        let [ball, plane] = visits;
        format!(
            "kind,id,name,charge,ray_kind,pixels,rays,node_visits,primitive_tests,time_ns\n\
             object,0,ball,hit,all,1,1,{ball},1,\n\
             object,0,ball,hit,camera,1,1,999,1,\n\
             object,0,ball,primary,all,1,1,999,1,\n\
             object,1,\"the, plane\",hit,all,1,1,{plane},1,\n\
             material,0,red,hit,all,1,1,999,1,\n"
        )
    };
    let write = |side: &str, text: &str| {
        replace_file(&folder.path().join(side), "objects.csv", text.as_bytes());
    };
    write("a", &table([10, 20]));
    assert_eq!(
        json(folder.path(), &["a", "b"]).0["objects_reached"],
        json!([])
    );
    write("b", &table([11, 50]));
    let (found, _) = json(folder.path(), &["a", "b"]);
    let reached = found["objects_reached"].as_array().unwrap();
    let visits = |i: usize| &reached[i]["totals"]["node_visits"];
    assert_eq!(reached.len(), 2);
    assert_eq!(reached[0]["name"], json!("the, plane"));
    assert_eq!(
        visits(0),
        &json!({ "a": 20, "b": 50, "difference": 30, "ratio": 2.5 })
    );
    assert_eq!(
        (&reached[1]["name"], &visits(1)["b"]),
        (&json!("ball"), &json!(11))
    );
    write("b", "kind,name\n");
    let message = error(folder.path(), &["a", "b"]);
    assert!(
        message.contains("objects.csv`: it has no column `charge`"),
        "{message}"
    );
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let folder = outputs(&["--cost=counters"]);
    render(folder.path(), "small", SCENE, &["--width=8", "--height=6"]);
    render(folder.path(), "bare", SCENE, &["--no-cost"]);
    fs::create_dir(folder.path().join("empty")).unwrap();
    for (arguments, message, help) in [
        (
            ["a", "nowhere"],
            "`nowhere`",
            "give a folder that `raycost render` wrote",
        ),
        (
            ["empty", "a"],
            "`empty` holds no output",
            "give a folder that `raycost render` wrote",
        ),
        (
            ["a.yaml", "a"],
            "`a.yaml`",
            "give a folder that `raycost render` wrote",
        ),
        (
            ["a", "small"],
            "the pictures differ in size: `a` has 50 x 40, `small` has 8 x 6 pixels",
            "render B again with `--width 50 --height 40`",
        ),
        (
            ["bare", "a"],
            "`bare` holds no cost to compare",
            "render it again without `--no-cost`",
        ),
    ] {
        let found = error(folder.path(), &arguments);
        assert!(found.contains(message) && found.contains(help), "{found}");
    }
    for percent in ["5", "-5%", "%", "much", "nan%", "inf%"] {
        let found = error(
            folder.path(),
            &["a", "b", &format!("--fail-above={percent}")],
        );
        assert!(found.contains("such as `5%`"), "{found}");
    }
    assert!(!folder.path().join("out").exists());
}

#[test]
fn another_machine_is_told() {
    let folder = outputs(&[]);
    let file = folder.path().join("b/summary.json");
    let mut summary: Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    summary["machine"]["cpu"] = json!("Babbage 1");
    fs::write(file, summary.to_string()).unwrap();
    let output = diff(folder.path(), &["a", "b"]);
    assert_success(&output);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("A and B ran on different machines"), "{text}");
    assert!(text.contains(" → \"Babbage 1\"\n"), "{text}");
}

/// The table of a diff of many objects and tiles is longer than the bytes by
/// which raycost recognizes its own files.
#[test]
fn a_long_diff_can_be_written_again() {
    let folder = outputs(&[
        "--cost=counters",
        "--width=320",
        "--height=240",
        "--tile-size=2",
    ]);
    for _ in 0..2 {
        assert_success(&diff(folder.path(), &["a", "b"]));
    }
    let text = fs::read_to_string(folder.path().join("out/diff-a-b/diff.json"));
    let length = text.map_or(0, |text| text.len());
    assert!(length > 1 << 16, "{length}");
}
