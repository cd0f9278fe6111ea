//! The steps of a study add up, make one picture, and are left out where they cannot be made.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::{folder, lines, run, stderr_of};
use crate::common::{assert_success, in_repository};

const STEPS: &str = "
title: A small ladder
scenes: [scene.yaml]
steps:
  - name: plain
    set: { acceleration: brute_force, simd: portable, traversal: single, threads: 1, cost: counters }
  - { name: tree, set: { acceleration: fast } }
  - { name: the same, set: { acceleration: fast } }
  - { name: streams, set: { traversal: stream, device: processor } }
flags: [--width=12, --height=9]
repeats: 2
plots:
  - { x: step, y: render_wall_ms, bars: true }
  - { x: step, y: speedup_over_start }
";

/// The statistics of a metric by step.
fn medians(folder: &Path, metric: &str) -> Vec<(String, f64)> {
    let text = fs::read_to_string(folder.join("out/statistics.json")).unwrap();
    let all: Value = serde_json::from_str(&text).unwrap();
    let rows = all["rows"].as_array().unwrap().iter();
    let rows = rows.filter(|row| row["metric"] == metric);
    let median = |row: &Value| {
        let step = row["point"]["step"].as_str().unwrap().to_owned();
        (step, row["median"].as_f64().unwrap())
    };
    rows.map(median).collect()
}

#[test]
fn settings_of_steps_add_up() {
    let folder = folder(STEPS);
    let output = run(folder.path(), &[]);
    assert_success(&output);
    let report = String::from_utf8(output.stdout).unwrap();
    let idle = "note    `the same` is left out: changes nothing on this machine";
    assert!(report.contains(idle), "{report}");
    assert!(report.contains("step     render time"), "{report}");

    let runs = lines(folder.path());
    assert_eq!(runs.len(), 1 + 3 * (1 + 2));
    let settings = |step: &str| {
        let mut points = runs[1..].iter().map(|run| &run["point"]);
        points.find(|point| point["step"] == step).unwrap()["settings"].clone()
    };
    let of_streams = "acceleration fast, simd portable, traversal stream, threads 1, cost counters, \
                      device processor";
    assert_eq!(settings("streams"), of_streams);

    // Only brute force visits no nodes.
    let visits = medians(folder.path(), "node_visits");
    let visited: Vec<&str> = visits
        .iter()
        .filter(|(_, n)| *n > 0.0)
        .map(|(step, _)| &**step)
        .collect();
    assert_eq!(visited, ["tree", "streams"]);
    let speedups = medians(folder.path(), "speedup_over_start");
    let faster: Vec<&str> = speedups.iter().map(|(step, _)| &**step).collect();
    assert_eq!(faster, ["tree", "streams"]);
    let differences = medians(folder.path(), "picture_difference");
    assert_eq!(differences.len(), 3);
    assert!(differences.iter().all(|(_, difference)| *difference == 0.0));

    let plot = folder
        .path()
        .join("out/plot-1-render_wall_ms-over-step.svg");
    let svg = fs::read_to_string(plot).unwrap();
    assert!(
        svg.contains("streams") && svg.contains(" x in all"),
        "{svg}"
    );
}

/// A speedup is the ratio of the runs of one round.
#[test]
fn speedups_compare_runs_of_one_round() {
    let folder = folder(&STEPS.replace("repeats: 2", "repeats: 1"));
    assert_success(&run(folder.path(), &[]));
    let times = medians(folder.path(), "render_wall_ms");
    let speedups = medians(folder.path(), "speedup_over_step");
    for (number, (_, speedup)) in speedups.iter().enumerate() {
        let expected = times[number].1 / times[number + 1].1;
        assert!((speedup - expected).abs() < 1e-9 * expected);
    }
}

