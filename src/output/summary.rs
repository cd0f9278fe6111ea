//! `summary.json`: what was done, on what, and what it cost in all.

use std::io::{self, Write};

use serde::Serialize;
use serde_json::{Value, json};
use sysinfo::System;

use super::{Accounts, Rendering};
use crate::camera::{ImagePlane, Projection};
use crate::config::Acceleration;
use crate::cost::RayKind;
use crate::film::Film;
use crate::folder::Written;
use crate::instruments::{Stages, peak_memory_bytes};
use crate::provenance::{KEY, RunId, checksum};
use crate::render::{N_ROUNDS, Overhead};
use crate::schedule::Schedule;
use crate::text::numbers::milliseconds;

/// The file's name.
/// The key of its own checksum.
const SEAL: &str = "checksum";

/// How many threads rendered.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Threads {
    /// In this run.
    pub used: usize,
    /// That the machine has.
    pub available: usize,
}

/// Writes the summary as indented JSON.
pub(super) fn write(
    rendering: &Rendering,
    stages: &Stages,
    files: &[Written],
    run: RunId,
    out: &mut impl Write,
) -> io::Result<()> {
    let config = rendering.config;
    let image = &config.image;
    let summary = json!({
        "raycost": env!("CARGO_PKG_VERSION"),
        KEY: run,
        "scene": { "name": rendering.name, "file": rendering.scene_file },
        "image": {
            "width": image.width,
            "height": image.height,
            "samples_per_pixel": image.samples_per_pixel,
            "seed": image.seed,
        },
        "camera": camera(&rendering.scene.image_plane),
        "objects": objects(rendering),
        "materials": config.materials.keys().collect::<Vec<_>>(),
        "n_primitives": rendering.scene.primitives.len(),
        "n_degenerate_triangles": rendering.scene.n_degenerate,
        "acceleration": acceleration(rendering),
        "machine": machine(),
        "build": build(),
        "threads": rendering.threads,
        "stages": stages.ended,
        "repeats": repeats(rendering),
        "thread_time": thread_time(rendering),
        "overhead": rendering.overhead.as_ref().map(overhead),
        "no_hardware_counters": stages.no_hardware_counters(),
        "peak_memory_bytes": peak_memory_bytes(),
        "n_pixels": image.n_pixels(),
        "n_hits": rendering.film.n_hits(),
        "cost": cost(rendering),
        "schedule": schedule(rendering.schedule),
        "compress": config.compress,
        "files": files,
    });
    let text = serde_json::to_string_pretty(&summary)?;
    out.write_all(sealed(&text).as_bytes())
}

/// The text of an object with a last key of its own: the checksum of all bytes
/// before the key.
fn sealed(object: &str) -> String {
    let begin = object.trim_end_matches(['\n', '}']);
    let checksum = checksum(format!("{begin},\n").as_bytes());
    format!("{begin},\n  \"{SEAL}\": \"{checksum}\"\n}}\n")
}

/// Whether the text of a summary is as it was written; `None` where it has no
/// checksum.
pub(crate) fn is_whole(text: &str) -> Option<bool> {
    let (begin, seal) = text.rsplit_once(&format!("  \"{SEAL}\": \""))?;
    let seal = seal.strip_suffix("\"\n}\n");
    Some(seal == Some(&checksum(begin.as_bytes()).to_string()))
}

/// Where the pixels lie in the world: the sample point of the one on top left,
/// the steps to the next column and row, and where the rays come from.
fn camera(plane: &ImagePlane) -> Value {
    let (eye, direction) = match plane.projection {
        Projection::Perspective { eye } => (Some(eye.to_array()), None),
        Projection::Parallel { direction } => (None, Some(direction.to_array())),
    };
    json!({
        "eye": eye,
        "direction": direction,
        "origin": plane.origin.to_array(),
        "right": plane.right.to_array(),
        "down": plane.down.to_array(),
    })
}

/// What was measured, how, and the sums of it.
fn cost(rendering: &Rendering) -> Value {
    let film = rendering.film;
    let clock = rendering
        .meter
        .clock()
        .map(|clock| json!({ "source": clock.source_name(), "overhead_ns": clock.overhead_ns() }));
    let seconds = rendering.median_wall().as_secs_f64();
    let has_counters = film.cost.has_counters();
    json!({
        "mode": film.cost,
        "kernel": film.cost.kernel(),
        "clock": clock,
        "totals": has_counters.then(|| totals(film)),
        "mrays_per_second": has_counters.then(|| film.totals.n_rays() as f64 / seconds / 1e6),
    })
}

