//! Studies measure what they say, once, and go on where they were stopped.

use std::fs;
use std::path::Path;
use std::process::Output;

use crate::common::{assert_success, in_repository, raycost};
use raycost::study::StudyPlan;
use raycost::yaml::Source;
use serde_json::Value;

const STUDY: &str = "
title: A small study
scenes: [scene.yaml]
vary: { tile_size: [4, 8], max_depth: [0, 3] }
flags: [--width=12, --height=9]
repeats: 3
plots:
  - { x: tile_size, y: render_wall_ms, fit: true }
  - { x: n_pixels, y: [rays, node_visits], scale: linear }
  - { x: scene, y: render_cpu_ms }
";

/// A folder with a study and its scene.
fn folder(study: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("study.yaml"), study).unwrap();
    let scene = in_repository("configs/hall_of_mirrors.yaml");
    fs::copy(scene, folder.path().join("scene.yaml")).unwrap();
    folder
}

fn run(folder: &Path, flags: &[&str]) -> Output {
    let mut command = raycost();
    command.current_dir(folder).args(["study", "study.yaml"]);
    command.args(["--out", "out"]).args(flags).output().unwrap()
}

fn lines(folder: &Path) -> Vec<Value> {
    let text = fs::read_to_string(folder.join("out/runs.jsonl")).unwrap();
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs the study, gives its runs times as no clock measured them, and has it
/// make its tables and plots anew: measured ones may all be 0 on a coarse clock.
fn run_with_made_up_times(folder: &Path) {
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
    assert_eq!(kept, text, "no run is made again");
}

#[test]
fn every_point_is_measured_in_every_round() {
    let folder = folder(STUDY);
    assert_success(&run(folder.path(), &[]));
    let lines = lines(folder.path());
    assert_eq!(lines.len(), 1 + 4 * (1 + 3));
    for round in lines[1..].chunks(4) {
        let mut points: Vec<String> = round.iter().map(|run| run["point"].to_string()).collect();
        points.sort();
        points.dedup();
        assert_eq!(points.len(), 4);
        assert!(round.iter().all(|run| run["round"] == round[0]["round"]));
    }
    // Each run is of its point.
    for run in &lines[1..] {
        let [depth, mirrored] = [
            &run["point"]["max_depth"],
            &run["metrics"]["reflection_rays"],
        ];
        assert_eq!(depth == 0, *mirrored == 0.0, "{run}");
        assert_eq!(run["metrics"]["n_pixels"], 108.0);
    }
    let shuffled = |round: usize| {
        lines[1 + 4 * round..]
            .iter()
            .take(4)
            .map(|run| &run["point"])
    };
    assert!(
        (1..4).any(|round| !shuffled(0).eq(shuffled(round))),
        "each round has its order"
    );
}

#[test]
fn tables_and_plots_tell_the_runs() {
    let folder = folder(STUDY);
    run_with_made_up_times(folder.path());
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
        let ink = png.pixels().filter(|pixel| pixel.0 != [255; 3]).count();
        assert!(ink > 1000, "{ink} pixels of {plot} are drawn on");
    }
}

/// Threads that take turns are marked in tables and plots, and no law is fitted
/// to them.
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
fn a_stopped_study_goes_on() {
    let folder = folder(STUDY);
    assert_success(&run(folder.path(), &[]));
    let file = folder.path().join("out/runs.jsonl");
    let whole = fs::read_to_string(&file).unwrap();
    // Stopped in the middle of the tenth run's line.
    let end: usize = whole.split_inclusive('\n').take(10).map(str::len).sum();
    fs::write(&file, &whole[..end + 30]).unwrap();
    assert_success(&run(folder.path(), &[]));
    let after = fs::read_to_string(&file).unwrap();
    assert_eq!(after[..end], whole[..end], "no run is measured again");
    assert_eq!(lines(folder.path()).len(), 17);
}

#[test]
fn time_that_is_up_leaves_the_rest_to_the_next_call() {
    let folder = folder(&format!("{STUDY}\ntime_budget_s: 1e-12"));
    let first = run(folder.path(), &[]);
    assert_success(&first);
    assert_eq!(lines(folder.path()).len(), 1);
    let said = String::from_utf8_lossy(&first.stdout).into_owned();
    assert!(said.contains("left    16 runs"), "{said}");
}

/// Runs `raycost study` with these words in a folder.
fn study(folder: &Path, words: &[&str]) -> Output {
    let mut command = raycost();
    let command = command.current_dir(folder).arg("study");
    command.args(words).output().unwrap()
}

