//! `summary.json`: the scene, the machine, and the total cost.

use indexmap::IndexMap;
use serde_json::Number;

use super::file::{FileContent, OutputFile, WriterInput};
use super::{RenderingView, Survey, thread_time, time_notes};
use crate::summary::{
    AccelerationSection, CostSection, FileEntry, FilmSection, FrameSection, KernelEntry, Machine,
    ObjectEntry, RepeatsSection, SceneSection, StageEntry, Summary,
};
use base::Keyword;
use base::numbers::milliseconds;
use host::folder::SUMMARY;
use render::film::Film;
use render::instruments::peak_memory_bytes;
use scene::config::{CostMode, Traversal};
use tracer::cost::{KernelWork, Metric, MetricSource, RayKind};

/// The file.
pub(super) const FILE: OutputFile = OutputFile {
    name: SUMMARY,
    is_wanted: |_| true,
    content: FileContent::Written(|job, out| summarize(job).write(out)),
};

/// Summarizes a rendering whose other files are written.
fn summarize(job: &WriterInput) -> Summary {
    let (rendering, stages) = (job.rendering, job.stages);
    let config = rendering.config;
    Summary {
        raycost: env!("CARGO_PKG_VERSION").to_owned(),
        run: Some(job.run),
        scene: SceneSection {
            name: rendering.name.to_owned(),
            file: rendering.scene_file.to_owned(),
            set: rendering.settings.clone(),
        },
        frame: rendering.frame.map(|frame| FrameSection {
            states: serde_json::to_value(job.states.values()).unwrap_or_default(),
            ..frame.clone()
        }),
        partial: rendering.partial,
        image: (&config.image).into(),
        film: FilmSection::new(&config.film, config.shading.model),
        camera: Some((&rendering.image_plane()).into()),
        objects: objects(rendering),
        materials: config.materials.keys().cloned().collect(),
        n_primitives: rendering.scene.world().n_primitives() as u64,
        n_instances: rendering
            .scene
            .instances
            .as_ref()
            .map(|instances| instances.n_instances() as u64),
        n_degenerate_triangles: Some(rendering.scene.n_degenerate),
        acceleration: AccelerationSection::new(
            config.acceleration,
            rendering.bvh,
            rendering.simd,
            rendering.traversal,
            rendering.device,
            kernels(job),
        ),
        machine: Machine::current(),
        build: Some(rendering.build.clone()),
        threads: rendering.threads.clone(),
        ranks: rendering.ranks.cloned(),
        other_runs: rendering.other_runs.cloned(),
        stages: stages.ended.iter().map(StageEntry::from).collect(),
        repeats: Some(repeats(rendering)),
        thread_time: thread_time(rendering),
        time_notes: time_notes(rendering),
        no_hardware_counters: stages.no_hardware_counters().map(str::to_owned),
        no_energy: stages.no_energy().map(str::to_owned),
        peak_memory_bytes: peak_memory_bytes(),
        n_pixels: Some(config.image.n_pixels() as u64),
        n_hits: rendering.survey.n_hits,
        n_below_noise: rendering.n_below_noise(),
        cost: cost(rendering),
        schedule: Some(rendering.schedule.into()),
        compress: Some(config.compress),
        arrays: config
            .output
            .arrays()
            .map(|chosen| chosen.iter().map(|array| array.name().to_owned()).collect()),
        files: job.written.iter().map(FileEntry::from).collect(),
    }
}

fn kernels(job: &WriterInput) -> Vec<KernelEntry> {
    let n_threads = job.rendering.threads.used as f64;
    let all_s = n_threads * job.stages.wall("render").as_secs_f64();
    let device = job.rendering.device.into_iter();
    let kernels = device.flat_map(|device| &device.kernels);
    let entry = |work: &KernelWork| KernelEntry {
        share: work.seconds / all_s,
        work: work.clone(),
    };
    kernels.map(entry).collect()
}

