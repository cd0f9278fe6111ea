//! The arrays of cloud and frame that `output.arrays` chooses.

use std::fs;
use std::path::Path;
use std::process::Output;

use base::Keyword;
use scene::config::PixelArray;

use crate::common::data_set::DataSet;
use crate::common::paraview::{load_own, render};
use crate::common::{assert_success, in_repository, raycost};

/// The arrays of the points and cells of a cloud.
const OF_GRIDS: [&str; 4] = ["Points", "connectivity", "offsets", "types"];

/// The numbers in the field data.
const FIELDS: [&str; 6] = [
    "camera_position",
    "camera_direction",
    "camera_up",
    "camera_fov_deg",
    "resolution",
    "node_visits_range",
];

/// Renders a small picture with counters, and these arrays of it, into a folder.
fn rendered(out: &Path, arrays: Option<&str>, flags: &[&str]) {
    let mut command = raycost();
    command.arg("render");
    command.arg(in_repository("configs/seed_extended.yaml"));
    command.args(["--quiet", "--width=40", "--height=30", "--cost=counters"]);
    command.args(arrays.map(|list| format!("--set=output.arrays=[{list}]")));
    let output = command.args(flags).arg("--out").arg(out).output();
    assert_success(&output.unwrap());
}

#[test]
fn the_files_have_the_chosen_arrays_and_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("whole");
    rendered(&whole, None, &["--threads=1"]);
    for chosen in [
        "RGB",
        "horizon",
        "node_visits, pixel, Normals",
        "depth, tile, thread, object, RGB, distance, footprint, pixel, horizon",
    ] {
        for codec in ["none", "lz4", "zlib"] {
            let out = folder.path().join("chosen");
            rendered(&out, Some(chosen), &["--threads=1", "--compress", codec]);
            for file in ["hits.vtu", "frame.vti"] {
                let [mut expected, found] =
                    [&whole, &out].map(|out| DataSet::read(&out.join(file)));
                let is_kept = |name: &str| {
                    OF_GRIDS.contains(&name)
                        || (FIELDS.contains(&name) && name != "node_visits_range")
                        || (name == "node_visits_range" && chosen.contains("node_visits"))
                        || chosen.split(", ").any(|word| word == name)
                };
                expected.arrays.retain(|array| is_kept(&array.name));
                let names = |set: &DataSet| -> Vec<String> {
                    set.arrays.iter().map(|array| array.name.clone()).collect()
                };
                assert_eq!(names(&found), names(&expected), "{chosen}: {file}, {codec}");
                assert!(found.arrays == expected.arrays, "{chosen}: {file}, {codec}");
                assert_eq!(found.n_points, expected.n_points);
            }
        }
    }
}

/// All names of arrays that are not in this list.
fn others(chosen: &str) -> Vec<&'static str> {
    let names = PixelArray::KEYWORDS.iter().map(|array| array.name());
    let is_chosen = |name: &&str| chosen.split(", ").any(|word| word == *name);
    names.filter(|name| !is_chosen(name)).collect()
}

#[test]
fn a_state_names_no_array_that_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let states = |names: &[&'static str]| names.to_vec();
    for (chosen, flags, expected) in [
        ("RGB", &[][..], states(&[])),
        ("RGB, time_ns", &["--cost=time"], states(&[])),
        ("rays, node_visits", &[], states(&["heatmap"])),
        // Without a light behind a mirror, some rays are none.
        ("diffuse_rays, refraction_rays", &[], states(&["heatmap"])),
        ("RGB, footprint, distance", &[], states(&["geometry"])),
        (
            "RGB, footprint, distance",
            &["--cost=time", "--also=schedule,bvh,surface"],
            states(&["bvh", "geometry", "schedule", "surface"]),
        ),
        (
            "RGB, footprint, distance, depth",
            &["--also=bvh"],
            states(&["bvh", "geometry", "overview"]),
        ),
        (
            "RGB, footprint, distance, depth, time_ns",
            &["--cost=time"],
            states(&["geometry", "heatmap", "overview"]),
        ),
        ("object", &["--also=schedule,bvh"], states(&[])),
    ] {
        let out = folder.path().join("out");
        let flags: Vec<&str> = flags.to_vec();
        rendered_as(&out, chosen, &flags);
        let mut found: Vec<String> = fs::read_dir(&out)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter(|name| name.ends_with(".pvsm"))
            .collect();
        found.sort();
        let names: Vec<String> = expected.iter().map(|name| format!("{name}.pvsm")).collect();
        assert_eq!(found, names, "{chosen} {flags:?}");
        for state in &found {
            // It shows a file of its own; so do others, beside the cloud.
            if state == "surface.pvsm" {
                continue;
            }
            let text = fs::read_to_string(out.join(state)).unwrap();
            for name in others(chosen) {
                let is_own = ["schedule.pvsm", "bvh.pvsm"].contains(&&**state)
                    && ["thread", "tile", "time_ns"].contains(&name);
                for use_of in [
                    format!("\"{name}\""),
                    format!("\"{name}*"),
                    format!("({name}"),
                ] {
                    assert!(
                        is_own || !text.contains(&use_of),
                        "{chosen}: {state}: {use_of}"
                    );
                }
            }
        }
        let picture = fs::read(out.join("image.png")).unwrap();
        let key = b"ParaViewState";
        let has_state = picture.windows(key.len()).any(|bytes| bytes == key);
        assert_eq!(has_state, expected.contains(&"geometry"), "{chosen}");
        assert_success(&raycost().arg("check").arg(&out).output().unwrap());
    }
}

