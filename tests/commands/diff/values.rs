//! The differences and the ratios of pixels, objects, tiles and pictures.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::{SCENE, diff, json_report, outputs, render};
use crate::common::data_set::{Array, DataSet};
use crate::common::{COUNTERS, assert_success};

pub(super) fn frame(path: PathBuf) -> DataSet {
    DataSet::read(&path.join("frame.vti"))
}

/// The numbers of an array with four bytes per number.
pub(super) fn numbers(array: &Array) -> Vec<f64> {
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
        // 0 / 0 is no change.
        let ratio = |(a, b): (&f64, &f64)| match (*a, *b) {
            (0.0, 0.0) => 1.0,
            (0.0, _) => f32::INFINITY,
            (a, b) => (b / a) as f32,
        };
        let expected: Vec<u8> = pairs().flat_map(|pair| ratio(pair).to_ne_bytes()).collect();
        let ratios = &found.array(&format!("{name}_ratio")).bytes;
        assert!(*ratios == expected, "{name}_ratio");
    }
    assert_eq!(found.arrays.len(), 2 * arrays.len() + 5);
    for name in ["pixel_x", "pixel_y", "object", "tile"] {
        assert_eq!(found.array(name), b.array(name));
    }
}

#[test]
fn every_pixel_has_its_difference_and_its_ratio() {
    let folder = outputs(&["--cost=time"]);
    assert_success(&diff(folder.path(), &["a", "b"]));
    assert_differences(folder.path(), &[&["time_ns"][..], &COUNTERS].concat());
    // Swapped, there are visits only in the second output.
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

/// The pixels are read in bands of about a million.
#[test]
fn pixels_of_all_bands_have_their_differences() {
    let folder = outputs(&["--cost=counters", "--width=1600", "--height=701"]);
    assert_sums(folder.path(), [100 * 44, 4399], [[1584, 1599], [688, 700]]);
    assert_differences(folder.path(), &COUNTERS);
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
    assert_sums(folder.path(), [12, 11], [[48, 49], [32, 39]]);
}

/// Compares the sums, and the bounds of the last tile, given the number of tiles and its own.
fn assert_sums(folder: &Path, [n_tiles, last]: [usize; 2], bounds: [[u32; 2]; 2]) {
    let (found, code) = json_report(folder, &["a", "b"]);
    assert_eq!(code, Some(0));
    for side in ["a", "b"] {
        let summary = fs::read(folder.join(side).join("summary.json")).unwrap();
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
                let total = match name {
                    "depth" => costs.max(),
                    _ => Some(costs.sum()),
                };
                assert_eq!(
                    json!(total),
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
    assert_eq!(tiles.len(), n_tiles);
    let name = format!("tile {last}");
    let last = tiles.iter().find(|tile| tile["name"] == *name).unwrap();
    assert_eq!(json!([last["x"], last["y"]]), json!(bounds));
}

#[test]
fn light_is_compared_where_both_have_it() {
    let flags = ["--cost=counters", "--also=radiance"];
    let folder = outputs(&flags);
    let brighter = ["--cost=counters", "--also=radiance", "--exposure=2"];
    render(folder.path(), "b", SCENE, &brighter);
    let text = || String::from_utf8(diff(folder.path(), &["a", "b"]).stdout).unwrap();
    let (found, _) = json_report(folder.path(), &["a", "b"]);
    assert!(found["picture"]["n_pixels"].as_u64() > Some(100));
    let light = &found["light"];
    assert_eq!((&light["max"], &light["rms"]), (&json!(0.0), &json!(0.0)));
    let bytes = frame(folder.path().join("a"))
        .array("radiance")
        .bytes
        .clone();
    let channels = bytes
        .as_chunks()
        .0
        .iter()
        .map(|&bytes| f32::from_ne_bytes(bytes));
    let n = channels.len() as f64;
    let mean = channels.map(f64::from).sum::<f64>() / n;
    assert!((light["mean"][1].as_f64().unwrap() - mean).abs() < 1e-12 * mean);
    assert!(text().contains("\nlight     mean "), "{}", text());

    render(folder.path(), "b", SCENE, &["--cost=counters"]);
    let (found, _) = json_report(folder.path(), &["a", "b"]);
    assert_eq!(found["light"], json!(null));
    assert!(!text().contains("\nlight "), "{}", text());
}

#[test]
fn a_difference_of_the_pictures_is_counted() {
    let folder = outputs(&["--cost=counters"]);
    let moved = SCENE
        .replace("center: [0.5, ", "center: [0.6, ")
        .replace("0.2, 0.1]", "0.2, 0.2]");
    render(folder.path(), "b", &moved, &["--cost=counters"]);
    let (found, _) = json_report(folder.path(), &["a", "b"]);
    let [a, b] = ["a", "b"].map(|name| frame(folder.path().join(name)));
    let [rgb_a, rgb_b] = [&a, &b].map(|frame| frame.array("RGB").bytes.as_chunks::<3>().0);
    let difference = |(a, b): (&[u8; 3], &[u8; 3])| [0, 1, 2].map(|i| a[i].abs_diff(b[i]));
    let differences: Vec<[u8; 3]> = rgb_a.iter().zip(rgb_b).map(difference).collect();
    let n_pixels = differences
        .iter()
        .filter(|channels| **channels != [0; 3])
        .count();
    assert!(n_pixels > 100);
    assert_eq!(found["picture"]["n_pixels"], json!(n_pixels));
    assert_eq!(
        found["picture"]["max"],
        json!(differences.iter().flatten().max())
    );
    let written = DataSet::read(&folder.path().join("out/diff-a-b/diff.vti"));
    let by_pixel: Vec<u8> = differences
        .iter()
        .map(|channels| *channels.iter().max().unwrap())
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