fn objects(rendering: &RenderingView) -> Vec<ObjectEntry> {
    let object = |object: &scene::config::Object| ObjectEntry {
        name: object.name.clone(),
        kind: object.geometry.to_string(),
        materials: object.material.0.clone(),
    };
    rendering.config.objects.iter().map(object).collect()
}

fn repeats(rendering: &RenderingView) -> RepeatsSection {
    let repeats = rendering.repeats;
    let wall_ms = repeats.iter().map(|repeat| milliseconds(repeat.wall));
    RepeatsSection {
        asked: Some(rendering.config.repeats),
        n: repeats.len(),
        busy_ns: repeats.iter().filter_map(|one| one.pixels_ns).collect(),
        wall_ms: wall_ms.collect(),
    }
}

/// Returns the name of the traversal kernel.
fn kernel(rendering: &RenderingView) -> &'static str {
    let is_single =
        rendering.film.cost == CostMode::SingleRayTime || rendering.traversal == Traversal::Single;
    if is_single { "single_ray" } else { "stream" }
}

fn cost(rendering: &RenderingView) -> CostSection {
    let film = rendering.film;
    let seconds = rendering.median_wall().as_secs_f64();
    let has_counters = film.cost.has_counters();
    CostSection {
        mode: film.cost,
        kernel: Some(kernel(rendering).to_owned()),
        clock: rendering.meter.clock().map(Into::into),
        totals: has_counters.then(|| {
            let mut totals = totals(film, rendering.survey);
            let idle = rendering.lanes.zip(film.extra.lanes);
            totals.extend(idle.map(|(idle, warps)| {
                let share = Number::from_f64(idle.share(warps));
                (Metric::IDLE_LANES.name.to_owned(), share)
            }));
            let cycles = film.extra.cycles.then(|| film.metric(Metric::CYCLES));
            totals.extend(cycles.map(|cycles| {
                let sum = cycles.into_iter().map(f64::from).sum();
                (Metric::CYCLES.name.to_owned(), Number::from_f64(sum))
            }));
            totals
        }),
        metrics: (film.extra.metrics.list().iter())
            .map(|metric| (metric.name.clone(), metric.definition.clone()))
            .collect(),
        mrays_per_second: has_counters.then(|| film.totals.n_rays() as f64 / seconds / 1e6),
    }
}

/// Returns the sums of the film's arrays, by the arrays' names.
pub fn totals(film: &Film, survey: &Survey) -> IndexMap<String, Option<Number>> {
    let mut totals = IndexMap::new();
    let has = |metric: &Metric| match metric.source {
        MetricSource::Observed(_) => film.extra.tests,
        _ => *metric != Metric::SAMPLES || film.counts_samples(),
    };
    for metric in Metric::ALL.into_iter().filter(has) {
        let total = match metric.source {
            MetricSource::Clock => {
                let is_measured = Metric::measured_by(film.cost) == Some(metric);
                let time_ns = is_measured.then_some(survey.time_ns);
                time_ns.and_then(Number::from_f64)
            }
            MetricSource::Observed(counter) => Some(film.total_steps(counter).into()),
            _ => Some(metric.value(&film.totals).into()),
        };
        totals.insert(metric.name.to_owned(), total);
        if metric.source == MetricSource::AllRays {
            // Camera rays are not a metric of every film: all pixels may have the same number.
            let camera_rays = film.totals.rays_of(RayKind::Camera);
            totals.insert("camera_rays".to_owned(), Some(camera_rays.into()));
        }
    }
    for ratio in Metric::ratios(film.extra.metrics) {
        let total = |part: Metric| totals.get(part.name)?.as_ref()?.as_f64();
        let parts = ratio.parts().map(|parts| parts.map(total));
        let whole = match parts {
            Some([Some(above), Some(below)]) => Number::from_f64(above / below),
            _ => None,
        };
        totals.insert(ratio.name.to_owned(), whole);
    }
    totals
}