#[test]
fn several_studies_each_have_a_folder() {
    let folder = folder(STUDY);
    let path = folder.path();
    fs::write(path.join("other.yaml"), STUDY.replace("small", "second")).unwrap();
    assert_success(&study(path, &["study.yaml", "other.yaml", "--quick"]));
    let held = |name: &str| fs::read_to_string(path.join("out/studies").join(name)).unwrap();
    for name in ["study-quick", "other-quick"] {
        assert_eq!(held(&format!("{name}/runs.jsonl")).lines().count(), 17);
    }
    let statistics: Value = serde_json::from_str(&held("other-quick/statistics.json")).unwrap();
    assert_eq!(statistics["title"], "A second study");

    // A folder stands for its studies.
    fs::create_dir_all(path.join("configs/studies")).unwrap();
    let there = STUDY.replace("scene.yaml", "../../scene.yaml");
    fs::write(path.join("configs/studies/third.yaml"), &there).unwrap();
    assert_success(&study(
        path,
        &["configs/studies", "other.yaml", "--out", "all"],
    ));
    assert!(path.join("all/third/runs.jsonl").exists());
    assert!(path.join("all/other/statistics.csv").exists());
    // Nothing named stands for the ready ones.
    assert_success(&study(path, &[]));
    assert!(path.join("out/studies/third/runs.jsonl").exists());
}

#[test]
fn a_mistake_in_one_of_several_studies_stops_all() {
    let folder = folder(STUDY);
    let path = folder.path();
    let refused = |words: &[&str], told: &str| {
        let refused = study(path, words);
        assert_eq!(refused.status.code(), Some(2), "{words:?}");
        assert!(said(&refused).contains(told), "{}", said(&refused));
    };
    fs::write(path.join("broken.yaml"), "title: x\nscenes: []").unwrap();
    refused(&["study.yaml", "broken.yaml"], "cannot be an empty list");
    fs::create_dir_all(path.join("a")).unwrap();
    refused(&["a"], "`a` has no study");
    fs::copy(path.join("study.yaml"), path.join("a/study.yaml")).unwrap();
    refused(&["study.yaml", "a"], "would both write to");
    refused(&[], "there is no folder `configs/studies` here");
    refused(&["nothing.yaml"], "there is no study `nothing.yaml`");
    assert!(!path.join("out").exists(), "nothing is measured");

    // RunLog of others, in the last of the folders.
    let theirs = path.join("out/studies/study/runs.jsonl");
    fs::create_dir_all(theirs.parent().unwrap()).unwrap();
    fs::write(&theirs, "the notes of somebody\n").unwrap();
    fs::copy(path.join("study.yaml"), path.join("first.yaml")).unwrap();
    refused(&["first.yaml", "study.yaml"], "holds no results");
    let first = fs::read_to_string(path.join("out/studies/first/runs.jsonl")).unwrap();
    assert_eq!(first.lines().count(), 1, "nothing is measured");
    assert_eq!(
        fs::read_to_string(&theirs).unwrap(),
        "the notes of somebody\n"
    );
}

