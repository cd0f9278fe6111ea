//! `--json` prints what the command would say, and what its files hold, for other programs.

use std::path::Path;

use serde_json::Value;

use crate::common::data_set::DataSet;
use crate::common::{assert_success, in_repository, raycost};

/// Runs raycost with `--json`; returns the lines that it prints, each a value.
fn values(arguments: &[&str], folder: &Path) -> Vec<Value> {
    let mut command = raycost();
    let run = command.current_dir(folder).args(arguments).arg("--json");
    let run = run.output().unwrap();
    assert_success(&run);
    let text = String::from_utf8(run.stdout).unwrap();
    let value = |line| serde_json::from_str(line).unwrap();
    text.lines().map(value).collect()
}

fn config(name: &str) -> String {
    in_repository(&format!("configs/{name}.yaml"))
        .display()
        .to_string()
}

/// The `summary.json` of a folder, and the key that `--json` has before it.
fn summary(folder: &Path, out: &str) -> Value {
    let text = std::fs::read(folder.join(out).join("summary.json")).unwrap();
    let mut summary: Value = serde_json::from_slice(&text).unwrap();
    summary["out"] = out.into();
    summary
}

#[test]
fn a_rendering_prints_its_summary() {
    let folder = tempfile::tempdir().unwrap();
    let scene = config("blocks");
    let size = ["--width=40", "--height=30"];
    let still = ["render", &scene, "--out=an unusual “out”"];
    let lines = values(&[&still[..], &size].concat(), folder.path());
    assert_eq!(lines, [summary(folder.path(), "an unusual “out”")]);

    let scene = config("hopper");
    let film = ["render", &scene, "--frames=1..2", "--out=film"];
    let film = [&film[..], &size].concat();
    let frames = ["film/frames/0001", "film/frames/0002"];
    let expected = |out| summary(folder.path(), out);
    // Frames that are kept, too.
    for _ in 0..2 {
        let lines = values(&film, folder.path());
        assert_eq!(lines, frames.map(expected));
    }
}

#[test]
fn a_check_prints_what_the_rendering_then_says() {
    let folder = tempfile::tempdir().unwrap();
    let (still, film) = (config("herd"), config("hopper"));
    let study = config("studies/tiles");
    let checked = values(&["check", &still, &film, &study], folder.path());
    let [still_checked, film_checked, study] = &checked[..] else {
        panic!("{checked:#?}");
    };
    assert!(study["n_runs"].as_u64().unwrap() > study["n_quick_runs"].as_u64().unwrap());
    assert!(film_checked["frames"]["n"].as_u64().unwrap() > 1);

    let [summary] = &values(&["render", &still, "--out=out"], folder.path())[..] else {
        panic!();
    };
    let same = [
        "scene",
        "image",
        "n_primitives",
        "n_instances",
        "n_degenerate_triangles",
    ];
    for key in same {
        assert_eq!(still_checked[key], summary[key], "{key}");
    }
    for key in ["kind", "quality"] {
        assert_eq!(
            still_checked["acceleration"][key],
            summary["acceleration"][key]
        );
    }
    for key in ["tile_size", "order", "n_tiles"] {
        assert_eq!(still_checked["tiles"][key], summary["schedule"][key]);
    }
    assert_eq!(still_checked["cost"]["mode"], summary["cost"]["mode"]);
    let written = summary["files"].as_array().unwrap().iter();
    let written = written.map(|file| file["file"].clone());
    let written: Vec<_> = written.chain(["summary.json".into()]).collect();
    assert_eq!(still_checked["files"], Value::Array(written));
    assert!(still_checked["memory"]["at_most"].as_u64() > Some(1 << 20));

    let [output] = &values(&["check", "out"], folder.path())[..] else {
        panic!();
    };
    let n_files = summary["files"].as_array().unwrap().len() as u64 + 1;
    assert_eq!(output["n_files"], n_files);
    assert_eq!(output["n_frames"], Value::Null);
}

#[test]
fn a_check_prints_the_values_that_are_set_with_their_digits() {
    let folder = tempfile::tempdir().unwrap();
    let scene = config("blocks");
    let set = ["--set=image.filter=tent", "--set=image.filter_radius=1.1"];
    let checked = values(&[&["check", &scene][..], &set].concat(), folder.path());
    let render = ["render", &scene, "--width=40", "--height=30", "--out=out"];
    values(&[&render[..], &set].concat(), folder.path());
    let summary = summary(folder.path(), "out");
    assert_eq!(checked[0]["scene"], summary["scene"]);
    assert_eq!(
        summary["scene"]["set"],
        serde_json::json!(set.map(|flag| &flag["--set=".len()..]))
    );
    assert_eq!(checked[0]["image"]["filter_radius"], 1.1);
}

#[test]
fn a_trace_prints_the_rays_of_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let scene = config("glass");
    let arguments = ["trace", &scene, "--pixel=400..401,250", "--out=rays"];
    let pixels = values(&arguments, folder.path());
    let places: Vec<_> = pixels.iter().map(|pixel| &pixel["pixel"]).collect();
    assert_eq!(
        places,
        [
            &serde_json::json!([400, 250]),
            &serde_json::json!([401, 250])
        ]
    );

    let rays = pixels
        .iter()
        .flat_map(|pixel| pixel["rays"].as_array().unwrap());
    let rays: Vec<_> = rays.collect();
    let file = DataSet::read(&folder.path().join("rays/rays.vtp"));
    let printed = |name: &str, missing| -> Vec<i64> {
        let number = |ray: &&Value| ray.pointer(name).and_then(Value::as_i64);
        rays.iter()
            .map(|ray| number(ray).unwrap_or(missing))
            .collect()
    };
    for name in ["node_visits", "primitive_tests"] {
        let written = file.array(name).u32s().map(i64::from);
        assert_eq!(printed(&format!("/{name}"), 0), written.collect::<Vec<_>>());
    }
    for (pointer, name) in [
        ("/bounce", "bounce"),
        ("/light", "light"),
        ("/hit/object", "object"),
    ] {
        let written = file.array(name).i32s().map(i64::from);
        assert_eq!(printed(pointer, -1), written.collect::<Vec<_>>());
    }
    for name in ["direction", "distance", "contribution"] {
        let numbers = |ray: &&Value| match &ray[name] {
            Value::Array(all) => all.clone(),
            one => vec![one.clone()],
        };
        for number in rays.iter().flat_map(numbers).filter_map(|n| n.as_f64()) {
            let shortest = (number as f32).to_string();
            assert_eq!(number.to_string(), shortest, "{name}");
        }
    }
    let distances = rays
        .iter()
        .map(|ray| ray["distance"].as_f64().map(|d| d as f32));
    let written = file
        .array("distance")
        .f32s()
        .map(|d| Some(d).filter(|d| !d.is_nan()));
    assert!(distances.eq(written));
}