#[test]
#[cfg(unix)]
fn another_program_is_a_step_that_has_to_be_allowed() {
    let first = "steps:\n  - { name: other, command: \"sh other.sh {scene} {image} {flags}\" }";
    let folder = folder(&STEPS.replace("steps:", first));
    let script = folder.path().join("other.sh");
    let picture = in_repository("docs/images/seed_extended.png");
    let script_of = |last: &str| {
        format!(
            "test \"$1 $3 $4\" = 'scene.yaml --width=12 --height=9' || exit 1\n\
             cp '{}' \"$2\"\necho render_wall_ms 5000\necho rays 7\necho nothing 8\n{last}\n",
            picture.display()
        )
    };

    let output = run(folder.path(), &[]);
    assert_success(&output);
    let report = String::from_utf8(output.stdout).unwrap();
    let reason = "`other` is left out: starts another program, which needs `--allow-commands`";
    assert!(report.contains(reason), "{report}");

    fs::write(&script, script_of("echo it broke >&2; exit 3")).unwrap();
    let output = run(folder.path(), &["--allow-commands"]);
    assert_success(&output);
    let report = String::from_utf8(output.stdout).unwrap();
    let reason = "`other` is left out: its command failed, exit status: 3: it broke";
    assert!(report.contains(reason), "{report}");

    // The runs of the other steps are there already.
    fs::write(&script, script_of("")).unwrap();
    assert_success(&run(folder.path(), &["--allow-commands"]));
    assert_eq!(lines(folder.path()).len(), 1 + 4 * (1 + 2));
    assert_eq!(
        medians(folder.path(), "render_wall_ms")[0],
        ("other".to_owned(), 5000.0)
    );
    assert_eq!(medians(folder.path(), "rays")[0].1, 7.0);
    let (step, speedup) = medians(folder.path(), "speedup_over_start").remove(0);
    assert!(step == "plain" && speedup > 1.0);
    // A picture of another size has no difference.
    assert_eq!(medians(folder.path(), "picture_difference").len(), 3);
}

#[test]
fn mistakes_of_steps_are_shown_at_their_lines() {
    let head = "title: x\nscenes: [scene.yaml]\n";
    for (lines, expected) in [
        (
            "steps: [{ name: a, set: { threads: 1 } }]\nvary: { threads: [1] }",
            "error: a study with `steps` has no `vary`
 --> study.yaml:4:1
  |
4 | vary: { threads: [1] }
  | ^^^^ would multiply the steps
  |
  = help: leave one of the two out
",
        ),
        (
            "steps: [{ name: a }]",
            "error: a step needs `set` or `command`
 --> study.yaml:3:9
  |
3 | steps: [{ name: a }]
  |         ^^^^^^^^^^^ expected one of the two
",
        ),
        (
            "steps: [{ name: a, command: 'run {file}' }]",
            "error: `command` must name a program, and have no braces but `{scene}`, `{image}` and `{flags}`
 --> study.yaml:3:29
  |
3 | steps: [{ name: a, command: 'run {file}' }]
  |                             ^^^^^^^^^^^^ expected a command such as `python loop.py {scene} {image}`
",
        ),
        (
            "steps: [{ name: a, set: { ranks: 2 } }]",
            "error: `ranks` need a `launcher`
 --> study.yaml:3:8
  |
3 | steps: [{ name: a, set: { ranks: 2 } }]
  |        ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^ one is there without the other
  |
  = help: add `launcher: \"mpirun -n {ranks}\"`
",
        ),
        (
            "steps: [{ name: a, set: { threads: most } }]",
            "error: `steps[0].set.threads` cannot be the text \"most\"
 --> study.yaml:3:36
  |
3 | steps: [{ name: a, set: { threads: most } }]
  |                                    ^^^^ expected `all` or a whole number from 1 to 1024
",
        ),
        (
            "plots: [{ x: scene, y: speedup_over_step }]",
            "error: the study has no `steps`, which `speedup_over_step` needs
 --> study.yaml:3:24
  |
3 | plots: [{ x: scene, y: speedup_over_step }]
  |                        ^^^^^^^^^^^^^^^^^ has no values here
  |
  = help: add `steps` to the study
",
        ),
    ] {
        let folder = folder(&format!("{head}{lines}\n"));
        let refused = run(folder.path(), &[]);
        assert_eq!(refused.status.code(), Some(2), "{lines}");
        assert_eq!(stderr_of(&refused), expected);
    }
    let twice = "steps: [{ name: a, set: { threads: 1 } }, { name: a, set: { threads: 2 } }]";
    let folder = folder(&format!("{head}{twice}\n"));
    let message = stderr_of(&run(folder.path(), &[]));
    assert!(message.contains("`steps` has an item twice"), "{message}");
}
