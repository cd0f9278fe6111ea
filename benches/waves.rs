//! The clock of waves: its cost, its sum, and its agreement with an independent clock: `cargo bench
//! --bench waves [-- SCENE …] [-- --json FILE]`.
//!
//! For each scene, on one thread, in turns: (a) CPU time with the clock of waves over CPU time with
//! only counters; (b) the sum of all pixels' times over the time that the thread spent on tiles;
//! (c) windows of 32 x 32 pixels at random places, rendered separately with counters and without a
//! clock inside: the share whose time agrees with the map of the whole picture within 10 %.
//! Overheads compare the fastest of several rounds, the others are medians.

#[path = "render/scenes.rs"]
mod scenes;

use std::fs;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use base::text::Diagnostic;
use clap::Parser;
use cpu_time::ThreadTime;
use math::statistics::median;
use render::film::Film;
use render::schedule::{Schedule, TileRun};
use render::tiles::{TilePlan, render, repeat};
use scene::config::{Config, CostMode, Repeats};
use scene::world::{Geometries, Scene};
use scene::yaml::Source;
use serde_json::{Value, json};
use tracer::accel::Accel;
use tracer::cost::Meter;
use tracer::trace::Tracer;

/// Pixels along a window's side.
const SIDE: u32 = 32;

/// Greatest relative difference between a window's time and its time in the map.
const TOLERANCE: f64 = 0.1;

#[derive(Parser)]
struct Options {
    /// Scene files, and folders of them [default: configs]
    scenes: Vec<PathBuf>,
    /// Columns of the pictures
    #[arg(long, default_value_t = 1920)]
    width: u32,
    /// Rows of the pictures
    #[arg(long, default_value_t = 1080)]
    height: u32,
    /// Samples per pixel
    #[arg(long, default_value_t = 4)]
    spp: u32,
    /// Rounds, of which the least time counts
    #[arg(long, default_value_t = 9)]
    rounds: usize,
    /// Windows of each scene
    #[arg(long, default_value_t = 20)]
    windows: u32,
    /// Also write the results to this file
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// `cargo bench` passes it
    #[arg(long, hide = true)]
    bench: bool,
}

/// A scene that can be rendered.
struct World<'a> {
    config: &'a Config,
    tracer: Tracer<'a>,
    counters: Meter,
    time: Meter,
}

fn main() -> ExitCode {
    match compare_all(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}

fn compare_all(options: &Options) -> Result<(), String> {
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1);
    let pool = one_thread.build().map_err(|error| error.to_string())?;
    println!("scene               time over counters   sum over tiles'   windows within 10 %");
    let mut rows = Vec::new();
    for path in scenes::named(options.scenes.clone())? {
        let row = pool.install(|| compare(&path, options));
        rows.push(row.map_err(|error| error.to_string())?);
    }
    if let Some(path) = &options.json {
        let made_by = raycost::session::this_build();
        let results = json!({ "rows": rows, "made_by": made_by });
        fs::write(path, format!("{results:#}"))
            .map_err(|error| format!("{}: {error}", path.display()))?;
    }
    Ok(())
}

fn compare(path: &Path, options: &Options) -> Result<Value, Diagnostic> {
    let source = Source::read(path)?;
    let mut config: Config = source.parse()?;
    let image = &mut config.image;
    (image.width, image.height) = (options.width, options.height);
    image.samples_per_pixel = options.spp;
    let geometries = Geometries::read(&mut config, source.folder(), u64::MAX);
    let scene = geometries.and_then(|geometries| Scene::new(&config, geometries));
    let scene = scene.map_err(|fault| source.point_at(fault))?;
    let accel = Accel::new(&scene, config.acceleration);
    let tracer = Tracer::new(&scene, &accel);
    let world = World {
        tracer,
        config: &config,
        counters: Meter::new(CostMode::Counters),
        time: Meter::new(CostMode::Time),
    };
    let (overhead, sum) = world.overhead_and_sum(options.rounds);
    let ratios = world.windows(options);
    let n_right = ratios
        .iter()
        .filter(|ratio| (*ratio - 1.0).abs() <= TOLERANCE);
    let (n_right, n) = (n_right.count(), ratios.len());
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    println!("{name:18} {overhead:19.3} {sum:19.3} {n_right:12} of {n}");
    Ok(json!({
        "scene": name,
        "time_over_counters": overhead,
        "sum_over_thread_time": sum,
        "window_over_map": ratios,
    }))
}

