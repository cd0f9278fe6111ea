//! The file and the messages of `raycost view`, without a browser.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::json;

use super::{rendered, rendered_at, viewed};
use crate::common::{assert_success, raycost};

/// The error message of `raycost view` for a folder that it refuses.
fn refusal(folder: &Path) -> String {
    let output = raycost().arg("view").arg(folder).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty() && !folder.join("view.html").exists());
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn the_same_rendering_gives_the_same_page() {
    let folder = rendered("seed_extended", &[]);
    let first = fs::read(viewed(folder.path())).unwrap();
    assert_eq!(first, fs::read(viewed(folder.path())).unwrap());
    // No temporary file is left behind.
    let names = fs::read_dir(folder.path()).unwrap();
    let names = names.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert!(names.into_iter().all(|name| !name.contains(".part")));
}

/// Returns the command that writes the page of an output folder.
fn view_to(page: &Path, folder: &Path) -> Command {
    let mut command = raycost();
    command.arg("view").arg(folder).arg("--out").arg(page);
    command
}

#[test]
fn out_sets_the_path_of_the_page() {
    let folder = rendered("seed_sphere", &[]);
    let page = folder.path().join("elsewhere.html");
    assert_success(&view_to(&page, folder.path()).output().unwrap());
    assert!(page.exists() && !folder.path().join("view.html").exists());
    // A folder in place of the page is a failure of the system, as with `render`.
    let in_the_way = raycost()
        .arg("view")
        .arg(folder.path())
        .arg("--out")
        .arg(folder.path())
        .output()
        .unwrap();
    assert_eq!(in_the_way.status.code(), Some(1));
}

#[test]
fn a_note_says_what_was_not_measured() {
    let folder = rendered("seed_sphere", &["--no-cost"]);
    let output = raycost().arg("view").arg(folder.path()).output().unwrap();
    assert_success(&output);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("note    Cost was not measured"), "{said}");
    assert!(said.contains("without `--no-cost`"), "{said}");
}

#[test]
fn a_folder_without_output_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    assert!(refusal(folder.path()).contains("holds no output"));
    assert!(refusal(&folder.path().join("nowhere")).contains("cannot read the folder"));
}

#[test]
fn a_damaged_output_is_refused() {
    let folder = rendered("seed_sphere", &[]);
    let frame = folder.path().join("frame.vti");
    let bytes = fs::read(&frame).unwrap();
    fs::write(&frame, &bytes[..bytes.len() / 2]).unwrap();
    assert!(refusal(folder.path()).contains("is truncated"));
    fs::remove_file(&frame).unwrap();
    assert!(refusal(folder.path()).contains("frame.vti` is missing"));
    fs::write(&frame, &bytes).unwrap();
    fs::write(folder.path().join("objects.csv"), "kind,id\nobject\n").unwrap();
    assert!(refusal(folder.path()).contains("objects.csv"));
}

#[test]
fn a_page_has_at_most_the_requested_size() {
    let folder = rendered_at([300, 200], "seed_extended", &["--cost", "counters"]);
    let page = folder.path().join("small.html");
    let view = |megabytes: &str| {
        let mut command = view_to(&page, folder.path());
        command.arg("--max-mb").arg(megabytes).output().unwrap()
    };
    let whole = fs::metadata(viewed(folder.path())).unwrap().len();
    assert!(whole > 400_000, "{whole}");
    for n_bytes in [390_000, 200_000, 120_000] {
        let output = view(&(f64::from(n_bytes) / 1e6).to_string());
        assert_success(&output);
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(
            said.contains("evenly spread; their values are exact"),
            "{said}"
        );
        let written = fs::metadata(&page).unwrap().len();
        let budget = u64::from(n_bytes as u32);
        // The page uses most of the budget.
        assert!(
            written <= budget && written > budget * 3 / 4,
            "{written} of {budget}"
        );
    }
    // A sufficient budget changes nothing.
    assert_success(&view("10"));
    assert_eq!(fs::metadata(&page).unwrap().len(), whole);

    fs::remove_file(&page).unwrap();
    let output = view("0.02");
    assert_eq!(output.status.code(), Some(2));
    assert!(!page.exists());
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        said.contains("no page of this output has at most 20 kB"),
        "{said}"
    );
    let (_, advised) = said.split_once("give `--max-mb ").unwrap();
    assert_success(&view(advised.split_once('`').unwrap().0));
    for wrong in ["0", "-1", "much", "NaN"] {
        let output = view(wrong);
        assert_eq!(output.status.code(), Some(2), "{wrong}");
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.contains("expected a number above 0"), "{said}");
    }
}

