//! Repeated renderings change only the times.

use scene::build::Sensor;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Output;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use base::Keyword;
use cpu_time::ThreadTime;
use serde_json::{Value, json};

use crate::common::data_set::DataSet;
use crate::common::{assert_success, config, in_repository, lasting, raycost, scene_of, with_cost};
use render::film::Film;
use render::tiles::{Repeat, TilePlan, render, repeat};
use scene::config::{Config, CostMode, Repeats};
use tracer::accel::Accel;
use tracer::cost::Meter;
use tracer::trace::Tracer;

fn small(name: &str) -> Config {
    let mut config = config(name);
    (config.image.width, config.image.height) = (53, 37);
    config
}

fn repeated(config: &Config, n_repeats: u8) -> (Film, Vec<Repeat>) {
    let scene = scene_of(config);
    let accel = Accel::new(&scene, config.acceleration);
    let tracer = Tracer::new(&scene, &accel);
    let meter = Meter::new(config.cost);
    let threads = rayon::ThreadPoolBuilder::new().num_threads(2);
    let pool = threads.build().unwrap();
    let (film, _, repeats) = pool.install(|| {
        let plan = TilePlan::new(tracer, &Sensor::new(&scene, config), config.tiles);
        repeat(exactly(n_repeats), tracer, &plan, &meter, &|_| {})
    });
    (film, repeats)
}

fn exactly(n_repeats: u8) -> Repeats {
    n_repeats.to_string().parse().unwrap()
}

#[test]
fn repeats_change_neither_the_picture_nor_the_counters() {
    for &mode in CostMode::KEYWORDS {
        let config = with_cost(small("seed_extended"), mode);
        let once = crate::common::film(&config, 2);
        for n_repeats in [1, 2, 5] {
            let (film, repeats) = repeated(&config, n_repeats);
            assert_eq!(film.totals, once.totals);
            assert_eq!(repeats.len(), usize::from(n_repeats));
            let is_moved = mode == CostMode::Time;
            assert_eq!(film.n_grids, if is_moved { n_repeats } else { 1 });
            assert!(lasting(film) == lasting(once.clone()), "{mode:?}");
        }
    }
}

#[test]
fn every_repeat_has_the_same_counters() {
    let config = small("hall_of_mirrors");
    let (one, _) = repeated(&config, 1);
    for n_repeats in 2..5 {
        // The counters of the film are those of its last rendering.
        let (film, _) = repeated(&config, n_repeats);
        assert_eq!(film.totals, one.totals);
    }
}

#[test]
fn each_repeat_reports_its_pixels() {
    let config = small("seed_sphere");
    let scene = scene_of(&config);
    let accel = Accel::new(&scene, config.acceleration);
    let tracer = Tracer::new(&scene, &accel);
    let meter = Meter::new(config.cost);
    let plan = TilePlan::new(tracer, &Sensor::new(&scene, &config), config.tiles);
    let n_pixels = std::sync::atomic::AtomicU64::new(0);
    let report = |progress: render::tiles::Progress| {
        n_pixels.fetch_add(progress.n_pixels, std::sync::atomic::Ordering::Relaxed);
    };
    repeat(exactly(3), tracer, &plan, &meter, &report);
    assert_eq!(n_pixels.into_inner(), 3 * 53 * 37);
    let (film, _) = render(tracer, &plan, &meter, &|_| {});
    assert_eq!(film.n_repeats, 1);
}

/// The CPU time that the threads of the pool have used.
fn cpu_time(pool: &rayon::ThreadPool) -> Duration {
    let times = pool.broadcast(|_| ThreadTime::now().as_duration());
    times.into_iter().sum()
}

/// The share of each object, or of nothing, in the time of the picture.
fn shares(film: &Film) -> BTreeMap<i32, f64> {
    let mut shares = BTreeMap::new();
    let total_ns = film.total_time_ns();
    let objects = film.values(|strip| &strip.object);
    for (object, ns) in objects.zip(film.values(|strip| &strip.time_ns)) {
        *shares.entry(object).or_default() += f64::from(ns) / total_ns;
    }
    shares
}