impl World<'_> {
    /// Renders the picture. Returns the CPU time, and the time that the thread spent on tiles, in
    /// nanoseconds, and the film.
    fn render(&self, meter: &Meter) -> (f64, f64, Film) {
        let sensor = self.tracer.scene.sensor(self.config);
        let plan = TilePlan::new(self.tracer, &sensor, self.config.tiles);
        let begin = ThreadTime::now();
        let (film, schedule) = render(self.tracer, &plan, meter, &|_| {});
        (begin.elapsed().as_nanos() as f64, busy_ns(&schedule), film)
    }

    /// Renders a window without a clock inside. Returns the nanoseconds of its tiles.
    fn window_ns(&self, plan: &TilePlan) -> f64 {
        let (_, schedule) = render(self.tracer, plan, &self.counters, &|_| {});
        busy_ns(&schedule)
    }

    /// Measures the least CPU time with a clock over the least with counters, and the median of the
    /// sum of the pixels' times over the time spent on tiles.
    fn overhead_and_sum(&self, n_rounds: usize) -> (f64, f64) {
        let [mut with_clock, mut with_counters] = [f64::INFINITY; 2];
        let mut sums = Vec::new();
        for _ in 0..n_rounds {
            let (ns, _, film) = self.render(&self.counters);
            with_counters = with_counters.min(ns);
            drop(black_box(film));
            let (ns, tiles_ns, film) = self.render(&self.time);
            with_clock = with_clock.min(ns);
            sums.push(film.total_time_ns() / tiles_ns);
        }
        let sum = median(&mut sums).unwrap_or_default();
        (with_clock / with_counters, sum)
    }

    /// Measures the times of windows rendered separately over their times in the map of the whole
    /// picture.
    fn windows(&self, options: &Options) -> Vec<f64> {
        let (image, scene) = (self.config.image, self.tracer.scene);
        let plan = TilePlan::new(self.tracer, &scene.sensor(self.config), self.config.tiles);
        let n = options.rounds.clamp(1, 255).to_string();
        let repeats: Repeats = n.parse().expect("a number of renderings");
        let (map, ..) = repeat(repeats, self.tracer, &plan, &self.time, &|_| {});
        let times: Vec<f32> = map.values(|strip| &strip.time_ns).collect();
        let places = places([image.width, image.height], options.windows);
        let window = |[x, y]: [u32; 2]| {
            let cropped = image.cropped([x, y, SIDE, SIDE])?;
            let sensor = scene.sensor_of(self.config, cropped);
            let rows = (y..y + SIDE).map(|y| (y * image.width + x) as usize);
            let of_row = |first: usize| &times[first..first + SIDE as usize];
            let in_map: f64 = rows.flat_map(of_row).map(|&ns| f64::from(ns)).sum();
            let plan = TilePlan::new(self.tracer, &sensor, self.config.tiles);
            let mut rendered: Vec<f64> = (0..10 * options.rounds)
                .map(|_| self.window_ns(&plan))
                .collect();
            Some(median(&mut rendered)? / in_map)
        };
        places.into_iter().filter_map(window).collect()
    }
}

/// Returns the time that threads spent on tiles, in nanoseconds.
fn busy_ns(schedule: &Schedule) -> f64 {
    schedule.runs.iter().map(TileRun::busy_ns).sum::<u64>() as f64
}

/// Returns random places of windows, the same in each run.
fn places([width, height]: [u32; 2], n: u32) -> Vec<[u32; 2]> {
    let mut state = 1_u32;
    let mut random = |n: u32| {
        // The linear congruential generator of Numerical Recipes.
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        ((u64::from(state) * u64::from(n)) >> 32) as u32
    };
    let mut side = |side: u32| random(side.saturating_sub(SIDE) + 1);
    (0..n).map(|_| [side(width), side(height)]).collect()
}
