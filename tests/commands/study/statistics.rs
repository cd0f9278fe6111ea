//! Tables, plots and fitted laws report the runs.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::{STUDY, folder, lines, run};
use crate::common::assert_success;

/// Runs the study, replaces the times in its log, and repeats the command to update tables
/// and plots: measured times may all be 0 on a coarse clock.
fn run_with_given_times(folder: &Path) {
    assert_success(&run(folder, &[]));
    let mut lines = lines(folder);
    for (number, run) in lines[1..].iter_mut().enumerate() {
        for (metric, ms) in [("render_wall_ms", 1.0), ("render_cpu_ms", 2.0)] {
            run["metrics"][metric] = (ms + 0.1 * number as f64).into();
        }
    }
    let text: String = lines.iter().map(|line| format!("{line}\n")).collect();
    fs::write(folder.join("out/runs.jsonl"), &text).unwrap();
    assert_success(&run(folder, &[]));
    let kept = fs::read_to_string(folder.join("out/runs.jsonl")).unwrap();
    assert_eq!(kept, text, "no run is repeated");
}

#[test]
fn tables_and_plots_report_the_runs() {
    let folder = folder(STUDY);
    run_with_given_times(folder.path());
    let out = folder.path().join("out");
    let table = fs::read_to_string(out.join("statistics.csv")).unwrap();
    let mut rows = csv::Reader::from_reader(table.as_bytes());
    let headers = rows.headers().unwrap().clone();
    let column = |name: &str| headers.iter().position(|header| header == name).unwrap();
    let of_time: Vec<csv::StringRecord> = rows
        .records()
        .map(Result::unwrap)
        .filter(|row| &row[column("metric")] == "render_wall_ms")
        .collect();
    assert_eq!(of_time.len(), 4);
    let runs = lines(folder.path());
    for row in of_time {
        let [size, depth] = ["tile_size", "max_depth"].map(|name| row[column(name)].to_owned());
        let counts = |run: &&Value| {
            run["round"].as_u64() > Some(0)
                && run["point"]["tile_size"].as_u64() == size.parse().ok()
                && run["point"]["max_depth"].as_u64() == depth.parse().ok()
        };
        let measured = runs[1..].iter().filter(counts);
        let times: Vec<f64> = measured
            .map(|run| run["metrics"]["render_wall_ms"].as_f64().unwrap())
            .collect();
        assert_eq!((times.len(), &row[column("n")]), (3, "3"));
        let max: f64 = row[column("max")].parse().unwrap();
        assert_eq!(max, times.iter().copied().fold(0.0, f64::max));
    }
    for (plot, shown) in [
        ("plot-1-render_wall_ms-over-tile_size", "k = "),
        ("plot-2-rays-node_visits-over-n_pixels", "node visits"),
        ("plot-3-render_cpu_ms-over-scene", "tile size 8"),
    ] {
        let svg = fs::read_to_string(out.join(plot).with_extension("svg")).unwrap();
        assert!(svg.contains(shown), "{svg}");
        let png = image::open(out.join(plot).with_extension("png"))
            .unwrap()
            .to_rgb8();
        let n_drawn = png.pixels().filter(|pixel| pixel.0 != [255; 3]).count();
        assert!(n_drawn > 1000, "{n_drawn} pixels of {plot} are not white");
    }
}

/// Points with more threads than processors are marked in tables and plots and not fitted.
#[test]
fn more_threads_than_processors_are_marked() {
    let too_many = std::thread::available_parallelism().unwrap().get() + 1;
    let threads = format!("threads: [1, {too_many}]");
    let folder = folder(
        &STUDY
            .replace("tile_size: [4, 8], max_depth: [0, 3]", &threads)
            .replace("x: tile_size", "x: threads")
            .replace("repeats: 3", "repeats: 1"),
    );
    assert_success(&run(folder.path(), &[]));
    let out = folder.path().join("out");
    let text = fs::read_to_string(out.join("statistics.json")).unwrap();
    let statistics: Value = serde_json::from_str(&text).unwrap();
    let n_processors = statistics["made_by"]["machine"]["logical_cpus"].as_u64();
    for row in statistics["rows"].as_array().unwrap() {
        let expected = row["point"]["threads"].as_u64() > n_processors;
        assert_eq!(row["oversubscribed"], expected, "{row}");
    }
    assert_eq!(statistics["fits"], Value::Array(Vec::new()), "of one point");
    let table = fs::read_to_string(out.join("statistics.csv")).unwrap();
    assert!(table.contains(",true\n") && table.contains(",false\n"));
    let svg = fs::read_to_string(out.join("plot-1-render_wall_ms-over-threads.svg")).unwrap();
    assert!(svg.contains("more threads than"), "{svg}");
}

#[test]
fn statistics_hold_the_laws_of_the_plots() {
    let folder = folder(STUDY);
    run_with_given_times(folder.path());
    let text = fs::read_to_string(folder.path().join("out/statistics.json")).unwrap();
    let statistics: Value = serde_json::from_str(&text).unwrap();
    let fits = statistics["fits"].as_array().unwrap();
    // One law per depth, of the one plot with `fit`.
    assert_eq!(fits.len(), 2);
    let rows = statistics["rows"].as_array().unwrap();
    let median = |size: u64| {
        let is_it = |row: &&Value| {
            row["metric"] == "render_wall_ms"
                && row["point"]["tile_size"] == size
                && row["point"]["max_depth"] == 3
        };
        rows.iter().find(is_it).unwrap()["median"].as_f64().unwrap()
    };
    let fit = fits.iter().find(|fit| fit["series"] == "max depth 3");
    let fit = fit.unwrap_or_else(|| panic!("{fits:?}"));
    assert_eq!(
        (&fit["x"], &fit["y"][0]),
        (&"tile_size".into(), &"render_wall_ms".into())
    );
    let exponent = (median(8) / median(4)).log2();
    assert!((fit["law"]["exponent"].as_f64().unwrap() - exponent).abs() < 1e-9);
}
