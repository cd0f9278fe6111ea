//! The metrics that a scene defines are in all files, and in the tools that read them.

use std::fs;
use std::path::Path;
use std::process::Output;

use crate::common::data_set::DataSet;
use crate::common::{assert_success, in_repository, raycost};

const DEFINITIONS: &str = "metrics={ tests_per_ray: primitive_tests / rays, \
                           hit_share: primitive_hits/primitive_tests }";

fn render(out: &Path, flags: &[&str]) -> Output {
    let mut command = raycost();
    command.arg("render");
    command.arg(in_repository("configs/blocks.yaml"));
    command.args(["--quiet", "--width=40", "--height=30", "--spp=1"]);
    command.arg("--out").arg(out).args(flags).output().unwrap()
}

/// Returns the numbers of an array.
fn numbers<const N: usize, T>(set: &DataSet, name: &str, from: fn([u8; N]) -> T) -> Vec<T> {
    let array = set.arrays.iter().find(|array| array.name == name).unwrap();
    let (numbers, _) = array.bytes.as_chunks();
    numbers.iter().map(|bytes| from(*bytes)).collect()
}

fn text(folder: &Path, file: &str) -> String {
    fs::read_to_string(folder.join(file)).unwrap()
}

#[test]
fn ratios_are_in_files_states_pages_and_diffs() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = ["a", "b"].map(|name| folder.path().join(name));
    let flags = ["--also=tests", "--cost=counters", "--set", DEFINITIONS];
    assert_success(&render(&a, &flags));
    let with = |structure| [&flags[..], &["--acceleration", structure]].concat();
    assert_success(&render(&b, &with("brute_force")));

    let frame = DataSet::read(&a.join("frame.vti"));
    let counts = |name| numbers(&frame, name, u32::from_ne_bytes);
    for (ratio, above, below) in [
        ("tests_per_ray", "primitive_tests", "rays"),
        ("hit_share", "primitive_hits", "primitive_tests"),
    ] {
        let expected = counts(above).into_iter().zip(counts(below));
        let expected = expected.map(|(a, b)| if b == 0 { 0.0 } else { a as f32 / b as f32 });
        let found = numbers(&frame, ratio, f32::from_ne_bytes);
        assert!(found.iter().copied().eq(expected), "{ratio}");
        assert!(found.iter().any(|&value| value > 0.0));
    }

    let summary: serde_json::Value = serde_json::from_str(&text(&a, "summary.json")).unwrap();
    let cost = &summary["cost"];
    assert_eq!(cost["metrics"]["tests_per_ray"], "primitive_tests / rays");
    let total = |name: &str| cost["totals"][name].as_f64().unwrap();
    assert_eq!(
        total("tests_per_ray"),
        total("primitive_tests") / total("rays")
    );

    // The first metrics that files show are the scene's.
    let heatmap = text(&a, "heatmap.pvsm");
    for shown in ["tests_per_ray", "hit_share", "Tests per ray", "Hit share"] {
        assert!(heatmap.contains(shown), "{shown}");
    }
    let page = folder.path().join("page.html");
    let mut view = raycost();
    view.arg("view").arg(&a).arg("--out").arg(&page);
    assert_success(&view.output().unwrap());
    let page = fs::read_to_string(page).unwrap();
    assert!(page.contains(r#""label":"Tests per ray","about":"primitive_tests / rays""#));

    let mut diff = raycost();
    diff.arg("diff").args([&a, &b]).arg("--json");
    let output = diff.output().unwrap();
    assert_success(&output);
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let ratio = &found["totals"]["tests_per_ray"];
    assert_eq!(ratio["a"], total("tests_per_ray"));
    assert_ne!(ratio["b"], ratio["a"]);
}

#[test]
fn a_picture_by_itself_needs_no_metrics() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("picture.png");
    let mut command = raycost();
    command
        .arg("render")
        .arg(in_repository("configs/blocks.yaml"));
    command.args(["--quiet", "--width=40", "--height=30", "--set", DEFINITIONS]);
    assert_success(&command.arg("-o").arg(picture).output().unwrap());
}
