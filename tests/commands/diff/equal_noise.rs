//! The work that two renderings take for equal noise.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::values::{frame, numbers};
use super::{SCENE, diff, json_report, render};
use crate::common::raycost;

const NOISE: [&str; 3] = [
    "--also=noise",
    "--cost=counters",
    "--set=image.sampler=sobol",
];

/// Renders the scene with noise, and with these flags.
fn render_noise(folder: &Path, name: &str, flags: &[&str]) {
    render(folder, name, SCENE, &[&NOISE, flags].concat());
}

/// The share of A's work, as JSON.
fn share(folder: &Path, [a, b]: [&str; 2]) -> Value {
    let (found, _) = json_report(folder, &[a, b]);
    found["equal_noise"]["work"].clone()
}

/// The sums of the variances and of the work of a rendering.
fn sums(folder: &Path, name: &str) -> [f64; 2] {
    let frame = frame(folder.join(name));
    let sum = |array: &str| numbers(frame.array(array)).iter().sum::<f64>();
    let noise = numbers(frame.array("noise"));
    let variance = noise.iter().map(|noise| noise * noise).sum();
    [variance, sum("node_visits") + sum("primitive_tests")]
}

#[test]
fn the_share_is_the_ratio_of_variance_times_work() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    render_noise(folder, "a", &["--spp=16"]);
    render_noise(folder, "b", &["--spp=4"]);
    render(folder, "plain", SCENE, &["--spp=4", "--cost=counters"]);
    let [a, b] = ["a", "b"].map(|name| sums(folder, name));
    let expected = b[0] * b[1] / (a[0] * a[1]);
    let found = share(folder, ["a", "b"]).as_f64().unwrap();
    assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    assert_eq!(share(folder, ["a", "plain"]), Value::Null);
    let text = String::from_utf8(diff(folder, &["a", "b"]).stdout).unwrap();
    let line = format!("work      B has the noise of A for {:.1} %", 100.0 * found);
    assert!(text.contains(&line), "{text}");
}

#[test]
fn only_pixels_that_both_rendered_count() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let flags = ["--spp=64", "--tile-size=4", "--threads=1"];
    render_noise(folder, "a", &flags);
    render_noise(
        folder,
        "window",
        &[&flags[..], &["--crop=13,7,20,15"]].concat(),
    );
    assert_eq!(share(folder, ["a", "window"]), 1.0);
    // A part of the picture, as soon as the time suffices for a tile.
    let share_in = |ms: u32| {
        let limit = format!("--timeout={ms}ms");
        let mut command = raycost();
        let command = command.args(["render", "a.yaml", "--quiet", "--out=part", &limit]);
        let output = command.args(NOISE).args(flags).current_dir(folder).output();
        assert!([Some(0), Some(4)].contains(&output.unwrap().status.code()));
        let share = share(folder, ["a", "part"]);
        fs::remove_dir_all(folder.join("part")).unwrap();
        share
    };
    let mut shares = (0..16).map(|power| share_in(1 << power));
    assert_eq!(shares.find(|share| !share.is_null()), Some(1.0.into()));
}

#[test]
fn a_partial_picture_is_called_so_and_passes_no_gate() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let flags = ["--spp=64", "--tile-size=4", "--threads=1"];
    render_noise(folder, "a", &flags);
    let mut command = raycost();
    let command = command.args(["render", "a.yaml", "--quiet", "--out=part", "--timeout=1ms"]);
    let output = command
        .args(NOISE)
        .args(["--spp=65536"])
        .current_dir(folder)
        .output();
    assert_eq!(output.unwrap().status.code(), Some(4));
    let report = String::from_utf8(diff(folder, &["a", "part"]).stdout).unwrap();
    assert!(report.contains(", partial: "), "{report}");
    let output = diff(folder, &["a", "part", "--fail-above=0%"]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(
        message.contains("`part` cannot pass or fail: partial"),
        "{message}"
    );
}
