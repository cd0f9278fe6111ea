//! Output folders that differ in nothing but times and threads.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::data_set::{Array, DataSet};
use super::names;

/// Whether an array differs from run to run.
fn is_timed(array: &Array) -> bool {
    array.name.contains("time_") || array.name == "thread"
}

/// The arrays of an output that do not differ, and the names of those that do.
fn arrays(out: &Path, file: &str) -> (Vec<(String, Vec<u8>)>, Vec<String>) {
    let data = DataSet::read(&out.join(file));
    let (timed, same): (Vec<Array>, Vec<Array>) = data.arrays.into_iter().partition(is_timed);
    let same = same.into_iter().map(|array| (array.name, array.bytes));
    (
        same.collect(),
        timed.into_iter().map(|array| array.name).collect(),
    )
}

/// The contents of `summary.json`.
pub fn summary(out: &Path) -> Value {
    serde_json::from_slice(&fs::read(out.join("summary.json")).unwrap()).unwrap()
}

/// The sums of the counters.
fn totals(out: &Path) -> Value {
    let mut totals = summary(out)["cost"]["totals"].take();
    if let Some(totals) = totals.as_object_mut() {
        totals.retain(|name, _| !name.contains("time"));
    }
    totals
}

/// Checks that two outputs differ in nothing but times and threads.
pub fn assert_same_output(one: &Path, other: &Path) {
    assert_eq!(
        names(one).len() + usize::from(other.join("parts").exists()),
        names(other).len()
    );
    for file in ["frame.vti", "hits.vtu"] {
        let [found, expected] = [other, one].map(|out| arrays(out, file));
        assert_eq!(found.1, expected.1);
        for ((name, bytes), (expected_name, expected)) in found.0.iter().zip(&expected.0) {
            assert_eq!(name, expected_name);
            assert!(bytes == expected, "{file}: {name} differs");
        }
        assert_eq!(found.0.len(), expected.0.len());
    }
    let pixels = |out: &Path| {
        image::open(out.join("image.png"))
            .unwrap()
            .into_rgb8()
            .into_raw()
    };
    assert!(pixels(one) == pixels(other));
    assert_eq!(totals(one), totals(other));
    if one.join("objects.csv").exists()
        && !fs::read_to_string(one.join("objects.csv"))
            .unwrap()
            .contains("time")
    {
        assert_eq!(
            fs::read(one.join("objects.csv")).unwrap(),
            fs::read(other.join("objects.csv")).unwrap()
        );
    }
}