#[test]
fn statistics_hold_the_laws_of_the_plots() {
    let folder = folder(STUDY);
    run_with_made_up_times(folder.path());
    let text = fs::read_to_string(folder.path().join("out/statistics.json")).unwrap();
    let statistics: Value = serde_json::from_str(&text).unwrap();
    let fits = statistics["fits"].as_array().unwrap();
    // A line for each depth, of the one plot that asks for laws.
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

/// The study checks both points before it runs the first one, which takes many
/// times the memory of that run.
#[test]
#[cfg(any(target_os = "linux", target_os = "macos"))]
fn the_peak_memory_of_a_run_is_its_own() {
    let study = "
title: Little memory after much
scenes: [scene.yaml]
vary: { objects: [10, 500000] }
flags: [--width=12, --height=9, --threads=1, --cost=counters]
repeats: 1
warm_up: 0
plots:
  - { x: objects, y: peak_memory_bytes }
";
    let folder = folder(study);
    let cloud = fs::read_to_string(in_repository("configs/sphere_cloud.yaml")).unwrap();
    fs::write(folder.path().join("scene.yaml"), &cloud).unwrap();
    assert_success(&run(folder.path(), &[]));
    let of_objects = |n: u64| {
        let lines = lines(folder.path());
        let run = lines[1..].iter().find(|run| run["point"]["objects"] == n);
        run.unwrap()["metrics"]["peak_memory_bytes"]
            .as_f64()
            .unwrap()
    };
    let in_study = of_objects(10);
    assert!(of_objects(500_000) > 3.0 * in_study);

    let few = cloud.replace("count: 10000", "count: 10");
    assert_ne!(few, cloud);
    fs::write(folder.path().join("few.yaml"), few).unwrap();
    let mut alone = raycost();
    alone
        .current_dir(folder.path())
        .args(["render", "few.yaml"]);
    alone.args(["--width=12", "--height=9", "--threads=1", "--cost=counters"]);
    assert_success(&alone.args(["--out", "alone"]).output().unwrap());
    let summary = fs::read(folder.path().join("alone/summary.json")).unwrap();
    let summary: Value = serde_json::from_slice(&summary).unwrap();
    let alone = summary["peak_memory_bytes"].as_f64().unwrap();
    assert!(
        (0.5..2.0).contains(&(in_study / alone)),
        "{in_study}, {alone}"
    );
}

#[test]
fn quick_takes_what_the_study_says_instead() {
    let quick = "quick: { vary: { tile_size: [4] }, flags: [--width=6, --height=5], repeats: 1 }";
    let folder = folder(&format!("{STUDY}\n{quick}"));
    assert_success(&run(folder.path(), &["--quick"]));
    let lines = lines(folder.path());
    assert_eq!(lines.len(), 1 + 2);
    assert_eq!(lines[1]["metrics"]["n_pixels"], 30.0);
}

#[test]
fn results_of_others_are_left_alone() {
    let folder = folder(STUDY);
    let file = folder.path().join("out/runs.jsonl");
    fs::create_dir(folder.path().join("out")).unwrap();
    for (held, told) in [
        ("{\"raycost_study\":99,\"made_by\":{}}\n", "has format 99"),
        (
            "{\"raycost_study\":1,\"made_by\":{}}\n",
            "were made with another machine",
        ),
        ("the notes of somebody\n", "holds no results"),
    ] {
        fs::write(&file, held).unwrap();
        let refused = run(folder.path(), &[]);
        assert_eq!(refused.status.code(), Some(2));
        assert!(said(&refused).contains(told), "{}", said(&refused));
        assert_eq!(fs::read_to_string(&file).unwrap(), held);
    }
}

#[test]
fn mistakes_are_told_before_anything_is_measured() {
    for (study, told) in [
        ("title: x\nscenes: []", "`scenes` cannot be an empty list"),
        (
            "title: x\nscenes: [scene.yaml]\nvary: { threads: [] }",
            "`vary.threads` cannot be an empty list",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nvary: { theads: [1] }",
            "did you mean `threads`?",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nvary: { threads: [0] }",
            "`vary.threads[0]` cannot be `0`",
        ),
        ("title: x\nscenes: [study.yaml]", "unknown key `title`"),
        ("title: x\nscenes: [none.yaml]", "cannot read the scene"),
        (
            "title: x\nscenes: [scene.yaml]\nflags: [--with=3]",
            "--with",
        ),
        (
            "title: x\nscenes: [scene.yaml]\nvary: { objects: [5] }",
            "no `sphere_cloud`",
        ),
    ] {
        let folder = folder(study);
        let refused = run(folder.path(), &[]);
        assert_eq!(refused.status.code(), Some(2), "{study}");
        assert!(said(&refused).contains(told), "{study}\n{}", said(&refused));
        assert!(!folder.path().join("out").exists());
    }
}

#[test]
fn the_ready_studies_can_be_run() {
    for entry in fs::read_dir(in_repository("configs/studies")).unwrap() {
        let path = entry.unwrap().path();
        let source = Source::read(&path).unwrap();
        let plan: StudyPlan = source.parse().unwrap_or_else(|error| panic!("{error}"));
        assert!(!plan.plots.is_empty() && plan.quick.is_some(), "{path:?}");
        for point in plan.points().iter().chain(&plan.into_quick().points()) {
            let scene = path.with_file_name("").join(&point.scene);
            assert!(scene.exists(), "{scene:?}");
        }
    }
}

/// A study whose one run takes hours, and whether a process renders for it.
#[cfg(target_os = "linux")]
mod stopped {
    use std::path::{Path, PathBuf};
    use std::process::{Child, Command, Stdio};
    use std::time::Duration;

    use super::*;

    const ENDLESS: &str = "
title: A study without end
scenes: [scene.yaml]
vary: { threads: [1] }
flags: [--spp=60000]
repeats: 1
";

    fn begin(folder: &Path) -> Child {
        let mut command = raycost();
        command.current_dir(folder).args(["study", "study.yaml"]);
        command.args(["--out", "out", "--quiet"]);
        let mut child = command.stderr(Stdio::null()).spawn().unwrap();
        while renderers(folder).is_empty() {
            assert!(child.try_wait().unwrap().is_none(), "it has ended");
            std::thread::sleep(Duration::from_millis(10));
        }
        child
    }

    /// The processes that render into this folder.
    fn renderers(folder: &Path) -> Vec<PathBuf> {
        let processes = fs::read_dir("/proc").unwrap().flatten();
        let is_one = |process: &PathBuf| {
            let words = fs::read(process.join("cmdline")).unwrap_or_default();
            let words = String::from_utf8_lossy(&words).into_owned();
            words.contains("\0render\0")
                && fs::read_link(process.join("cwd")).is_ok_and(|cwd| cwd == folder)
        };
        let processes = processes.map(|process| process.path());
        processes.filter(is_one).collect()
    }

    fn signal(child: &Child, name: &str) {
        let id = child.id().to_string();
        let mut kill = Command::new("kill");
        kill.args([&format!("-{name}"), &id]);
        assert!(kill.status().unwrap().success());
    }

    #[test]
    fn a_study_takes_its_run_with_it() {
        for (name, code) in [("INT", Some(130)), ("TERM", Some(143)), ("KILL", None)] {
            let folder = folder(ENDLESS);
            let path = folder.path().canonicalize().unwrap();
            let mut study = begin(&path);
            let second = run(&path, &[]);
            assert_eq!(second.status.code(), Some(1));
            assert!(said(&second).contains("another run"), "{}", said(&second));
            signal(&study, name);
            assert_eq!(study.wait().unwrap().code(), code);
            // It ends by itself: without that, this would not.
            while !renderers(&path).is_empty() {
                std::thread::sleep(Duration::from_millis(10));
            }
            assert_eq!(lines(&path).len(), 1);
            let names = fs::read_dir(path.join("out")).unwrap();
            let names: Vec<_> = names.map(|entry| entry.unwrap().file_name()).collect();
            if name != "KILL" {
                assert_eq!(names, ["runs.jsonl"]);
            }
            // The next one removes what a killed one has left.
            fs::write(path.join("study.yaml"), ENDLESS.replace("60000", "1")).unwrap();
            assert_success(&run(&path, &["--quiet"]));
            let hidden = fs::read_dir(path.join("out")).unwrap();
            let mut hidden = hidden.map(|entry| entry.unwrap().file_name());
            assert!(hidden.all(|name| !name.to_string_lossy().starts_with('.')));
        }
    }
}

#[test]
fn what_is_not_the_studys_is_left_alone() {
    let folder = folder(STUDY);
    let out = folder.path().join("out");
    fs::create_dir_all(out.join("run")).unwrap();
    fs::write(out.join("run/mine.txt"), "mine").unwrap();
    assert_success(&run(folder.path(), &[]));
    assert_eq!(fs::read(out.join("run/mine.txt")).unwrap(), b"mine");

    fs::remove_file(out.join("runs.jsonl")).unwrap();
    fs::write(out.join("statistics.csv"), "mine").unwrap();
    fs::remove_file(out.join("statistics.json")).unwrap();
    for entry in fs::read_dir(&out).unwrap().flatten() {
        if entry.file_name().to_string_lossy().starts_with("plot-") {
            fs::remove_file(entry.path()).unwrap();
        }
    }
    let refused = run(folder.path(), &[]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(
        said(&refused).contains("statistics.csv"),
        "{}",
        said(&refused)
    );
    assert_eq!(fs::read(out.join("statistics.csv")).unwrap(), b"mine");
}

#[test]
fn a_run_that_is_there_twice_is_noticed() {
    let folder = folder(STUDY);
    assert_success(&run(folder.path(), &[]));
    let file = folder.path().join("out/runs.jsonl");
    let text = fs::read_to_string(&file).unwrap();
    let third = text.lines().nth(2).unwrap();
    fs::write(&file, format!("{text}{third}\n")).unwrap();
    let refused = run(folder.path(), &[]);
    assert_eq!(refused.status.code(), Some(2));
    let said = said(&refused);
    assert!(said.contains("is the same run as line 3"), "{said}");
    assert!(
        fs::read_to_string(&file)
            .unwrap()
            .ends_with(&format!("{third}\n"))
    );
}
