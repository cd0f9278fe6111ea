//! The test of the times, and the gate of `--fail-above`.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use super::{diff, error, json_report, outputs};
use crate::common::assert_success;

/// Sets the times of the repeats in the summary of an output.
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

/// The sums of the pixels' times give another ratio than the repeats: every report shows
/// the ratio that belongs to the confidence interval.
#[test]
fn the_ratio_of_the_time_lies_within_its_interval() {
    let folder = outputs(&[]);
    for seed in 0..4 {
        let times = |salt: u64| -> Value {
            let time = |i: u64| {
                let [u, ..] = math::sampling::uniform([seed, salt, i]);
                f64::from(u).mul_add(3e8, 1e9)
            };
            (0..4 + seed + salt).map(time).collect()
        };
        repeat(&folder.path().join("a"), &times(0));
        repeat(&folder.path().join("b"), &times(1));
        let (found, _) = json_report(folder.path(), &["a", "b"]);
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
fn the_gate_fails_only_a_significantly_higher_time() {
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
        // Above the limit, but not significantly.
        (1.051e9, "5%", "slower", 0),
        (1.08e9, "5%", "slower", 3),
        (1.08e9, "12.5 %", "slower", 0),
        (0.5e9, "5%", "faster", 0),
    ] {
        repeat(&folder.path().join("b"), &times(center));
        let (found, found_code) = json_report(folder.path(), &["a", "b", "--fail-above", limit]);
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
    // The report and the files are written nevertheless.
    assert!(!output.stdout.is_empty());
    assert!(folder.path().join("out/diff-a-b/diff.vti").exists());
}

#[test]
fn the_gate_is_exact_for_counters() {
    let folder = outputs(&["--cost=counters"]);
    let (found, _) = json_report(folder.path(), &["a", "b"]);
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
            json_report(folder.path(), &["a", "b", "--fail-above", &limit]).1,
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
fn the_report_tests_the_time_only_with_repeats() {
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
