//! Helpers shared by several test files.
#![allow(dead_code, reason = "each test file uses its part")]

pub mod chromium;
pub mod data_set;
pub mod generators;
pub mod kept;
pub mod moved;
pub mod noise;
pub mod paraview;
pub mod same_output;
pub mod scenes;
pub mod twins;

use scene::build::{Geometries, Sensor};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use glam::Vec3;
use serde_json::Value;

use math::simd::Simd;
use render::film::{Film, Strip};
use render::schedule::Schedule;
use render::tiles::{TilePlan, render};
use scene::config::{Config, CostMode, OptionalOutput};
use scene::yaml::Source;
use tracer::accel::Accel;
use tracer::cost::{self, Counter, Meter, Metric};
use tracer::trace::Tracer;
use world::geometry::RenderSpace;
use world::scene::Scene;

/// The names of the counters, as arrays and totals have them; all but the last add up.
pub const COUNTERS: [&str; 8] = [
    "node_visits",
    "primitive_tests",
    "rays",
    "shadow_rays",
    "reflection_rays",
    "refraction_rays",
    "diffuse_rays",
    "depth",
];

/// Returns a path in the repository.
pub fn in_repository(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Returns the command with the usual actions of signals, changed by these flags of `env`: tests may
/// themselves have been started to ignore some, as in the background of a script.
pub fn with_signals(flags: &[&str], command: &Command) -> Command {
    let mut env = Command::new("env");
    env.arg("--default-signal=HUP,INT,TERM").args(flags);
    env.arg(command.get_program()).args(command.get_args());
    env.current_dir(command.get_current_dir().unwrap_or(Path::new(".")));
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => env.env(name, value),
            None => env.env_remove(name),
        };
    }
    env
}

/// Returns a command of the program that ignores environment variables for colors
/// and threads.
pub fn raycost() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_raycost"));
    for variable in [
        "CLICOLOR",
        "CLICOLOR_FORCE",
        "NO_COLOR",
        "RAYON_NUM_THREADS",
    ] {
        command.env_remove(variable);
    }
    command
}

/// Fails with the program's output if it did not succeed.
pub fn assert_success(output: &Output) {
    let [out, err] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    assert!(output.status.success(), "{out}{err}");
}

/// Writes a file of an output, and lists it in the summary as if the run had
/// written it.
pub fn replace_file(output: &Path, name: &str, bytes: &[u8]) {
    std::fs::write(output.join(name), bytes).unwrap();
    let path = output.join("summary.json");
    let mut summary: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    let files = summary["files"].as_array_mut().unwrap();
    let mut file = files[0].clone();
    file["file"] = name.into();
    file["bytes"] = bytes.len().into();
    files.retain(|listed| listed["file"] != file["file"]);
    files.push(file);
    std::fs::write(path, summary.to_string()).unwrap();
}

/// All names in a folder, hidden ones too, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// The config of a file in `configs/`.
pub fn config(name: &str) -> Config {
    let source = Source::read(&in_repository(&format!("configs/{name}.yaml"))).unwrap();
    source.parse().unwrap_or_else(|error| panic!("{error}"))
}

/// Parses a config.
pub fn parse(text: &str) -> Config {
    let source = Source::new("test.yaml", text);
    source.parse().unwrap_or_else(|error| panic!("{error}"))
}

/// Builds the scene of a config whose files are relative to `configs/`.
pub fn scene_of(config: &Config) -> Scene {
    let (config, geometries) = with_geometries(config);
    scene::build::scene(&config, geometries).unwrap()
}

/// The same scene in world space, for rays that are given there.
pub fn scene_in_world(config: &Config) -> Scene {
    let (config, geometries) = with_geometries(config);
    scene::build::scene_in_space(&config, geometries, RenderSpace::default()).unwrap()
}

fn with_geometries(config: &Config) -> (Config, Geometries) {
    let folder = in_repository("configs");
    let mut config = config.clone();
    let geometries = Geometries::read(&mut config, folder.as_path(), u64::MAX);
    (config, geometries.unwrap())
}