/// Each rendering by itself. Times are those of all pixels together; there are
/// none where none were measured.
fn repeats(rendering: &Rendering) -> Value {
    let repeats = rendering.repeats;
    let busy_ns = repeats.iter().filter_map(|repeat| repeat.pixels_ns);
    let wall_ms = repeats.iter().map(|repeat| milliseconds(repeat.wall));
    json!({
        "asked": rendering.config.repeats,
        "n": repeats.len(),
        "busy_ns": busy_ns.collect::<Vec<_>>(),
        "wall_ms": wall_ms.collect::<Vec<_>>(),
        "n_rejected": repeats.iter().map(|repeat| repeat.n_rejected).sum::<u64>(),
    })
}

fn thread_time(rendering: &Rendering) -> Option<Value> {
    let accounts = Accounts::of(rendering)?;
    let mut value = json!(accounts);
    value["unexplained_percent"] = accounts.percent(accounts.unexplained_ns).into();
    Some(value)
}

fn overhead(overhead: &Overhead) -> Value {
    json!({
        "rounds": N_ROUNDS,
        "none_ms": overhead.none_ms,
        "counters_ms": overhead.counters_ms,
        "single_ray_ms": overhead.single_ray_ms,
        "time_ms": overhead.time_ms,
        "counters_percent": overhead.counters_percent(),
        "single_ray_percent": overhead.single_ray_percent(),
        "clock_percent": overhead.clock_percent(),
        "time_percent": overhead.time_percent(),
    })
}

/// How the tiles were dealt out.
fn schedule(schedule: &Schedule) -> Value {
    let load = schedule.load();
    json!({
        "tile_size": schedule.grid.tile_size,
        "order": schedule.order,
        "n_tiles": schedule.grid.n_tiles(),
        "load_imbalance": load.load_imbalance,
        "idle_share": load.idle_share,
    })
}

fn acceleration(rendering: &Rendering) -> Value {
    let (kind, quality) = match rendering.config.acceleration {
        Acceleration::Bvh(quality) => ("bvh", Some(quality)),
        Acceleration::BruteForce => ("brute_force", None),
    };
    json!({ "kind": kind, "quality": quality, "bvh": rendering.bvh })
}

fn objects(rendering: &Rendering) -> Value {
    let object = |object: &crate::config::Object| {
        json!({
            "name": object.name,
            "kind": object.geometry.to_string(),
            "materials": object.material.0,
        })
    };
    rendering.config.objects.iter().map(object).collect()
}

/// The sums of the film's arrays, by the arrays' names.
fn totals(film: &Film) -> Value {
    let totals = &film.totals;
    json!({
        "time_ns": film.cost.has_time().then(|| film.total_time_ns()),
        "node_visits": totals.node_visits,
        "primitive_tests": totals.primitive_tests,
        "rays": totals.n_rays(),
        "camera_rays": totals.rays_of(RayKind::Camera),
        "shadow_rays": totals.rays_of(RayKind::Shadow),
        "reflection_rays": totals.rays_of(RayKind::Reflection),
        "refraction_rays": totals.rays_of(RayKind::Refraction),
        "depth": totals.depth,
    })
}

/// What made this program.
pub fn build() -> Value {
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "commit": option_env!("RAYCOST_COMMIT"),
        "compiler": env!("RAYCOST_COMPILER"),
        "profile": env!("RAYCOST_PROFILE"),
        "flags": env!("RAYCOST_FLAGS"),
    })
}

/// What this program runs on.
pub fn machine() -> Value {
    let mut system = System::new();
    system.refresh_cpu_list(sysinfo::CpuRefreshKind::nothing());
    let cpu = system.cpus().first().map(|cpu| cpu.brand().trim());
    json!({
        "os": System::long_os_version(),
        "arch": std::env::consts::ARCH,
        "cpu": cpu,
        "logical_cpus": std::thread::available_parallelism().ok(),
    })
}
