//! The same picture again and again: times that can be trusted.
//!
//! A pixel's time is what the machine made of it at that moment. The median of
//! several is close to what the pixel costs, and their median absolute deviation
//! (MAD) tells how close. Renderings follow one another, so that the samples of a
//! pixel lie far apart: a disturbance meets few of them.

use std::time::{Duration, Instant};

use super::samples::{SAMPLE_BYTES, Samples};
use super::{Plan, Progress, render_onto};
use crate::accel::Accel;
use crate::config::{Config, Repeats};
use crate::cost::Meter;
use crate::film::Film;
use crate::scene::Scene;
use crate::schedule::{Schedule, TileRun};
use crate::stop;

/// How long all renderings of [`Repeats::Auto`] take together, but for a first one
/// that takes longer.
const TIME_OF_AUTO: Duration = Duration::from_millis(500);

/// One of several renderings of a picture.
#[derive(Debug, Clone, Copy)]
pub struct Repeat {
    /// Time on the wall.
    pub wall: Duration,
    /// From each tile's start to its end, in nanoseconds over all threads.
    pub busy_ns: u64,
    /// Of that, the time in which pixels were written into the film.
    pub film_ns: u64,
    /// Of that, the time in which pixels were rendered that count for nothing.
    pub warm_up_ns: u64,
    /// The sum of the pixels' times in nanoseconds, rejected ones included,
    /// where they were measured.
    pub pixels_ns: Option<f64>,
    /// How many pixels' times were rejected.
    pub n_rejected: u64,
}

/// The most renderings of the config's picture.
pub(crate) fn most_repeats(config: &Config) -> u8 {
    if config.repeats == Repeats::Auto && !config.cost.has_time() {
        return 1;
    }
    config.repeats.most(config.image.n_pixels(), SAMPLE_BYTES)
}

/// The fewest renderings of the config's picture.
pub(crate) fn least_repeats(config: &Config) -> u8 {
    match config.repeats {
        Repeats::Auto => 1,
        Repeats::Exactly(n) => n.get(),
    }
}

/// Bytes of memory that the samples of a pixel take, and their deviation.
pub(crate) fn repeat_bytes_per_pixel(config: &Config) -> usize {
    if !config.cost.has_time() || !config.repeats.has_spread() {
        return 0;
    }
    usize::from(most_repeats(config)) * SAMPLE_BYTES + size_of::<f32>()
}

/// Renders the picture so many times, as [`render`](super::render) does;
/// [`Repeats::Auto`] goes on as long as one more rendering, which takes as long as
/// the last one, ends within half a second.
///
/// The film's `time_ns` is the median of the samples that were kept, and
/// `time_mad_ns` their median absolute deviation; `n_rejected` counts the others,
/// during which the thread lost its CPU, or right after that. Where all were
/// rejected, both are of all. `thread` and the schedule are those of the last
/// rendering. All else is the same each time. With [`Repeats::ONCE`], or where
/// there are no times, the film is that of [`render`](super::render).
pub fn repeat(
    repeats: Repeats,
    scene: &Scene,
    accel: &Accel,
    plan: &Plan,
    meter: &Meter,
    report: impl Fn(Progress) + Sync,
) -> (Film, Schedule, Vec<Repeat>) {
    let render_timed = |film| {
        let begin = Instant::now();
        let (film, schedule) = render_onto(film, scene, accel, plan, meter, &report);
        let repeat = Repeat::of(begin.elapsed(), &film, &schedule);
        (film, schedule, repeat)
    };
    let begin = Instant::now();
    let mut film = plan.film(meter.mode());
    film.repeats = repeats;
    let mut samples = (film.cost.has_time() && repeats.has_spread()).then(|| Samples::new(&film));
    let mut done = Vec::new();
    loop {
        let (schedule, repeat);
        (film, schedule, repeat) = render_timed(film);
        done.push(repeat);
        if let Some(samples) = &mut samples {
            samples.take(&film);
        }
        if goes_on(repeats, &film, &done, begin.elapsed()) && !stop::is_requested() {
            continue;
        }
        film.n_repeats = done.len() as u8;
        if let Some(samples) = samples {
            samples.summarise(&mut film);
        }
        return (film, schedule, done);
    }
}

/// Whether a film that was rendered so often, in `elapsed`, is rendered again.
fn goes_on(repeats: Repeats, film: &Film, done: &[Repeat], elapsed: Duration) -> bool {
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
    fn of(wall: Duration, film: &Film, schedule: &Schedule) -> Self {
        Self {
            wall,
            busy_ns: schedule.runs.iter().map(TileRun::duration_ns).sum(),
            film_ns: schedule.runs.iter().map(|run| run.film_ns).sum(),
            warm_up_ns: schedule.runs.iter().map(|run| run.warm_up_ns).sum(),
            pixels_ns: film.cost.has_time().then(|| film.total_time_ns()),
            n_rejected: film.n_rejected(),
        }
    }
}
