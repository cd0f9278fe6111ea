//! The counters that the course tells its students to expect are those of the program.

use std::fs;
use std::process::Command;

use output::results::Results;

use crate::common::in_repository;

/// An expectation reads `blocks --width=400 --spp=1: rays 288144`, or of a share `idle_lanes 51.8%`.
#[test]
fn the_expected_counters_are_counted() {
    let page = fs::read_to_string(in_repository("docs/course.md")).unwrap();
    let expected = page.split("<!-- expect: ").skip(1);
    let mut n_expected = 0;
    for expectation in expected.map(|rest| rest.split_once(" -->").unwrap().0) {
        let (command, counter) = expectation.split_once(": ").unwrap();
        let (scene, flags) = command.split_once(' ').unwrap();
        let (name, value) = counter.split_once(' ').unwrap();
        let folder = tempfile::tempdir().unwrap();
        let status = Command::new(env!("CARGO_BIN_EXE_raycost"))
            .arg("render")
            .arg(in_repository(&format!("configs/{scene}.yaml")))
            .args(flags.split(' '))
            .args(["--quiet", "--cost=counters", "--out"])
            .arg(folder.path())
            .status()
            .unwrap();
        assert!(status.success(), "{expectation}");
        let results = Results::open(folder.path()).unwrap();
        let totals = serde_json::to_value(&results.summary.cost.totals).unwrap();
        let (found, shown) = match value.strip_suffix('%') {
            None => (totals[name].to_string(), grouped(value)),
            Some(percent) => {
                let share = totals[name].as_f64().unwrap();
                (format!("{:.1}%", 100.0 * share), format!("{percent} %"))
            }
        };
        assert_eq!(found, value, "{expectation}");
        assert!(page.contains(&shown), "{value} is not in the text");
        n_expected += 1;
    }
    assert!(n_expected > 5, "{n_expected}");
}

/// Digits in groups of three: `12,345`.
fn grouped(digits: &str) -> String {
    let groups: Vec<&[u8]> = digits.as_bytes().rchunks(3).rev().collect();
    let groups: Vec<&str> = groups
        .iter()
        .map(|group| std::str::from_utf8(group).unwrap())
        .collect();
    groups.join(",")
}
