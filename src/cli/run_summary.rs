//! The summary of a run, printed at the end of `raycost render`.

use std::time::Duration;

use super::scene::SceneArguments;
use super::{charges, hints, hottest, lanes, names_and_lengths, shell_word, shown, timing_quality};
use base::Keyword;
use base::numbers::{bytes, count, counted, duration};
use host::folder::Written;
use host::text::{one_line, wrapped};
use output::look::Look;
use output::summary::RanksSection;
use output::writers::{FRAME_PVTI, FRAME_VTI, GEOMETRY, HEATMAP, RenderingView, is_piece};
use render::instruments::Stages;
use render::schedule::Schedule;
use scene::build::Sensor;
use scene::config::{Config, OptionalOutput};
use tracer::cost::{KernelWork, RayKind};
use world::scene::Scene;

/// Returns the lines on the picture, the stages and the speed.
pub(super) fn head(rendering: &RenderingView, stages: &Stages) -> String {
    let image = &rendering.config.image;
    let times: Vec<String> = stages
        .ended
        .iter()
        .map(|stage| format!("{} {}", stage.name, duration(stages.wall(stage.name))))
        .collect();
    let device = rendering.device;
    let device = device.map_or(String::new(), |device| {
        let kernels: String = device.kernels.iter().map(kernel).collect();
        let work = match &device.processor_shades_because_of {
            None => "follows whole paths".to_owned(),
            Some(part) => format!("traces rays; the processor shades because of {part}"),
        };
        format!("device  {}\n        {work}\n{kernels}", device.name)
    });
    format!(
        "image   {} x {} pixels, {} per pixel, {}, {}\n\
         {device}\
         time    {}\n\
         speed   {}\n",
        image.width,
        image.height,
        image.samples(),
        primitives(rendering.scene),
        counted(rendering.threads.used as u64, "thread"),
        times.join(", "),
        speed(rendering),
    )
}

/// Returns the line on the launches of a kernel.
fn kernel(work: &KernelWork) -> String {
    let time = duration(Duration::from_secs_f64(work.seconds));
    let rays = counted(work.rays, "ray");
    let per_launch = count(work.rays / work.launches.max(1));
    let idle = work.idle_share().zip(work.warp_size);
    let idle = idle.map_or(String::new(), |(share, warp)| {
        format!(", {:.1} % of lanes idle in warps of {warp}", 100.0 * share)
    });
    format!(
        "        {} {time}, {rays}, {per_launch} per launch{idle}\n",
        work.name
    )
}

/// Returns the summary of a rendered scene and the files written.
pub(super) fn lines(
    scene: &SceneArguments,
    rendering: &RenderingView,
    look: Option<Look>,
    stages: &Stages,
    written: &[Written],
) -> String {
    let out = scene.out();
    let trace = hottest::trace_command(scene, rendering.survey.hottest);
    let trace = trace.map_or(String::new(), |trace| format!("        {trace}\n"));
    let keep = scene.command_to_keep();
    let keep = keep.map_or(String::new(), |command| format!("keep    {command}\n"));
    let files = list_files(written);
    let costs = match rendering.attribution {
        Some(attribution) if rendering.config.output.has(OptionalOutput::Objects) => {
            charges::tables(rendering, attribution)
        }
        _ => String::new(),
    };
    let idle = rendering.lanes.zip(rendering.film.extra.lanes);
    let lanes = idle.map_or(String::new(), |(idle, warps)| lanes::table(idle, warps));
    let best = [HEATMAP, GEOMETRY, FRAME_VTI, FRAME_PVTI].map(|file| file.name);
    let is_written = |name: &&str| written.iter().any(|file| file.file == *name);
    let next = best.into_iter().find(is_written).unwrap_or_default();
    let option = if next.ends_with(".pvsm") {
        "--state="
    } else {
        ""
    };
    let quality = timing_quality::lines(rendering);
    let tiles = if rendering.config.output.has(OptionalOutput::Schedule) {
        tiles(rendering.schedule)
    } else {
        String::new()
    };
    let ranks = rendering.ranks.map_or(String::new(), ranks);
    let found = format!(
        "{}{tiles}{ranks}{}{quality}{}{costs}{lanes}{}{}wrote   {}: {files}\n",
        head(rendering, stages),
        noise(rendering),
        hottest::lines(rendering.survey.hottest),
        notes(rendering.config, rendering.scene),
        hints::lines(rendering.config, look),
        shown(&out),
    );
    // Commands stay on one line, to be copied.
    format!(
        "{}next    paraview {option}{}\n{trace}{keep}",
        wrapped(&found),
        shell_word(&out.join(next)),
    )
}

/// Displacements of rays by at least this many pixels are visible at edges.
const VISIBLE: f32 = 0.05;

