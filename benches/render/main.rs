//! Rays per second of whole renderings in each cost mode: `cargo bench --bench render [-- SCENE …]
//! [-- --json FILE]`.
//!
//! Takes scene files and folders of them; by default `configs/`. Renders on one thread; the modes
//! take turns in one process, so that a drift of the machine affects all of them equally. Prints
//! medians and, in brackets, the speed relative to the first mode: the gain of streams, and the
//! cost of counters and of the clock of waves.

mod scenes;

use scene::build::{Geometries, Sensor};
use std::fs;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use host::text::Diagnostic;
use math::statistics::median;
use render::tiles::{TilePlan, render};
use scene::config::{Config, CostMode};
use scene::yaml::Source;
use serde_json::{Value, json};
use tracer::accel::Accel;
use tracer::cost::Meter;
use tracer::trace::Tracer;
use world::scene::Scene;

const N_ROUNDS: usize = 9;
const MODES: [CostMode; 4] = [
    CostMode::SingleRayTime,
    CostMode::Time,
    CostMode::Counters,
    CostMode::None,
];

#[derive(Parser)]
struct Options {
    /// Scene files, and folders of them [default: configs]
    scenes: Vec<PathBuf>,
    /// Also write the results to this file
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// `cargo bench` passes it
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> ExitCode {
    match race() {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}

fn race() -> Result<(), String> {
    let options = Options::parse();
    let scenes = scenes::named(options.scenes)?;
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1);
    let pool = one_thread.build().map_err(|error| error.to_string())?;
    println!("Mrays/s, one thread, medians of {N_ROUNDS} rounds");
    let mut rows = Vec::new();
    for scene in scenes {
        let row = pool.install(|| compare(&scene));
        rows.push(row.map_err(|error| error.to_string())?);
    }
    if let Some(path) = options.json {
        let made_by = raycost::session::this_build();
        let results = json!({ "rows": rows, "made_by": made_by });
        fs::write(&path, format!("{results:#}"))
            .map_err(|error| format!("{}: {error}", path.display()))?;
    }
    Ok(())
}

fn read(path: &Path) -> Result<(Config, Scene), Diagnostic> {
    let source = Source::read(path)?;
    let mut config: Config = source.parse()?;
    let geometries = Geometries::read(&mut config, source.folder(), u64::MAX);
    let scene = geometries.and_then(|geometries| scene::build::scene(&config, geometries));
    Ok((config, scene.map_err(|fault| source.point_at(fault))?))
}

fn compare(path: &Path) -> Result<Value, Diagnostic> {
    let (config, scene) = read(path)?;
    let accel = Accel::new(&scene, config.acceleration);
    let tracer = Tracer::new(&scene, &accel);
    let plan = TilePlan::new(tracer, &Sensor::new(&scene, &config), config.tiles);
    let meters = MODES.map(Meter::new);
    let mut times = [[0.0; N_ROUNDS]; MODES.len()];
    let mut n_rays = 0;
    for round in 0..N_ROUNDS {
        for (meter, times) in meters.iter().zip(&mut times) {
            let start = Instant::now();
            let (film, _) = render(tracer, &plan, meter, &|_| {});
            times[round] = start.elapsed().as_secs_f64();
            n_rays = n_rays.max(black_box(film).totals.n_rays());
        }
    }
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    print!("{name:18} {n_rays:9} rays");
    let medians = times.map(|mut times| median(&mut times).unwrap_or_default());
    for (mode, seconds) in MODES.iter().zip(medians) {
        let speed = n_rays as f64 / seconds / 1e6;
        let relative = medians[0] / seconds;
        print!("   {mode:?} {speed:6.2} ({relative:.2})");
    }
    println!();
    let [single_ray_time, time, counters, none] = medians;
    Ok(json!({
        "scene": name,
        "n_rays": n_rays,
        "seconds": {
            "single_ray_time": single_ray_time,
            "time": time,
            "counters": counters,
            "none": none,
        },
    }))
}