/// The JSON that the page's script reads.
fn about(folder: &Path) -> serde_json::Value {
    let page = fs::read_to_string(viewed(folder)).unwrap();
    let (_, about) = page.split_once("id=\"about\">").unwrap();
    serde_json::from_str(about.split_once("</script>").unwrap().0).unwrap()
}

/// A trace needs no window: pixels have their places in the picture.
#[test]
fn a_window_is_shown_at_its_place() {
    let flags = ["--cost=counters", "--crop=9,4,20,15"];
    let folder = rendered("seed_extended", &flags);
    let about = about(folder.path());
    assert_eq!(about["origin"], json!([9, 4]));
    assert_eq!(about["full_size"], json!([20, 15]));
    assert_eq!(about["facts"][0], "20 × 15 pixels at 9, 4 of 40 × 30");
    let pixel = &about["hottest"][0]["pixels"][0];
    let index = pixel["index"].as_u64().unwrap();
    let [x, y] = [9 + index % 20, 4 + index / 20];
    assert_eq!((&pixel["x"], &pixel["y"]), (&json!(x), &json!(y)));
    let command = format!(
        "{} --pixel {x},{y} --json",
        about["trace"].as_str().unwrap()
    );
    let mut words = command.split(' ');
    assert_eq!(words.next(), Some("raycost"));
    let traced = raycost()
        .args(words)
        .arg("--out")
        .arg(folder.path())
        .output()
        .unwrap();
    assert_success(&traced);
    let traced: serde_json::Value = serde_json::from_slice(&traced.stdout).unwrap();
    let visits = traced["rays"].as_array().unwrap().iter();
    let visits: u64 = visits.filter_map(|ray| ray["node_visits"].as_u64()).sum();
    assert_eq!(pixel["value"].as_f64(), Some(visits as f64));
}

#[test]
fn the_most_expensive_pixels_are_those_of_a_trace() {
    for flags in [
        &["--cost=counters"][..],
        &["--repeats=1"],
        &[],
        &["--no-cost"],
    ] {
        let folder = rendered("seed_extended", flags);
        let about = about(folder.path());
        let hottest = about["hottest"].as_array().unwrap();
        let of = |array: &str| hottest.iter().find(|one| one["array"] == array);
        assert_eq!(of("node_visits").is_some(), flags != ["--no-cost"]);
        if flags.contains(&"--cost=counters") {
            assert!(of("time_ns").is_none());
        }
        let Some(visits) = of("node_visits") else {
            continue;
        };
        let output = raycost()
            .arg("trace")
            .arg(crate::common::in_repository("configs/seed_extended.yaml"))
            .args([
                "--width=40",
                "--height=30",
                "--hottest=3",
                "--by=node_visits",
            ])
            .arg("--out")
            .arg(folder.path())
            .output()
            .unwrap();
        assert_success(&output);
        let said = String::from_utf8(output.stdout).unwrap();
        for pixel in visits["pixels"].as_array().unwrap() {
            let (x, y, value) = (&pixel["x"], &pixel["y"], &pixel["value"]);
            let named = format!("{x},{y} ({} node visits)", value.as_f64().unwrap());
            assert!(said.contains(&named), "{named}: {said}");
        }
        let trace = about["trace"].as_str().unwrap();
        assert!(
            trace.ends_with(" --width 40 --height 30 --spp 1 --seed 0"),
            "{trace}"
        );
    }
}