/// Returns a line about each requested output that has nothing to show, about what the files of
/// meshes may have meant otherwise, and about an eye that is too far away.
pub(super) fn notes(config: &Config, scene: &Scene) -> String {
    let line = |output: &OptionalOutput| {
        let name = output.name();
        format!("`{name}` is left out: `brute_force` has no hierarchy")
    };
    let left_out = config.output.left_out().iter().map(line);
    let of_files = scene.notes.iter().map(|note| one_line(note).into_owned());
    let displacement = Sensor::new(scene, config).plane.displacement();
    let of_eye = (displacement >= VISIBLE).then(|| {
        format!(
            "the eye is so far from the objects that rays of 32 bits are off by up to \
             {displacement:.2} pixels: move it nearer, and widen a narrow angle of view"
        )
    });
    let notes = left_out.chain(of_files).chain(of_eye);
    notes.map(|note| format!("note    {note}\n")).collect()
}

/// Returns the names and the lengths of the files; pieces are added up.
fn list_files(written: &[Written]) -> String {
    let (pieces, files): (Vec<_>, Vec<_>) = written.iter().partition(|one| is_piece(&one.file));
    let n_bytes = pieces.iter().map(|piece| piece.bytes).sum();
    let of_pieces = match pieces.len() as u64 {
        0 => None,
        n => Some(format!("{} ({})", counted(n, "piece"), bytes(n_bytes))),
    };
    let mut list = names_and_lengths(files);
    list.extend(of_pieces);
    list.join(", ")
}

/// Returns "1,234 primitives", and the number of omitted triangles.
pub(super) fn primitives(scene: &Scene) -> String {
    let world = scene.world();
    let mut kept = counted(world.n_primitives() as u64, "primitive");
    if let Some(instances) = world.instances {
        kept += &format!(
            ", {} of {}",
            counted(instances.n_instances() as u64, "instance"),
            counted(instances.n_placed(), "triangle")
        );
    }
    match scene.n_degenerate {
        0 => kept,
        n => format!("{kept} ({} without area left out)", counted(n, "triangle")),
    }
}

/// Returns the share of the pixels whose noise is below the limit, or the mean number of samples by
/// efficiency; empty without adaptive sampling.
fn noise(rendering: &RenderingView) -> String {
    let (film, image) = (rendering.film, &rendering.config.image);
    let Some(adaptive) = image.adaptive.filter(|_| film.cost.has_counters()) else {
        return String::new();
    };
    let Some(noise) = adaptive.noise else {
        return samples(rendering);
    };
    let Some(n_below) = rendering.n_below_noise() else {
        let least = counted(adaptive.min_samples.into(), "sample");
        return format!(
            "noise   not compared with {noise}: it takes more than {least}, by `--spp`\n"
        );
    };
    let n_pixels = image.n_pixels() as u64;
    let pixels = match 100.0 * n_below as f64 / n_pixels as f64 {
        _ if n_below == n_pixels => "all pixels".to_owned(),
        percent if rendering.partial.is_some() => format!("{percent:.2} % of the pixels"),
        percent => {
            let most = counted(image.samples_per_pixel.into(), "sample");
            format!("{percent:.2} % of the pixels; the others have {most}")
        }
    };
    format!("noise   below {noise} in {pixels}\n")
}

/// Returns the mean number of samples of the pixels that were rendered.
fn samples(rendering: &RenderingView) -> String {
    let schedule = rendering.schedule;
    let tiles = schedule
        .rendered()
        .map(|(number, _)| schedule.grid.tile(number));
    let n_pixels: usize = tiles.map(|tile| tile.n_pixels()).sum();
    let n_samples = rendering.film.totals.rays_of(RayKind::Camera);
    let mean = n_samples as f64 / n_pixels.max(1) as f64;
    format!("samples {mean:.1} per pixel, by efficiency\n")
}

/// Returns the ranks, their load balance and their communication.
fn ranks(ranks: &RanksSection) -> String {
    let communication_ms: f64 = ranks.of_rank.iter().map(|rank| rank.communication_ms).sum();
    format!(
        "ranks   {}, load imbalance {:.1} %, {} sent, {} of communication\n",
        ranks.n,
        100.0 * ranks.load_imbalance,
        bytes(ranks.sent_bytes),
        duration(Duration::from_secs_f64(communication_ms / 1e3)),
    )
}

/// Returns the tiles and the load balance of the threads.
fn tiles(schedule: &Schedule) -> String {
    let grid = &schedule.grid;
    let load = schedule.load();
    format!(
        "tiles   {} of {size} x {size}, {} order, load imbalance {:.1} %, {:.1} % idle\n",
        count(grid.n_tiles().into()),
        schedule.order.name(),
        100.0 * load.load_imbalance,
        100.0 * load.idle_share,
        size = grid.tile_size,
    )
}

/// Returns rays per second, or samples per second if rays were not counted.
fn speed(rendering: &RenderingView) -> String {
    // A partial picture without tiles took no time.
    let seconds = rendering.median_wall().as_secs_f64().max(1e-9);
    let millions = |n: u64| n as f64 / seconds / 1e6;
    if rendering.film.cost.has_counters() {
        let n_rays = rendering.film.totals.n_rays();
        format!("{:.1} Mrays/s, {} rays", millions(n_rays), count(n_rays))
    } else {
        let image = &rendering.config.image;
        if image.adaptive.is_some() {
            return "rays were not counted".to_owned();
        }
        let n_samples = image.n_pixels() as u64 * u64::from(image.samples_per_pixel);
        format!(
            "{:.1} million samples/s; rays were not counted",
            millions(n_samples)
        )
    }
}
