//! Repeated renderings for reliable pixel times.
//!
//! A single time of a pixel includes random disturbances. The median of several times is a robust
//! estimate of the pixel's cost, and their median absolute deviation (MAD) measures its
//! uncertainty. The picture is rendered as a whole each time, so that the samples of a pixel are
//! far apart in time and a disturbance affects few of them.

use std::time::{Duration, Instant};

use super::pass::{Limits, Pass};
use super::samples::{SAMPLE_BYTES, Samples};
use super::time_hottest::{limit_after, time_hottest_again};
use super::{OnProgress, TilePlan, View, render_onto};
use crate::film::Film;
use crate::schedule::{N_GRIDS, Schedule, TileRun};
use scene::config::{Config, CostMode, Repeats};
use tracer::cost::Meter;
use tracer::trace::Tracer;

/// Time limit of all renderings of [`Repeats::Auto`] together. The first one may exceed it.
const TIME_OF_AUTO: Duration = Duration::from_millis(500);

/// Number of grids from which on the edges of groups hardly show.
pub const LEAST_GRIDS: u8 = 3;

/// One of several renderings of a picture.
#[derive(Debug, Clone, Copy)]
pub struct Repeat {
    /// Wall time.
    pub wall: Duration,
    /// Time from the start to the end of each tile in which its thread had a CPU, in nanoseconds
    /// summed over all threads.
    pub busy_ns: u64,
    /// The rest of the time from the start to the end of each tile.
    pub waiting_ns: u64,
    /// The part of the busy time that wrote pixels to the film.
    pub film_ns: u64,
    /// The part of the busy time that warmed up the threads.
    pub warm_up_ns: u64,
    /// The sum of the pixels' times in nanoseconds, if they were measured.
    pub pixels_ns: Option<f64>,
}

/// Returns the largest number of renderings of the config's picture.
pub fn most_repeats(config: &Config) -> u8 {
    if config.repeats == Repeats::Auto && !config.cost.has_time() {
        return 1;
    }
    config.repeats.most(config.image.n_pixels(), SAMPLE_BYTES)
}

/// Returns the smallest number of renderings of the config's picture.
pub fn least_repeats(config: &Config) -> u8 {
    match config.repeats {
        Repeats::Auto => 1,
        Repeats::Exactly(n) => n.get(),
    }
}

/// Returns the bytes of memory per pixel for its samples and their deviation.
pub fn repeat_bytes_per_pixel(config: &Config) -> usize {
    if !config.cost.has_time() || !config.repeats.has_spread() {
        return 0;
    }
    usize::from(most_repeats(config)) * SAMPLE_BYTES + size_of::<f32>()
}

/// Renders the picture repeatedly, as [`render`](super::render) does. [`Repeats::Auto`] continues
/// while one more rendering, as long as the last one, would end within half a second.
///
/// The film's `time_ns` is the median of the times, and `time_mad_ns` their median absolute
/// deviation. `thread` and the schedule describe the first rendering. All other values are the same
/// in each rendering. With [`Repeats::ONCE`], or without times, the film equals the result of
/// [`render`](super::render).
///
/// If groups of pixels are timed, each rendering has another grid of tiles and groups, so that the
/// edges of groups do not show in the medians.
pub fn repeat(
    repeats: Repeats,
    tracer: Tracer,
    plan: &TilePlan,
    meter: &Meter,
    report: OnProgress,
) -> (Film, Schedule, Vec<Repeat>) {
    let limits = Limits::default();
    repeat_within(&limits, repeats, tracer, plan, meter, report)
}

