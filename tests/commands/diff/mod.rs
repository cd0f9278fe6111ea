//! `raycost diff` reports exact differences, and its gate fails only for significant
//! ones.

mod equal_noise;
mod foreign;
mod noise;
mod values;

use std::fs;
use std::path::Path;
use std::process::Output;

use serde_json::{Value, json};

use crate::common::data_set::DataSet;
use crate::common::scenes::SMALL_SCENE as SCENE;
use crate::common::{assert_success, raycost, replace_file};
use output::results::Results;

/// Renders the scene twice in a new folder: `a`, and `b` without a hierarchy.
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

/// The output of `--json`, and the exit code.
fn json_report(folder: &Path, arguments: &[&str]) -> (Value, Option<i32>) {
    let output = diff(folder, &[arguments, &["--json"]].concat());
    let value = serde_json::from_slice(&output.stdout);
    (value.unwrap_or(Value::Null), output.status.code())
}

/// The error message of a call with exit code 2.
fn error(folder: &Path, arguments: &[&str]) -> String {
    let output = diff(folder, arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(output.stdout.is_empty(), "{message}");
    message
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
        "counters  the same in every pixel\n",
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
fn objects_are_compared_by_ray_hits_if_both_outputs_have_tables() {
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
        json_report(folder.path(), &["a", "b"]).0["objects_reached"],
        json!([])
    );
    write("b", &table([11, 50]));
    let (found, _) = json_report(folder.path(), &["a", "b"]);
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
fn outputs_that_cannot_be_compared_are_refused() {
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
            "`a.yaml`: it is not a picture or a cost map of a known format",
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
fn the_same_windows_are_compared() {
    let crop = "--crop=13,7,20,15";
    let folder = outputs(&["--cost=counters", crop]);
    let (found, code) = json_report(folder.path(), &["a", "b"]);
    let size = json!({ "width": 20, "height": 15 });
    assert_eq!((&found["image"], code), (&size, Some(0)));
    // Its pixels are those of the whole picture.
    render(folder.path(), "whole", SCENE, &["--cost=counters"]);
    let visits = |name: &str| {
        let array = Results::open(&folder.path().join(name)).unwrap();
        let array = array.frame().unwrap().read("node_visits").unwrap();
        array.values.iter().collect::<Vec<f64>>()
    };
    let whole = visits("whole");
    let rows = whole.chunks(50).skip(7).take(15);
    let sum: f64 = rows.flat_map(|row| &row[13..33]).sum();
    assert_eq!(found["totals"]["node_visits"]["a"], json!(sum as i64));
    // The whole picture is cut to the window, on either side.
    let visits = json!(sum as i64);
    for names in [["a", "whole"], ["whole", "a"]] {
        let (found, code) = json_report(folder.path(), &names);
        assert_eq!((&found["image"], code), (&size, Some(0)));
        assert_eq!(found["origin"], json!([13, 7]));
        assert_eq!(found["totals"]["node_visits"]["a"], visits);
        assert_eq!(found["totals"]["node_visits"]["b"], visits);
        assert_eq!(found["picture"]["n_pixels"], 0);
        assert_eq!(found["n_pixels_of_other_objects"], 0);
    }
    let report = diff(folder.path(), &["whole", "a"]);
    let report = String::from_utf8(report.stdout).unwrap();
    let pixels = "the 20 x 15 at 13,7 of the picture, which both outputs show";
    assert!(report.contains(pixels), "{report}");
    // Of two windows, the pixels of both are compared.
    render(
        folder.path(),
        "beside",
        SCENE,
        &["--cost=counters", "--crop=30,10,12,20"],
    );
    let (found, _) = json_report(folder.path(), &["a", "beside"]);
    assert_eq!(found["image"], json!({ "width": 3, "height": 12 }));
    assert_eq!(found["origin"], json!([30, 10]));
    // Pixels have the numbers of B's files, the bottom row first.
    assert_success(&diff(folder.path(), &["whole", "a", "--out", "cut"]));
    let cut = DataSet::read(&folder.path().join("cut/diff.vti"));
    let own = DataSet::read(&folder.path().join("a/frame.vti"));
    assert_success(&diff(folder.path(), &["a", "whole", "--out", "back"]));
    let back = DataSet::read(&folder.path().join("back/diff.vti"));
    for (name, corners) in [("pixel_x", [13, 32]), ("pixel_y", [21, 7])] {
        assert_eq!(cut.array(name), own.array(name));
        let numbers = back.array(name).bytes.as_chunks().0;
        let ends = [&numbers[0], &numbers[numbers.len() - 1]];
        assert_eq!(ends.map(|end| u16::from_ne_bytes(*end)), corners);
    }
    assert_eq!(found["picture"]["n_pixels"], 0);
    // A window of everything is the whole picture.
    render(
        folder.path(),
        "all",
        SCENE,
        &["--cost=counters", "--crop=0,0,50,40"],
    );
    assert_success(&diff(folder.path(), &["all", "whole", "--fail-above=0%"]));
}

#[test]
fn windows_without_a_common_pixel_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (name, flags) in [
        ("window", &["--crop=13,7,20,15"][..]),
        ("beside", &["--crop=33,7,10,15"]),
        ("large", &["--width=70", "--crop=13,7,20,15"]),
    ] {
        render(
            folder.path(),
            name,
            SCENE,
            &[&["--cost=counters"], flags].concat(),
        );
    }
    let help = "render B again with `--width 50 --height 40 --crop 13,7,20,15`";
    for (b, message) in [
        (
            "beside",
            "the outputs show no pixel in common: `window` has 20 x 15 at 13,7 of 50 x 40, \
             `beside` has 10 x 15 at 33,7 of 50 x 40 pixels",
        ),
        (
            "large",
            "the pictures differ in size: `window` has 20 x 15 at 13,7 of 50 x 40, `large` has \
             20 x 15 at 13,7 of 70 x 40 pixels",
        ),
    ] {
        let found = error(folder.path(), &["window", b]);
        assert!(found.contains(message) && found.contains(help), "{found}");
    }
}

#[test]
fn times_of_a_part_of_a_picture_are_not_tested() {
    let folder = outputs(&["--cost=time", "--repeats=3"]);
    render(
        folder.path(),
        "window",
        SCENE,
        &["--cost=time", "--repeats=3", "--crop=13,7,20,15"],
    );
    let (found, _) = json_report(folder.path(), &["a", "window"]);
    assert_eq!(found["noise"], json!({ "verdict": "cut" }));
    let found = error(folder.path(), &["a", "window", "--fail-above=5%"]);
    assert!(found.contains("in a part of a picture"), "{found}");
    assert!(found.contains("with the same `--crop`"), "{found}");
}

#[test]
fn settings_that_differ_have_the_digits_of_the_scene() {
    let folder = outputs(&["--exposure=0.7"]);
    render(folder.path(), "c", SCENE, &["--exposure=1.3"]);
    let output = diff(folder.path(), &["a", "c"]);
    assert_success(&output);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains(" film.exposure: 0.7 → 1.3\n"), "{text}");
}

#[test]
fn a_different_machine_is_reported() {
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

#[test]
fn pixels_with_other_counters_are_counted() {
    let folder = outputs(&["--cost=counters", "--also=lanes"]);
    let counters = |name: &str| {
        let frame = Results::open(&folder.path().join(name)).unwrap();
        let frame = frame.frame().unwrap();
        ["node_visits", "primitive_tests", "rays", "depth"].map(|name| {
            let array = frame.read(name).unwrap();
            array.values.iter().collect::<Vec<f64>>()
        })
    };
    let [a, b] = ["a", "b"].map(counters);
    let differs = |pixel: &usize| (0..a.len()).any(|i| a[i][*pixel] != b[i][*pixel]);
    let n = (0..a[0].len()).filter(differs).count();
    assert!(n > 0);
    let (found, _) = json_report(folder.path(), &["a", "b"]);
    assert_eq!(found["n_pixels_of_other_counters"], json!(n));
    let totals = ["a", "b"].map(|name| {
        let summary = fs::read(folder.path().join(name).join("summary.json")).unwrap();
        let summary: Value = serde_json::from_slice(&summary).unwrap();
        summary["cost"]["totals"]["idle_lanes"].clone()
    });
    let idle = &found["totals"]["idle_lanes"];
    assert_eq!([&idle["a"], &idle["b"]], [&totals[0], &totals[1]]);
    // A part of a picture has none.
    let crop = ["--cost=counters", "--also=lanes", "--crop=13,7,20,15"];
    render(folder.path(), "part", SCENE, &crop);
    let (found, _) = json_report(folder.path(), &["a", "part"]);
    assert_eq!(found["totals"]["idle_lanes"], Value::Null);
}

#[test]
fn devices_and_their_kernels_stand_beside_each_other() {
    let folder = outputs(&["--cost=time", "--repeats=2"]);
    render(folder.path(), "b", SCENE, &["--cost=time", "--repeats=2"]);
    let kernel = |name: &str, seconds: f64| {
        json!({
            "name": name, "launches": 2, "rays": 9, "seconds": seconds, "group_size": 64,
            "warp_size": 8, "steps": 30, "lane_steps": 40, "share": 0.1,
        })
    };
    let put = |side: &str, device: &str, kernels: Value| {
        let file = folder.path().join(side).join("summary.json");
        let mut summary: Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
        summary["acceleration"]["device"] = json!(device);
        summary["acceleration"]["kernels"] = kernels;
        fs::write(file, summary.to_string()).unwrap();
    };
    let report = || {
        let output = diff(folder.path(), &["a", "b"]);
        assert_success(&output);
        String::from_utf8(output.stdout).unwrap()
    };
    let both = json!([kernel("nearest", 0.004), kernel("occluded", 0.002)]);
    put("b", "card", both);
    let text = report();
    for lines in [
        "\nkernel    A     B  B / A  idle in A    in B\n\
         nearest   -  4 ms                 -  25.0 %\n\
         occluded  -  2 ms                 -  25.0 %\n",
        "A and B ran on different devices, which changes their times too\n",
        "counters  the same in every pixel\n",
        "machine   acceleration.device: null → \"card\"\n",
    ] {
        assert!(text.contains(lines), "{text}");
    }
    put("a", "processor", json!([kernel("nearest", 0.008)]));
    let text = report();
    for lines in [
        "\nnearest   8 ms  4 ms  0.500     25.0 %  25.0 %\n\
         occluded     -  2 ms                 -  25.0 %\n",
        "machine   acceleration.device: \"processor\" → \"card\"\n",
    ] {
        assert!(text.contains(lines), "{text}");
    }
    let (found, _) = json_report(folder.path(), &["a", "b"]);
    assert_eq!(found["kernels"][0]["a"]["seconds"], json!(0.008));
    assert_eq!(found["kernels"][1]["a"], Value::Null);
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