#[test]
#[ignore = "compares times"]
fn beside_other_work_the_times_are_those_of_the_pixels() {
    let config = with_cost(config("blocks"), CostMode::SingleRayTime);
    let scene = scene_of(&config);
    let accel = Accel::new(&scene, config.acceleration);
    let tracer = Tracer::new(&scene, &accel);
    let meter = Meter::new(config.cost);
    let plan = TilePlan::new(tracer, &Sensor::new(&scene, &config), config.tiles);
    let threads = rayon::ThreadPoolBuilder::new().num_threads(2);
    let pool = threads.build().unwrap();
    // The part of the CPU time that is known, and the shares of objects.
    let measured = || {
        let before = cpu_time(&pool);
        let (film, _, repeats) =
            pool.install(|| repeat(exactly(1), tracer, &plan, &meter, &|_| {}));
        let cpu_ns = (cpu_time(&pool) - before).as_nanos() as f64;
        (repeats[0].busy_ns as f64 / cpu_ns, shares(&film))
    };
    let quiet = measured();
    let is_over = AtomicBool::new(false);
    let beside = std::thread::scope(|scope| {
        let spin = || {
            while !is_over.load(Ordering::Relaxed) {
                std::hint::spin_loop()
            }
        };
        let n_processors = std::thread::available_parallelism().unwrap().get();
        (0..n_processors).for_each(|_| drop(scope.spawn(spin)));
        let beside = measured();
        is_over.store(true, Ordering::Relaxed);
        beside
    });
    for (known, _) in [&quiet, &beside] {
        assert!((0.9..1.1).contains(known), "{known}");
    }
    for (object, share) in quiet.1 {
        let found = beside.1[&object];
        assert!((found - share).abs() < 0.03, "{object}: {share} {found}");
    }
}

#[test]
fn times_and_their_spread_make_sense() {
    let (film, repeats) = repeated(&small("seed_extended"), 4);
    let times = film.values(|strip| &strip.time_ns);
    let deviations = film.values(|strip| &strip.time_mad_ns);
    for (time_ns, mad_ns) in times.zip(deviations) {
        assert!(time_ns >= 1.0 && time_ns.is_finite());
        // Half of the times, which are positive, are no larger than the
        // median, and so no farther from it.
        assert!((0.0..).contains(&mad_ns) && mad_ns.is_finite());
    }
    for repeat in &repeats {
        let pixels_ns = repeat.pixels_ns.unwrap();
        assert!(pixels_ns >= 53.0 * 37.0);
        // On a coarse clock both may be 0.
        assert!(repeat.film_ns <= repeat.busy_ns);
    }
}

/// Renders a small picture with these arguments.
fn command(out: &Path, arguments: &[&str]) -> Output {
    raycost()
        .arg("render")
        .arg(in_repository("configs/seed_extended.yaml"))
        .args(["--width=40", "--height=30", "--out"])
        .arg(out)
        .args(arguments)
        .output()
        .unwrap()
}

fn summary(out: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(out.join("summary.json")).unwrap()).unwrap()
}

#[test]
fn the_files_hold_the_repeats() {
    let out = tempfile::tempdir().unwrap();
    let output = command(out.path(), &["--repeats=3"]);
    assert_success(&output);
    let lines = String::from_utf8(output.stdout).unwrap();
    assert!(lines.contains("\nrepeats 3; MAD "), "{lines}");
    let repeats = &summary(out.path())["repeats"];
    assert_eq!((&repeats["asked"], &repeats["n"]), (&json!(3), &json!(3)));
    for list in ["busy_ns", "wall_ms"] {
        let list = repeats[list].as_array().unwrap();
        assert_eq!(list.len(), 3);
        assert!(list.iter().all(|time| time.as_f64().unwrap() > 0.0));
    }
    for file in ["frame.vti", "hits.vtu"] {
        let data = DataSet::read(&out.path().join(file));
        let names: Vec<&str> = data
            .arrays
            .iter()
            .map(|array| array.name.as_str())
            .collect();
        let time = names.iter().position(|name| *name == "time_ns").unwrap();
        assert_eq!(names[time + 1], "time_mad_ns");
    }
}

#[test]
fn squares_in_the_times_are_said_in_the_same_words() {
    let out = tempfile::tempdir().unwrap();
    let sentence = "timed in squares of 16 x 16 pixels; 5 repeats or 1,024 samples avoid them";
    for (arguments, is_said) in [
        (&["--repeats=1", "--spp=4"][..], true),
        (
            &["--repeats=1", "--spp=4", "--cost=single_ray_time"][..],
            false,
        ),
        (&["--repeats=5", "--spp=4"][..], false),
        (&["--repeats=1", "--cost=counters"][..], false),
    ] {
        let output = command(out.path(), arguments);
        assert_success(&output);
        let lines = String::from_utf8(output.stdout).unwrap();
        let lines = lines.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(lines.contains(sentence), is_said, "{lines}");
        let notes = summary(out.path())["time_notes"].clone();
        let notes = notes.as_array().unwrap();
        assert_eq!(
            notes.iter().any(|note| note == sentence),
            is_said,
            "{notes:?}"
        );
        for name in ["heatmap.pvsm", "overview.pvsm"] {
            let state = fs::read_to_string(out.path().join(name)).unwrap();
            assert_eq!(state.contains(sentence), is_said, "{name}, {arguments:?}");
        }
    }
}

