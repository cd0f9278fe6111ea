//! The tile loop: scene → film, on all threads.
//!
//! Each thread takes one tile after the other and renders it in one of two ways: `stream` traces
//! many rays together, which hides the latency of memory, and times their waves; `timed` traces
//! rays one by one, so that each pixel can be timed separately. Both give the same pixels and the
//! same counters.

mod canvas;
mod pass;
mod tile_batch;
mod tile_queue;
mod deal;
mod worker;
mod rounds;
mod view;
mod camera_rays;
mod noisy_pixels;
mod stream;
mod prepass;
mod sample_plan;
mod planned;
mod follow;
mod timed;
mod time_hottest;
mod wave_times;
mod groups;
mod tile_times;
mod tile_plan;
mod samples;
mod repeat;
mod recount;
mod stored;

use std::ops::Range;
use std::sync::{OnceLock, mpsc};
use std::thread;
use std::time::Instant;

use rayon::prelude::*;

use crate::film::{Film, Rendered};
use crate::ranks::RankFailure;
use crate::schedule::{MAX_PIXELS, Schedule, Tile, TileRun};
use canvas::Canvas;
use deal::{MAX_BATCHES, deal};
pub(crate) use follow::{PathProbe, follow, follow_sample};
use groups::GroupRenderer;
use host::start_in_scope;
use pass::Pass;
use planned::planned;
pub(crate) use recount::recount;
pub(crate) use rounds::Rounds;
pub(crate) use sample_plan::rounds_of;
pub use sample_plan::with_samples_planned;
use stream::StreamRenderer;
use tile_queue::{Target, TileQueue};
use timed::SingleRayRenderer;
use tracer::cost::{Counters, Meter, NoProbe, Stopwatch};
use tracer::trace::Tracer;
pub use view::View;

pub use pass::Limits;
pub use repeat::{LEAST_GRIDS, Repeat, repeat, repeat_within};
pub use repeat::{least_repeats, most_repeats, repeat_bytes_per_pixel};
pub use stored::StoredPicture;
pub use tile_plan::TilePlan;
pub use tile_times::estimate_times;
pub use worker::work;

/// The work done since the last report.
#[derive(Debug, Clone, Copy, Default)]
pub struct Progress {
    /// Pixels.
    pub n_pixels: u64,
    /// Rays; 0 if they are not counted.
    pub n_rays: u64,
    /// The work as estimated before the rendering, in pixels of average cost: over all reports, it
    /// adds up to the number of pixels.
    pub work: f64,
    /// True if an earlier run did it.
    pub is_restored: bool,
}

/// Receives progress, from any thread. Not a generic parameter: each crate that renders would
/// compile the kernels again.
pub type OnProgress<'a> = &'a (dyn Fn(Progress) + Sync);

impl Progress {
    /// Creates the progress of pixels of average cost, with `n_rays` rays.
    pub fn from_pixels(n_pixels: u64, n_rays: u64) -> Self {
        Self {
            n_pixels,
            n_rays,
            work: n_pixels as f64,
            is_restored: false,
        }
    }
}

/// Renders the plan on all threads of the current rayon pool and measures every pixel with the
/// `meter`. Any thread calls `report` after each tile. The schedule holds the time span of each
/// tile. After a request to stop ([`base::stop`]) the remaining tiles are skipped.
pub fn render(
    tracer: Tracer,
    plan: &TilePlan,
    meter: &Meter,
    report: OnProgress,
) -> (Film, Schedule) {
    let film = plan.film(tracer.scene, meter.mode());
    let view = View::new(tracer, &plan.sensor);
    render_onto(film, view, plan, &Pass::default(), meter, report)
}

/// Creates the renderer of tiles for the calling thread. Not a generic parameter: its calls take no
/// time beside a tile, and all that handles tiles would be compiled four times.
fn renderer<'a>(view: View<'a>, meter: &'a Meter, plan: &TilePlan) -> Box<dyn TileRenderer + 'a> {
    if let Some(renderer) = planned(view, meter) {
        return renderer;
    }
    match meter {
        Meter::Off => Box::new(StreamRenderer::<NoProbe>::new(view)),
        Meter::Counters => Box::new(StreamRenderer::<Counters>::new(view)),
        Meter::Time(clock) => Box::new(GroupRenderer::new(view, clock)),
        Meter::SingleRayTime(clock) => Box::new(SingleRayRenderer::new(view, clock, plan.room())),
    }
}

/// Renders tiles, with buffers for one tile, one per thread.
trait TileRenderer {
    /// Renders the tile's pixels, at most [`MAX_PIXELS`].
    fn render(&mut self, tile: &Tile);

    /// Returns the pixels of the last tile, row by row.
    fn rendered(&mut self) -> Rendered<'_>;

    /// Returns the clock of the thread that has created the renderer.
    fn stopwatch(&mut self) -> &mut Stopwatch;

    /// Adds the nanoseconds in which the thread has rendered the tile's pixels and stored them in
    /// the film. Returns those that warmed up the thread and are not counted yet.
    fn add_rendered(&mut self, _n_pixels: usize, _ns: f64) -> f64 {
        0.0
    }
}

