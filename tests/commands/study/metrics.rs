//! The list of metrics names those of runs, and no others stand in plots.

use std::collections::BTreeSet;
use std::fs;

use tools::study::StudyMetric;

use super::{STUDY, folder, lines, run, stderr_of};
use crate::common::{assert_success, raycost};

/// The names of all metrics.
fn names() -> BTreeSet<String> {
    let all = StudyMetric::all();
    let names: BTreeSet<String> = all.iter().map(|metric| metric.name.clone()).collect();
    assert_eq!(names.len(), all.len(), "a name is there twice");
    names
}

#[test]
fn every_metric_of_a_run_is_listed() {
    let all = "--also=schedule,objects,surface,bvh,exr";
    let study = STUDY
        .replace(
            "vary: { tile_size: [4, 8], max_depth: [0, 3] }",
            "vary: { cost: [time, single_ray_time], threads: [1] }",
        )
        .replace("x: tile_size", "x: threads")
        .replace(
            "--height=9",
            &format!("--height=9, --tile-order=cost, '{all}'"),
        );
    let folder = folder(&study);
    assert_success(&run(folder.path(), &["--quick"]));
    let runs = lines(folder.path());
    let metrics = runs[1..]
        .iter()
        .flat_map(|run| run["metrics"].as_object().unwrap().keys());
    let found: BTreeSet<String> = metrics.cloned().collect();
    let listed = names();
    let unlisted: Vec<&String> = found.difference(&listed).collect();
    assert!(unlisted.is_empty(), "{unlisted:?}");
}

#[test]
fn wrong_names_in_plots_are_shown_at_their_lines() {
    let expected = "error: there is no metric `render_wal_ms`
 --> study.yaml:4:28
  |
4 | plots: [{ x: tile_size, y: render_wal_ms }]
  |                            ^^^^^^^^^^^^^ expected a metric
  |
  = help: did you mean `render_wall_ms`? (`raycost study --list-metrics` lists the metrics)
";
    let plot = "{ x: tile_size, y: render_wal_ms }";
    let study =
        format!("title: x\nscenes: [scene.yaml]\nvary: {{ tile_size: [4] }}\nplots: [{plot}]\n");
    let of_wrong_metric = folder(&study);
    let refused = run(of_wrong_metric.path(), &[]);
    assert_eq!(refused.status.code(), Some(2), "{plot}");
    assert_eq!(stderr_of(&refused), expected);
    assert!(!of_wrong_metric.path().join("out").exists());
    for (plot, expected) in [
        ("{ x: tile_siz, y: rays }", "did you mean `tile_size`?"),
        (
            "{ x: threads, y: rays }",
            "this study does not vary `threads`",
        ),
        (
            "{ x: scene, y: [rays, tile_size] }",
            "`tile_size` is a factor, not a metric",
        ),
        (
            "{ x: scene, y: rays, by: [tile_sise] }",
            "did you mean `tile_size`?",
        ),
        (
            "{ x: scene, y: rays, by: [rays] }",
            "there is no factor `rays`",
        ),
        (
            "{ x: scene, y: speedup }",
            "varies no `threads` or `ranks`, which `speedup` needs",
        ),
        (
            "{ x: scene, y: measuring_overhead }",
            "varies no `cost`, which `measuring_overhead` needs",
        ),
        (
            "{ x: scene, y: load_balance }",
            "varies no `ranks`, which `load_balance` needs",
        ),
    ] {
        let study = format!(
            "title: x\nscenes: [scene.yaml]\nvary: {{ tile_size: [4] }}\nplots: [{plot}]\n"
        );
        let folder = folder(&study);
        let refused = run(folder.path(), &[]);
        assert_eq!(refused.status.code(), Some(2), "{plot}");
        let message = stderr_of(&refused);
        assert!(message.contains(expected), "{message}");
        assert!(
            message.contains("--> study.yaml:4:") && message.contains("= help"),
            "{message}"
        );
    }
}

/// Each with its unit and a meaning.
#[test]
fn metrics_are_listed_on_request() {
    let output = raycost()
        .args(["study", "--list-metrics"])
        .output()
        .unwrap();
    assert_success(&output);
    let list = String::from_utf8(output.stdout).unwrap();
    for metric in StudyMetric::all() {
        assert!(
            !metric.unit.is_empty() && !metric.about.is_empty(),
            "{}",
            metric.name
        );
    }
    for line in [
        "render_share              1       share of the stage `render` in the wall time of all stages",
        "node_visits               count   sum over all pixels: BVH nodes visited by all rays of the pixel",
        "STAGE_wall_ms             ms      wall time",
        "FILE_bytes                bytes   length",
    ] {
        assert!(list.lines().any(|found| found == line), "{line}\n{list}");
    }
}

#[test]
fn an_overhead_needs_points_to_compare() {
    let plots = [
        "{ x: scene, y: [rays, measuring_overhead] }",
        "{ x: measuring_overhead, y: rays }",
    ];
    for (levels, plot) in [
        ("vary: { cost: [counters, time] }", plots[0]),
        ("vary: { cost: [none] }", plots[0]),
        ("vary: { cost: [counters, time] }", plots[1]),
        (
            "cases: [{ cost: none, tile_size: 4 }, { cost: time, tile_size: 8 }]",
            plots[0],
        ),
    ] {
        let study = format!("title: x\nscenes: [scene.yaml]\n{levels}\nplots: [{plot}]\n");
        let refused = run(folder(&study).path(), &[]);
        let message = stderr_of(&refused);
        assert_eq!(refused.status.code(), Some(2), "{message}");
        for part in [
            "error: `measuring_overhead` compares points with and without measurement\n",
            "--> study.yaml:4:",
            "^ has no values here",
            "= help: add `none` and another mode to `cost`",
        ] {
            assert!(message.contains(part), "{part}: {message}");
        }
    }
}

#[test]
fn a_study_of_cost_reports_what_each_mode_adds() {
    let factors = "vary: { tile_size: [4, 8], max_depth: [0, 3] }";
    let study = STUDY.replace(factors, "vary: { cost: [none, time], tile_size: [8] }");
    let folder = folder(&study);
    let output = run(folder.path(), &["--quick"]);
    assert_success(&output);
    let report = String::from_utf8(output.stdout).unwrap();
    assert_eq!(report.matches("\nmeasure ").count(), 1, "{report}");
    assert!(report.contains("cost time"), "{report}");
    let table = fs::read_to_string(folder.path().join("out/statistics.csv")).unwrap();
    assert_eq!(table.matches(",measuring_overhead,").count(), 1, "{table}");
}

/// A metric that a machine does not have gives a note in place of a plot.
#[test]
fn a_plot_without_values_is_named() {
    let folder = folder(&STUDY.replace("y: render_cpu_ms", "y: survey_wall_ms"));
    let output = run(folder.path(), &["--quick"]);
    assert_success(&output);
    let report = String::from_utf8(output.stdout).unwrap();
    assert!(
        report.contains("plot 3 has no values: no run has"),
        "{report}"
    );
    let heading = report.lines().nth(2).unwrap();
    assert!(
        heading.starts_with("point") && heading.contains("95 % interval"),
        "{report}"
    );
    assert!(fs::read_dir(folder.path().join("out")).unwrap().count() > 4);
}