#[test]
fn one_rendering_has_no_spread_but_a_summary() {
    let out = tempfile::tempdir().unwrap();
    for (arguments, asked, n_times) in [
        (&["--repeats=1"][..], json!(1), 1),
        (&["--repeats=1", "--cost=counters"][..], json!(1), 0),
        (&["--cost=counters"][..], json!("auto"), 0),
        (&["--no-cost"][..], json!("auto"), 0),
    ] {
        assert_success(&command(out.path(), arguments));
        let summary = summary(out.path());
        let repeats = &summary["repeats"];
        assert_eq!((&repeats["asked"], &repeats["n"]), (&asked, &json!(1)));
        assert_eq!(repeats["wall_ms"].as_array().unwrap().len(), 1);
        assert_eq!(repeats["busy_ns"].as_array().unwrap().len(), n_times);
        assert_eq!(summary["thread_time"].is_null(), n_times == 0);
        let frame = DataSet::read(&out.path().join("frame.vti"));
        let is_spread = |name: &str| name == "time_mad_ns";
        assert!(!frame.arrays.iter().any(|array| is_spread(&array.name)));
    }
}

/// The names of the arrays of a file.
fn arrays(file: &Path) -> Vec<String> {
    let arrays = DataSet::read(file).arrays.into_iter();
    arrays.map(|array| array.name).collect()
}

#[test]
fn the_default_has_the_same_arrays_however_often_it_renders() {
    let out = tempfile::tempdir().unwrap();
    let mut found = Vec::new();
    for arguments in [&[][..], &["--repeats=auto"][..], &["--repeats=2"][..]] {
        let output = command(out.path(), arguments);
        assert_success(&output);
        let lines = String::from_utf8(output.stdout).unwrap();
        assert!(lines.contains("\nrepeats "), "{lines}");
        let n = summary(out.path())["repeats"]["n"].as_u64().unwrap();
        assert!((1..=5).contains(&n), "{n}");
        found.push(["frame.vti", "hits.vtu"].map(|file| arrays(&out.path().join(file))));
    }
    assert!(
        found[0]
            .iter()
            .all(|names| names.contains(&"time_mad_ns".to_owned()))
    );
    assert!(found.iter().all(|names| *names == found[0]));
}

#[test]
fn a_single_rendering_of_auto_has_a_spread_of_zero() {
    let config = small("seed_sphere");
    let scene = scene_of(&config);
    let accel = Accel::new(&scene, config.acceleration);
    let tracer = Tracer::new(&scene, &accel);
    let plan = TilePlan::new(tracer, &Sensor::new(&scene, &config), config.tiles);
    let meter = Meter::new(CostMode::Time);
    // A rendering that is reported so slowly that no second one is made.
    let wait = std::time::Duration::from_millis(300);
    let first = std::sync::Once::new();
    let slowly = |_| first.call_once(|| std::thread::sleep(wait));
    let (film, _, repeats) = repeat(Repeats::Auto, tracer, &plan, &meter, &slowly);
    assert_eq!((film.n_repeats, repeats.len()), (1, 1));
    let deviations: Vec<f32> = film.values(|strip| &strip.time_mad_ns).collect();
    assert_eq!(deviations, vec![0.0; 53 * 37]);
}

#[test]
fn auto_renders_once_without_times() {
    for mode in [CostMode::None, CostMode::Counters] {
        let config = with_cost(small("seed_sphere"), mode);
        let scene = scene_of(&config);
        let accel = Accel::new(&scene, config.acceleration);
        let tracer = Tracer::new(&scene, &accel);
        let plan = TilePlan::new(tracer, &Sensor::new(&scene, &config), config.tiles);
        let meter = Meter::new(mode);
        let (_, _, repeats) = repeat(Repeats::Auto, tracer, &plan, &meter, &|_| {});
        assert_eq!(repeats.len(), 1);
    }
}

/// Writes a scene file with an additional section.
fn scene_with(folder: &Path, section: &str) -> std::path::PathBuf {
    let scene = fs::read_to_string(in_repository("configs/seed_sphere.yaml")).unwrap();
    let file = folder.join("scene.yaml");
    fs::write(&file, format!("{section}\n{scene}")).unwrap();
    file
}