/// Renders the film of a config on `n_threads` threads.
pub fn film(config: &Config, n_threads: usize) -> Film {
    film_on(config, n_threads, Simd::best())
}

/// The radiance of each pixel, of a scene, row by row.
pub fn radiance(text: &str) -> Vec<Vec3> {
    let mut config = parse(text);
    config.output.add(OptionalOutput::Radiance);
    let film = film(&config, 2);
    film.values(|strip| &strip.radiance).collect()
}

/// The mean of vectors.
pub fn mean(vectors: &[Vec3]) -> Vec3 {
    vectors.iter().sum::<Vec3>() / vectors.len() as f32
}

/// Renders the film of a config with an instruction set.
pub fn film_on(config: &Config, n_threads: usize, simd: Simd) -> Film {
    rendered(config, n_threads, simd).0
}

/// Renders the film of a config; also returns the schedule of its tiles.
pub fn rendered(config: &Config, n_threads: usize, simd: Simd) -> (Film, Schedule) {
    let scene = scene_of(config);
    let accel = Accel::new(&scene, config.acceleration).with_simd(simd);
    let tracer = Tracer::new(&scene, &accel);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(n_threads)
        .build()
        .unwrap();
    pool.install(|| {
        let plan = TilePlan::new(tracer, &Sensor::new(&scene, config), config.tiles);
        render(tracer, &plan, &Meter::new(config.cost), &|_| {})
    })
}

/// Returns the config with another cost mode.
pub fn with_cost(config: Config, cost: CostMode) -> Config {
    Config { cost, ..config }
}

/// Returns the film without the values that may differ: time, thread and tiles.
pub fn lasting(mut film: Film) -> (Vec<Strip>, Vec<Vec<u32>>) {
    let counts = if film.cost.has_counters() {
        Counter::ALL.map(|counter| counts(&film, counter)).into()
    } else {
        Vec::new()
    };
    for strip in &mut film.strips {
        strip.time_ns.clear();
        strip.time_mad_ns.clear();
        // NaN is not equal to itself: compare bits.
        let misses = strip
            .object
            .iter()
            .enumerate()
            .filter(|(_, object)| **object < 0);
        for i in misses.map(|(i, _)| i).collect::<Vec<_>>() {
            assert!(strip.position[i].is_nan() && strip.normal[i].is_nan());
            assert!(strip.distance[i].is_nan() && strip.footprint[i].is_nan());
            (strip.position[i], strip.normal[i]) = Default::default();
            (strip.distance[i], strip.footprint[i]) = Default::default();
        }
    }
    (film.strips, counts)
}

/// One counter of all pixels.
pub fn counts(film: &Film, counter: Counter) -> Vec<u32> {
    let is_of = |metric: &Metric| metric.source == cost::MetricSource::Counter(counter);
    let metric = Metric::ALL.into_iter().find(is_of).unwrap();
    of_strips(film, |strip, counts| film.counts(strip, metric, counts))
}

/// The rays of all pixels.
pub fn rays(film: &Film) -> Vec<u32> {
    of_strips(film, |strip, rays| film.counts(strip, Metric::RAYS, rays))
}

/// The tile of each pixel, by its number, and the thread that rendered it.
pub fn tiles_and_threads(film: &Film) -> [Vec<u32>; 2] {
    [
        of_strips(film, |strip, numbers| film.tile_numbers(strip, numbers)),
        of_strips(film, |strip, threads| film.threads(strip, threads)),
    ]
}

/// Concatenates the values that `make` computes of each strip.
fn of_strips(film: &Film, make: impl Fn(&Strip, &mut Vec<u32>)) -> Vec<u32> {
    let mut all = Vec::new();
    let mut of_strip = Vec::new();
    for strip in &film.strips {
        make(strip, &mut of_strip);
        all.extend_from_slice(&of_strip);
    }
    all
}

/// The sum of one counter over all pixels.
pub fn sum(film: &Film, counter: Counter) -> u64 {
    total(&counts(film, counter))
}

/// The sum of counts.
pub fn total(counts: &[u32]) -> u64 {
    counts.iter().copied().map(u64::from).sum()
}
