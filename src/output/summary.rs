//! `summary.json`: what was done, on what, and what it cost in all.

use std::io::{self, Write};
use std::time::{Duration, Instant};

use cpu_time::ProcessTime;
use serde::Serialize;
use serde_json::{Value, json};
use sysinfo::System;

use super::hardware::{Counts, HardwareCounters};
use super::resources::{self, SystemWork};
use super::{Rendering, Written};
use crate::config::Acceleration;
use crate::cost::RayKind;
use crate::film::Film;

/// The file's name.
pub(super) const FILE: &str = "summary.json";

/// How many threads rendered.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Threads {
    /// In this run.
    pub used: usize,
    /// That the machine has.
    pub available: usize,
}

/// A part of the run and its time.
#[derive(Debug, Clone, Serialize)]
pub struct Stage {
    /// What was done.
    pub name: &'static str,
    /// Time on the wall, in milliseconds.
    pub wall_ms: f64,
    /// Time of all threads together, in milliseconds.
    pub cpu_ms: f64,
    /// What the operating system had to do in it, where that is known.
    #[serde(flatten)]
    pub system: Option<SystemWork>,
    /// What the processor counted in it; empty where it counts nothing.
    pub events: Counts,
}

/// To a thousandth.
pub(super) fn milliseconds(elapsed: Duration) -> f64 {
    (elapsed.as_secs_f64() * 1e6).round() / 1e3
}

/// A stopwatch that is pressed at the end of each stage.
#[derive(Debug)]
pub struct Stages {
    wall: Instant,
    cpu: ProcessTime,
    system: Option<SystemWork>,
    hardware: HardwareCounters,
    counts: Counts,
    /// The stages that have ended.
    pub ended: Vec<Stage>,
}

impl Stages {
    /// Starts the first stage now, watched by these counters.
    pub fn start(mut hardware: HardwareCounters) -> Self {
        Self {
            counts: hardware.read(),
            hardware,
            wall: Instant::now(),
            cpu: ProcessTime::now(),
            system: SystemWork::so_far(),
            ended: Vec::new(),
        }
    }

    /// Ends the running stage and starts the next one.
    pub fn end(&mut self, name: &'static str) {
        let system = SystemWork::so_far();
        let counts = self.hardware.read();
        let before = |name| self.counts.get(name).copied().unwrap_or_default();
        let events = counts
            .iter()
            .map(|(name, count)| (*name, count - before(name)));
        let events = events.collect();
        self.ended.push(Stage {
            name,
            wall_ms: milliseconds(self.wall.elapsed()),
            cpu_ms: milliseconds(self.cpu.elapsed()),
            system: system
                .zip(self.system)
                .map(|(now, before)| now.since(before)),
            events,
        });
        (self.wall, self.cpu) = (Instant::now(), ProcessTime::now());
        (self.system, self.counts) = (system, counts);
    }

    /// Time on the wall of the stage with this name; zero if it never was.
    pub fn wall(&self, name: &str) -> Duration {
        let stage = self.ended.iter().find(|stage| stage.name == name);
        Duration::from_secs_f64(stage.map_or(0.0, |stage| stage.wall_ms / 1e3))
    }
}

/// Writes the summary as indented JSON.
pub(super) fn write(
    rendering: &Rendering,
    stages: &Stages,
    files: &[Written],
    out: &mut impl Write,
) -> io::Result<()> {
    let config = rendering.config;
    let image = &config.image;
    let summary = json!({
        "raycost": env!("CARGO_PKG_VERSION"),
        "scene": { "name": rendering.name, "file": rendering.scene_file },
        "image": {
            "width": image.width,
            "height": image.height,
            "samples_per_pixel": image.samples_per_pixel,
            "seed": image.seed,
        },
        "objects": objects(rendering),
        "materials": config.materials.keys().collect::<Vec<_>>(),
        "n_primitives": rendering.scene.primitives.len(),
        "n_degenerate_triangles": rendering.scene.n_degenerate,
        "acceleration": acceleration(rendering),
        "machine": machine(),
        "build": build(),
        "threads": rendering.threads,
        "stages": stages.ended,
        "no_hardware_counters": stages.hardware.why_not(),
        "peak_memory_bytes": resources::peak_memory_bytes(),
        "n_pixels": image.n_pixels(),
        "n_hits": rendering.film.n_hits(),
        "cost": cost(rendering, stages),
        "files": files,
    });
    serde_json::to_writer_pretty(&mut *out, &summary)?;
    writeln!(out)
}

/// What was measured, how, and the sums of it.
fn cost(rendering: &Rendering, stages: &Stages) -> Value {
    let film = rendering.film;
    let clock = rendering
        .meter
        .clock()
        .map(|clock| json!({ "source": clock.source_name(), "overhead_ns": clock.overhead_ns() }));
    let seconds = stages.wall("render").as_secs_f64();
    let has_counters = film.cost.has_counters();
    json!({
        "mode": film.cost,
        "kernel": film.cost.kernel(),
        "clock": clock,
        "totals": has_counters.then(|| totals(film)),
        "mrays_per_second": has_counters.then(|| film.totals.n_rays() as f64 / seconds / 1e6),
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
    })
}