#[test]
fn a_scene_may_set_its_repeats() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let file = scene_with(folder.path(), "repeats: 2");
    let render = |arguments: &[&str]| {
        let mut command = raycost();
        command.arg("render").arg(&file).arg("--out").arg(&out);
        command.args(["--width=8", "--height=6"]);
        assert_success(&command.args(arguments).output().unwrap());
        summary(&out)["repeats"]["n"].clone()
    };
    assert_eq!(render(&[]), 2);
    assert_eq!(render(&["--repeats=3"]), 3);
    // Repeats require times.
    assert_eq!(render(&["--no-cost"]), 1);
    let file = scene_with(folder.path(), "repeats: 2\ncost: counters");
    let output = raycost().arg("check").arg(file).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("scene.yaml:1:10\n"), "{message}");
}

#[test]
fn the_threads_time_is_the_sum_of_its_parts() {
    // The times of pixels include readings between the stages of a wave, and the film.
    check_thread_time("--cost=time", |ns| ns == 0.0);
    check_thread_time("--cost=single_ray_time", |ns| ns > 0.0);
}

fn check_thread_time(mode: &str, is_apart: impl Fn(f64) -> bool) {
    let out = tempfile::tempdir().unwrap();
    let output = command(out.path(), &["--repeats=2", mode]);
    assert_success(&output);
    let lines = String::from_utf8(output.stdout).unwrap();
    assert!(lines.contains(" % unexplained\n"), "{lines}");
    let summary = summary(out.path());
    let part = |name: &str| summary["thread_time"][name].as_f64().unwrap();
    let parts = [
        "pixels_ns",
        "film_ns",
        "warm_up_ns",
        "clock_ns",
        "unexplained_ns",
    ]
    .map(part);
    assert!(part("waiting_ns") >= 0.0);
    let busy_ns = part("busy_ns");
    assert!((parts.iter().sum::<f64>() / busy_ns - 1.0).abs() < 1e-9);
    assert!(part("pixels_ns") > 0.0 && part("warm_up_ns") > 0.0);
    assert!(is_apart(part("clock_ns")) && is_apart(part("film_ns")));
    let percent = 100.0 * part("unexplained_ns") / busy_ns;
    assert!((part("unexplained_percent") - percent).abs() < 1e-9);
    let repeats = summary["repeats"]["busy_ns"].as_array().unwrap();
    let sum: f64 = repeats.iter().map(|ns| ns.as_f64().unwrap()).sum();
    assert!((sum / part("pixels_ns") - 1.0).abs() < 1e-9);
}

#[test]
fn repeats_without_times_are_rejected_before_writing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let failure = |output: Output| {
        assert_eq!(output.status.code(), Some(2));
        assert!(output.stdout.is_empty() && !out.exists());
        String::from_utf8(output.stderr).unwrap()
    };
    for mode in ["--no-cost", "--cost=counters"] {
        let message = failure(command(&out, &["--repeats=3", mode]));
        assert!(message.starts_with("error: `--repeats` requires times"));
        assert!(message.contains("= help: use `--cost time`"), "{message}");
    }
    for n in ["0", "256", "-1", "many"] {
        let message = failure(command(&out, &[&format!("--repeats={n}")]));
        assert!(message.contains("--repeats"), "{message}");
    }

    let scene = fs::read_to_string(in_repository("configs/seed_sphere.yaml")).unwrap();
    let file = folder.path().join("scene.yaml");
    fs::write(&file, format!("cost: counters\n{scene}")).unwrap();
    let render = |arguments: &[&str]| {
        let mut command = raycost();
        command.arg("render").arg(&file).arg("--out").arg(&out);
        command.args(["--width=8", "--height=6", "--repeats=2"]);
        command.args(arguments).output().unwrap()
    };
    let message = failure(render(&[]));
    assert!(message.contains("scene.yaml:1:7\n"), "{message}");
    assert!(message.contains("^^^^^^^^ expected `time`"), "{message}");
    assert_success(&render(&["--cost=time"]));
}

#[test]
fn check_reports_the_memory_of_repeats() {
    let film_bytes = |arguments: &[&str]| {
        let mut command = raycost();
        command
            .arg("check")
            .arg(in_repository("configs/seed_extended.yaml"));
        let output = command
            .args(["--width=1000", "--height=1000"])
            .args(arguments)
            .output()
            .unwrap();
        assert_success(&output);
        let text = String::from_utf8(output.stdout).unwrap();
        let (_, film) = text.split_once(": film ").unwrap();
        let (film, _) = film.split_once(" MB").unwrap();
        film.parse::<f64>().unwrap()
    };
    // Four bytes per sample, and four for the deviation; twelve to write the files later.
    let once = film_bytes(&["--repeats=1"]);
    let more = film_bytes(&["--repeats=10"]) - once;
    assert!((more - 32.0).abs() < 1.0, "{more}");
    // At most five of a picture of this size.
    let more = film_bytes(&[]) - once;
    assert!((more - 12.0).abs() < 1.0, "{more}");
}
