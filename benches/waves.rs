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

use scene::build::{Geometries, Sensor};
use std::fs;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use cpu_time::ThreadTime;
use host::text::Diagnostic;
use math::statistics::median;
use render::film::Film;
use render::schedule::{Schedule, TileRun};
use render::tiles::{TilePlan, render};
use scene::config::{Config, CostMode};
use scene::yaml::Source;
use serde_json::{Value, json};
use tracer::accel::Accel;
use tracer::cost::Meter;
use tracer::trace::Tracer;

/// Pixels along a window's side.
const SIDE: u32 = 32;

/// Renderings of a window in each round; their median counts.
const WINDOW_RENDERINGS: usize = 11;

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
    /// Rounds
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

/// A window of the picture.
struct Window {
    place: [u32; 2],
    plan: TilePlan,
}

/// The measurements of a scene.
struct Measured {
    /// The least CPU time with a clock over the least with counters.
    overhead: f64,
    /// The median of the sum of the pixels' times over the time spent on tiles.
    sum: f64,
    /// The median of each window's time, rendered separately, over its time in the map.
    ratios: Vec<f64>,
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
    let scene = geometries.and_then(|geometries| scene::build::scene(&config, geometries));
    let scene = scene.map_err(|fault| source.point_at(fault))?;
    let accel = Accel::new(&scene, config.acceleration);
    let tracer = Tracer::new(&scene, &accel);
    let world = World {
        tracer,
        config: &config,
        counters: Meter::new(CostMode::Counters),
        time: Meter::new(CostMode::Time),
    };
    let Measured {
        overhead,
        sum,
        ratios,
    } = world.measure(options);
    let is_right = |ratio: &&f64| (*ratio - 1.0).abs() <= TOLERANCE;
    let (n_right, n) = (ratios.iter().filter(is_right).count(), ratios.len());
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
        let sensor = Sensor::new(self.tracer.scene, self.config);
        let plan = TilePlan::new(self.tracer, &sensor, self.config.tiles);
        let begin = ThreadTime::now();
        let (film, schedule) = render(self.tracer, &plan, meter, &|_| {});
        (begin.elapsed().as_nanos() as f64, busy_ns(&schedule), film)
    }

    /// Renders a window several times without a clock inside. Returns the median of the nanoseconds
    /// of its tiles.
    fn window_ns(&self, window: &Window) -> f64 {
        let render_once = |_| {
            let (_, schedule) = render(self.tracer, &window.plan, &self.counters, &|_| {});
            busy_ns(&schedule)
        };
        median_of((0..WINDOW_RENDERINGS).map(render_once))
    }

    /// Returns windows at random places.
    fn windows(&self, options: &Options) -> Vec<Window> {
        let window = |place: [u32; 2]| {
            let cropped = self
                .config
                .image
                .cropped([place[0], place[1], SIDE, SIDE])?;
            let sensor = Sensor::with_image(self.tracer.scene, self.config, cropped);
            let plan = TilePlan::new(self.tracer, &sensor, self.config.tiles);
            Some(Window { place, plan })
        };
        let places = places([options.width, options.height], options.windows);
        places.into_iter().filter_map(window).collect()
    }

    /// Measures the clock in rounds: each renders the picture with counters and with the clock, and
    /// then the windows, so that a window and its map share what disturbs the machine.
    fn measure(&self, options: &Options) -> Measured {
        let windows = self.windows(options);
        let [mut with_counters, mut with_clock] = [f64::INFINITY; 2];
        let mut sums = Vec::new();
        let mut ratios = vec![Vec::new(); windows.len()];
        for _ in 0..options.rounds.max(1) {
            let (ns, _, film) = self.render(&self.counters);
            with_counters = with_counters.min(ns);
            drop(black_box(film));
            let (ns, tiles_ns, map) = self.render(&self.time);
            with_clock = with_clock.min(ns);
            sums.push(map.total_time_ns() / tiles_ns);
            let times: Vec<f32> = map.values(|strip| &strip.time_ns).collect();
            for (window, ratios) in windows.iter().zip(&mut ratios) {
                ratios.push(self.window_ns(window) / window.ns_in(&times, options.width));
            }
        }
        Measured {
            overhead: with_clock / with_counters,
            sum: median_of(sums),
            ratios: ratios.into_iter().map(median_of).collect(),
        }
    }
}

impl Window {
    /// Returns the nanoseconds of its pixels in a map of the picture.
    fn ns_in(&self, times: &[f32], width: u32) -> f64 {
        let [x, y] = self.place;
        let rows = (y..y + SIDE).map(|y| (y * width + x) as usize);
        let of_row = |first: usize| &times[first..first + SIDE as usize];
        rows.flat_map(of_row).map(|&ns| f64::from(ns)).sum()
    }
}

/// Returns the median, or 0 without values.
fn median_of(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    median(&mut values).unwrap_or_default()
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