/// Renders the picture repeatedly, as [`repeat`] does, within limits. Where tiles are taken over,
/// kept, or rendered by several ranks, [`Repeats::Auto`] is one rendering, since the number that
/// fits into half a second differs from run to run.
///
/// At the deadline the first rendering leaves tiles out; an incomplete later one is discarded.
pub fn repeat_within(
    limits: &Limits,
    repeats: Repeats,
    tracer: Tracer,
    plan: &TilePlan,
    meter: &Meter,
    report: OnProgress,
) -> (Film, Schedule, Vec<Repeat>) {
    // Make the film.
    let view = View::new(tracer, &plan.sensor);
    let begin = Instant::now();
    // Rank 0 of several makes its film while the others render.
    let mut film = if limits.is_stored || limits.team.is_some() {
        plan.film_without_rows(tracer.scene, meter.mode())
    } else {
        plan.film(tracer.scene, meter.mode())
    };
    film.repeats = repeats;
    let mut samples: Option<Samples> = None;
    let mut done: Vec<Repeat> = Vec::new();
    let mut first: Option<Schedule> = None;
    let schedule = loop {
        // Render all tiles.
        let started = Instant::now();
        let pass = Pass::new(done.len() as u8, tracer.scene, *limits);
        let has_groups = meter.mode() == CostMode::Time;
        let moved =
            (has_groups && pass.number > 0).then(|| plan.for_rendering(pass.number, meter.mode()));
        let plan = moved.as_ref().unwrap_or(plan);
        let schedule;
        (film, schedule) = render_onto(film, view, plan, &pass, meter, report);
        // Drop a later rendering that a deadline cut off.
        let is_whole = schedule.rendered().count() as u32 == plan.n_tiles();
        if let Some(first) = first.take_if(|_| !is_whole) {
            break first;
        }
        // Keep the times.
        let is_spread = limits.checkpoint.is_some() || limits.team.is_some();
        let wall = if is_spread {
            schedule.span()
        } else {
            started.elapsed()
        };
        done.push(Repeat::new(wall, &film, &schedule));
        if has_groups {
            film.n_grids = (done.len() as u32).min(N_GRIDS) as u8;
        }
        if film.cost.has_time() && repeats.has_spread() {
            samples
                .get_or_insert_with(|| Samples::new(&film))
                .take(&film);
        }
        // Stop when the repeats are done.
        let is_once = is_spread && repeats == Repeats::Auto;
        let is_last = is_once || !needs_another(repeats, &film, &done, begin.elapsed());
        let schedule = first.take().unwrap_or(schedule);
        if is_last || !is_whole || pass.is_over() {
            break schedule;
        }
        first = Some(schedule);
    };
    // Summarize the times, and time the most expensive pixels again.
    film.n_repeats = done.len() as u8;
    if let Some(samples) = samples {
        samples.summarize(&mut film);
    }
    let has_squares = film.n_grids < LEAST_GRIDS;
    if has_squares && limits.checkpoint.is_none_or(|kept| kept.n_restored() == 0) {
        let limit = limit_after(begin.elapsed());
        time_hottest_again(&mut film, view, meter, plan, limit);
    }
    (film, schedule, done)
}

/// Returns true if the film is rendered again after the renderings `done`, which took `elapsed`
/// together.
fn needs_another(repeats: Repeats, film: &Film, done: &[Repeat], elapsed: Duration) -> bool {
    let is_auto = repeats == Repeats::Auto;
    if is_auto && !film.cost.has_time() {
        return false;
    }
    let n_pixels = film.grid.width as usize * film.grid.height as usize;
    let most = usize::from(repeats.most(n_pixels, SAMPLE_BYTES));
    let last = done.last().map_or(Duration::ZERO, |repeat| repeat.wall);
    done.len() < most && (!is_auto || elapsed + last <= TIME_OF_AUTO)
}

impl Repeat {
    fn new(wall: Duration, film: &Film, schedule: &Schedule) -> Self {
        Self {
            wall,
            busy_ns: schedule.runs.iter().map(TileRun::busy_ns).sum(),
            waiting_ns: schedule.runs.iter().map(|run| run.waiting_ns).sum(),
            film_ns: schedule.runs.iter().map(|run| run.film_ns).sum(),
            warm_up_ns: schedule.runs.iter().map(|run| run.warm_up_ns).sum(),
            pixels_ns: film.cost.has_time().then(|| film.total_time_ns()),
        }
    }
}