/// [`rendered`], whose mode of cost the flags may set.
fn rendered_as(out: &Path, chosen: &str, flags: &[&str]) {
    let cost = flags.iter().find(|flag| flag.starts_with("--cost"));
    let mut command = raycost();
    command.arg("render");
    command.arg(in_repository("configs/seed_extended.yaml"));
    command.args(["--quiet", "--width=40", "--height=30"]);
    command.arg(format!("--set=output.arrays=[{chosen}]"));
    command.args(cost.is_none().then_some("--cost=counters"));
    let output = command.args(flags).arg("--out").arg(out).output();
    assert_success(&output.unwrap());
}

/// The message of a command that ends with 2.
fn message(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2));
    String::from_utf8(output.stderr.clone()).unwrap()
}

#[test]
fn view_and_diff_name_what_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    rendered(&path("whole"), None, &[]);
    rendered(&path("bare"), Some("Normals"), &[]);
    rendered(&path("seen"), Some("RGB, footprint"), &[]);
    rendered(&path("page"), Some("RGB, footprint, pixel"), &[]);
    rendered(&path("visits"), Some("RGB, object, tile, node_visits"), &[]);
    let all = "RGB, object, tile, node_visits, primitive_tests";
    rendered(&path("diff"), Some(all), &[]);

    let view = |name| raycost().arg("view").arg(path(name)).output().unwrap();
    let text = message(&view("bare"));
    assert!(
        text.contains(
            "frame.vti` has no arrays `RGB`, `footprint`: `output.arrays` leaves them out"
        ),
        "{text}"
    );
    assert!(
        text.contains("add `RGB`, `footprint` to `output.arrays`"),
        "{text}"
    );
    let text = message(&view("seen"));
    assert!(
        text.contains("hits.vtu` has no array `pixel`: `output.arrays` leaves it out"),
        "{text}"
    );
    assert_success(&view("page"));

    let diff = |name| {
        let mut diff = raycost();
        diff.arg("diff").args([path(name), path("whole")]);
        diff.arg("--out").arg(path("changes")).output().unwrap()
    };
    let text = message(&diff("bare"));
    assert!(
        text.contains("holds no cost to compare") && text.contains("`output.arrays`"),
        "{text}"
    );
    let text = message(&diff("visits"));
    assert!(
        text.contains("has no array `primitive_tests`: `output.arrays`"),
        "{text}"
    );
    let output = diff("diff");
    assert_success(&output);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains("picture   the same colors\n")
            && text.contains("nodes + tests by tile: the same\n"),
        "{text}"
    );
}

#[test]
fn trace_shows_its_own_cloud_whatever_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let mut trace = raycost();
    trace
        .arg("trace")
        .arg(in_repository("configs/seed_extended.yaml"));
    trace.args([
        "--pixel=100,100",
        "--quiet",
        "--set=output.arrays=[object]",
        "--out",
    ]);
    assert_success(&trace.arg(folder.path()).output().unwrap());
    let cloud = DataSet::read(&folder.path().join("rays_cloud.vtu"));
    for name in ["RGB", "footprint", "distance"] {
        assert!(
            cloud.arrays.iter().any(|array| array.name == name),
            "{name}"
        );
    }
}

#[test]
fn totals_and_pictures_stay_whole() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, chosen] = ["whole", "chosen"].map(|name| folder.path().join(name));
    rendered(&whole, None, &["--also=exr", "--threads=1"]);
    rendered(&chosen, Some("RGB"), &["--also=exr", "--threads=1"]);
    let summary = |out: &Path| -> serde_json::Value {
        serde_json::from_slice(&fs::read(out.join("summary.json")).unwrap()).unwrap()
    };
    let [a, b] = [&whole, &chosen].map(|out| summary(out));
    assert_eq!(a["cost"]["totals"], b["cost"]["totals"]);
    assert_eq!(b["arrays"], serde_json::json!(["RGB"]));
    assert!(a.get("arrays").is_none());
    let bytes = |summary: &serde_json::Value, name: &str| {
        let files = summary["files"].as_array().unwrap();
        files.iter().find(|file| file["file"] == name).unwrap()["bytes"].clone()
    };
    assert_eq!(bytes(&a, "image.exr"), bytes(&b, "image.exr"));
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn states_of_chosen_arrays_load() {
    let scene = in_repository("configs/seed_extended.yaml");
    for (name, chosen, shown) in [
        (
            "distance alone",
            "RGB,footprint,distance",
            &[("geometry", "RGB,distance")][..],
        ),
        ("costs alone", "rays,depth", &[("heatmap", "rays,depth")]),
        (
            "some costs",
            "RGB,footprint,distance,primitive_tests,depth",
            &[
                ("geometry", "RGB,primitive_tests"),
                ("heatmap", "primitive_tests,depth"),
                ("overview", "RGB,primitive_tests"),
            ],
        ),
    ] {
        let arrays = format!("--set=output.arrays=[{chosen}]");
        let out = render(&scene, name, &[&arrays]);
        load_own(&out, shown);
    }
}