/// Renders the tiles of the plan onto a film of the image's size and the meter's mode, except for
/// those that the pass takes over. Each thread takes the next tile in the plan's order until there is none, or the pass is over.
fn render_onto(
    mut film: Film,
    view: View,
    plan: &TilePlan,
    pass: &Pass,
    meter: &Meter,
    report: OnProgress,
) -> (Film, Schedule) {
    let target = OnceLock::new();
    let film_to_fill = &mut film;
    let (begin, runs) = pass.keeping(|| {
        // Render: rank 0 deals tiles to the other ranks meanwhile.
        let (to_threads, batches) = mpsc::sync_channel(MAX_BATCHES);
        let queue = TileQueue::new(plan, pass, &target, report, batches);
        let render_some = |context: rayon::BroadcastContext| {
            let renderer = &mut *renderer(view, meter, plan);
            queue.render(context.index() as u32, renderer)
        };
        let render = || {
            let film = film_to_fill;
            let _ = target.set(Target::new(film, &plan.grid, pass.limits.is_stored));
            rayon::broadcast(render_some)
        };
        let runs = match pass.limits.team {
            None => {
                drop(to_threads);
                render()
            }
            Some(team) => thread::scope(|scope| {
                let by_workers = start_in_scope(scope, || deal(team, &queue, to_threads));
                // Without the thread, the rendering ends at once.
                let by_workers = by_workers.map_err(|error| {
                    let (exit_code, message) = (1, error.to_string());
                    team.fail(0, RankFailure { exit_code, message });
                });
                let mut runs = render();
                runs.extend(by_workers.ok().and_then(|thread| thread.join().ok()));
                runs
            }),
        };
        (queue.begin, runs)
    });
    // Record the rendering in the schedule and in the film.
    let mut schedule = Schedule::new(plan.grid, plan.order, begin, runs);
    schedule.n_threads = pass.n_threads();
    let is_first = pass.number == 0;
    if let Some(Target::Film(canvas)) = target.get()
        && is_first
    {
        clear_missing(&schedule, 0..plan.grid.n_tiles(), canvas);
    }
    if is_first {
        note_runs(&mut film, &schedule);
    }
    (film, schedule)
}

/// Makes the pixels of missing tiles among `tiles` black without a hit.
fn clear_missing(schedule: &Schedule, tiles: Range<u32>, canvas: &Canvas) {
    let is_missing = |&number: &u32| schedule.runs[number as usize].is_missing;
    let missing = tiles.into_par_iter().filter(is_missing);
    missing.for_each(|number| {
        let tile = schedule.grid.tile(number);
        tile.parts(MAX_PIXELS).for_each(|part| canvas.clear(&part));
    });
}

/// Gives the film the threads and the totals of a rendering.
fn note_runs(film: &mut Film, schedule: &Schedule) {
    film.totals = schedule.counted();
    for (tile, run) in film.tiles.iter_mut().zip(&schedule.runs) {
        (tile.thread, tile.is_missing) = (run.thread, run.is_missing);
    }
}

/// Renders a tile into the film. Returns its times since `begin` and its counters.
fn render_tile(
    renderer: &mut dyn TileRenderer,
    plan: &TilePlan,
    tile: &Tile,
    canvas: &Canvas,
    begin: Instant,
) -> TileRun {
    let now_ns = || begin.elapsed().as_nanos() as u64;
    let mut run = TileRun {
        start_ns: now_ns(),
        ..TileRun::default()
    };
    let begin_ns = renderer.stopwatch().cpu_ns();
    let mut end_ns = begin_ns;
    // Render a part of whole rows.
    for part in tile.parts(MAX_PIXELS) {
        renderer.render(&plan.in_picture(&part));
        // Add up its counters and store it in the film, timed separately: page faults at the first
        // write would show in the map of a single pixel.
        let rendered_ns = renderer.stopwatch().cpu_ns();
        let rendered = renderer.rendered();
        run.warm_up_ns += rendered.warm_up_ns as u64;
        if let Some(counters) = rendered.counters {
            run.counted = run.counted.with(counters.total());
        }
        canvas.store(&part, &rendered);
        let stored_ns = renderer.stopwatch().cpu_ns();
        run.film_ns += (stored_ns - rendered_ns) as u64;
        let warm_up_ns = renderer.add_rendered(part.n_pixels(), stored_ns - end_ns);
        run.warm_up_ns += warm_up_ns as u64;
        end_ns = stored_ns;
    }
    run.end_ns = now_ns();
    run.waiting_ns = run.duration_ns().saturating_sub((end_ns - begin_ns) as u64);
    // Beside other work, the clock of CPU time may run ahead of the other one within a short part.
    run.film_ns = run.film_ns.min(run.duration_ns());
    run
}

/// Two mirrors over a mirroring floor, for tests.
#[cfg(test)]
fn mirrors(width: u32, height: u32) -> (scene::config::Config, world::scene::Scene) {
    let text = format!(
        "image: {{ width: {width}, height: {height} }}
camera: {{ look_at: {{ eye: [0, 1, 5], target: [0, 0.5, 0], fov_y_deg: 50 }} }}
shading: {{ model: seed, max_depth: 4 }}
materials:
  mirror: {{ color: [0.5, 0.2, 0.5], specular: 1, exponent: 50, reflection: 0.5 }}
lights: [{{ point: {{ position: [5, 5, 10] }} }}]
objects:
  - {{ sphere: {{ center: [-0.7, 0.6, 0], radius: 0.6 }}, material: mirror }}
  - {{ sphere: {{ center: [0.7, 0.6, -1], radius: 0.6 }}, material: mirror }}
  - {{ plane: {{ point: [0, 0, 0], normal: [0, 1, 0] }}, material: mirror }}
"
    );
    let mut config = scene::yaml::from_str(&text).unwrap();
    let folder = std::path::Path::new("");
    let geometries = scene::build::Geometries::read(&mut config, folder, u64::MAX).unwrap();
    let scene = scene::build::scene(&config, geometries).unwrap();
    (config, scene)
}
