//! The same picture again and again: times that can be trusted.
//!
//! A pixel's time is what the machine made of it at that moment. The median of
//! several is close to what the pixel costs, and their median absolute deviation
//! (MAD) tells how close. Renderings follow one another, so that the samples of a
//! pixel lie far apart: a disturbance meets few of them.

use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::{Plan, Progress, render_onto};
use crate::accel::Accel;
use crate::cost::Meter;
use crate::film::{Film, Strip};
use crate::scene::Scene;
use crate::schedule::{Schedule, TileRun};

/// One of several renderings of a picture.
#[derive(Debug, Clone, Copy)]
pub struct Repeat {
    /// Time on the wall.
    pub wall: Duration,
    /// From each tile's start to its end, in nanoseconds over all threads.
    pub busy_ns: u64,
    /// Of that, the time in which pixels were written into the film.
    pub film_ns: u64,
    /// The sum of the pixels' times in nanoseconds, rejected ones included,
    /// where they were measured.
    pub pixels_ns: Option<f64>,
    /// How many pixels' times were rejected.
    pub n_rejected: u64,
}

/// Bytes of memory that the samples of a pixel take, and their deviation.
pub(crate) fn repeat_bytes_per_pixel(n_repeats: u8) -> usize {
    match n_repeats {
        0 | 1 => 0,
        n => usize::from(n) * size_of::<Sample>() + size_of::<f32>(),
    }
}

/// Renders the picture `n_repeats` times, as [`render`](super::render) does.
///
/// The film's `time_ns` is the median of the samples that were kept, and
/// `time_mad_ns` their median absolute deviation; `n_rejected` counts the others,
/// during which the thread changed its CPU. Where all were rejected, both are
/// of all. `thread` and the schedule are those of the last rendering. All else
/// is the same each time. After one rendering, or where there are no times, the film is that of
/// [`render`](super::render).
pub fn repeat(
    n_repeats: u8,
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
    let film = plan.film(meter.mode());
    let (mut film, mut schedule, first) = render_timed(film);
    let mut repeats = vec![first];
    if n_repeats > 1 {
        let mut samples = Samples::new(&film);
        samples.take(&film);
        for _ in 1..n_repeats {
            let repeat;
            (film, schedule, repeat) = render_timed(film);
            repeats.push(repeat);
            samples.take(&film);
        }
        film.n_repeats = n_repeats;
        if film.cost.has_time() {
            samples.summarise(&mut film);
        }
    }
    (film, schedule, repeats)
}

impl Repeat {
    fn of(wall: Duration, film: &Film, schedule: &Schedule) -> Self {
        Self {
            wall,
            busy_ns: schedule.runs.iter().map(TileRun::duration_ns).sum(),
            film_ns: schedule.runs.iter().map(|run| run.film_ns).sum(),
            pixels_ns: film.cost.has_time().then(|| film.total_time_ns()),
            n_rejected: film.n_rejected(),
        }
    }
}

/// A time in nanoseconds, at least 1. The sign tells whether it was rejected,
/// so that it takes no more room than the time.
#[derive(Debug, Clone, Copy)]
struct Sample(f32);

impl Sample {
    fn new(ns: f32, is_rejected: bool) -> Self {
        Self(if is_rejected { -ns } else { ns })
    }

    fn ns(self) -> f32 {
        self.0.abs()
    }

    fn is_rejected(self) -> bool {
        self.0 < 0.0
    }
}

/// The times of all renderings so far.
struct Samples {
    /// For each strip of the film one list a rendering, in the order of pixels.
    strips: Vec<Vec<Vec<Sample>>>,
}

impl Samples {
    fn new(film: &Film) -> Self {
        Self {
            strips: vec![Vec::new(); film.strips.len()],
        }
    }

    /// Takes over the times of a rendering.
    fn take(&mut self, film: &Film) {
        let strips = self.strips.par_iter_mut().zip(&film.strips);
        strips.for_each(|(samples, strip)| {
            let times = strip.time_ns.iter().zip(&strip.n_rejected);
            samples.push(
                times
                    .map(|(&ns, &n_rejected)| Sample::new(ns, n_rejected > 0))
                    .collect(),
            );
        });
    }

    /// Puts medians, deviations and rejections into the film.
    fn summarise(self, film: &mut Film) {
        let strips = film.strips.par_iter_mut().zip(self.strips);
        strips.for_each(|(strip, samples)| summarise_strip(strip, &samples));
    }
}

fn summarise_strip(strip: &mut Strip, samples: &[Vec<Sample>]) {
    strip.time_mad_ns = vec![0.0; strip.time_ns.len()];
    let mut of_pixel = Vec::with_capacity(samples.len());
    let mut kept = Vec::with_capacity(samples.len());
    for i in 0..strip.time_ns.len() {
        of_pixel.clear();
        of_pixel.extend(samples.iter().map(|rendering| rendering[i]));
        let summary = summary(&of_pixel, &mut kept);
        strip.time_ns[i] = summary.median_ns;
        strip.time_mad_ns[i] = summary.mad_ns;
        strip.n_rejected[i] = summary.n_rejected;
    }
}

/// What a pixel's samples come to.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Summary {
    median_ns: f32,
    mad_ns: f32,
    n_rejected: u8,
}

/// The summary of one sample or more, at most 255; `kept` is room to work in.
fn summary(samples: &[Sample], kept: &mut Vec<f32>) -> Summary {
    kept.clear();
    let is_kept = |sample: &&Sample| !sample.is_rejected();
    kept.extend(samples.iter().filter(is_kept).map(|sample| sample.ns()));
    let n_rejected = samples.len() - kept.len();
    if kept.is_empty() {
        // A disturbed time is better than none.
        kept.extend(samples.iter().map(|sample| sample.ns()));
    }
    let median_ns = median(kept);
    kept.iter_mut().for_each(|ns| *ns = (*ns - median_ns).abs());
    Summary {
        median_ns,
        mad_ns: median(kept),
        n_rejected: n_rejected as u8,
    }
}

/// The middle value, or the mean of the two; brings the values into some other
/// order. There is at least one.
fn median(values: &mut [f32]) -> f32 {
    values.sort_unstable_by(f32::total_cmp);
    let n = values.len();
    let [low, high] = [values[(n - 1) / 2], values[n / 2]];
    low + (high - low) / 2.0
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::config::CostMode;
    use crate::schedule::TileGrid;

    fn summary_of(samples: &[(f32, bool)]) -> Summary {
        let samples: Vec<Sample> = samples
            .iter()
            .map(|&(ns, is_rejected)| Sample::new(ns, is_rejected))
            .collect();
        summary(&samples, &mut Vec::new())
    }

    /// The slow twin: the value that has as many below as above.
    fn plain_median(values: &[f64]) -> f64 {
        let rank = |value: f64| {
            let below = values.iter().filter(|other| **other < value).count();
            let equal = values.iter().filter(|other| **other == value).count();
            below..below + equal
        };
        let at = |position: usize| {
            let holds = |value: &&f64| rank(**value).contains(&position);
            *values.iter().find(holds).unwrap()
        };
        let n = values.len();
        match n % 2 {
            1 => at(n / 2),
            _ => (at(n / 2 - 1) + at(n / 2)) / 2.0,
        }
    }

    proptest! {
        #[test]
        fn summaries_are_those_of_the_slow_twin(
            samples in prop::collection::vec((1_u16..100, prop::bool::weighted(0.3)), 1..=12)
        ) {
            // Halves of small whole numbers: exact in both.
            let samples: Vec<(f32, bool)> =
                samples.into_iter().map(|(ns, rejected)| (f32::from(ns), rejected)).collect();
            let n_rejected = samples.iter().filter(|(_, rejected)| *rejected).count();
            let all_rejected = n_rejected == samples.len();
            let kept: Vec<f64> = samples
                .iter()
                .filter(|(_, rejected)| all_rejected || !rejected)
                .map(|(ns, _)| f64::from(*ns))
                .collect();
            let median = plain_median(&kept);
            let deviations: Vec<f64> = kept.iter().map(|ns| (ns - median).abs()).collect();
            let expected = Summary {
                median_ns: median as f32,
                mad_ns: plain_median(&deviations) as f32,
                n_rejected: n_rejected as u8,
            };
            prop_assert_eq!(summary_of(&samples), expected);
        }
    }

    #[test]
    fn a_moved_thread_counts_for_nothing_unless_there_is_nothing_else() {
        let summary = summary_of(&[(100.0, false), (9000.0, true), (104.0, false)]);
        let [median_ns, mad_ns] = [102.0, 2.0];
        assert_eq!(
            summary,
            Summary {
                median_ns,
                mad_ns,
                n_rejected: 1
            }
        );
        let summary = summary_of(&[(9000.0, true), (100.0, true), (200.0, true)]);
        assert_eq!((summary.median_ns, summary.mad_ns), (200.0, 100.0));
        assert_eq!(summary.n_rejected, 3);
    }

    #[test]
    fn the_film_gets_the_summary_of_each_pixel() {
        let mut film = Film::new(TileGrid::new(3, 20, 8), 1, CostMode::Time);
        let mut samples = Samples::new(&film);
        let mut next = 0_u32;
        for _ in 0..3 {
            for strip in &mut film.strips {
                let pixels = strip.time_ns.iter_mut().zip(&mut strip.n_rejected);
                for (ns, n_rejected) in pixels {
                    next += 7;
                    *ns = (1 + next * next % 1009) as f32;
                    *n_rejected = u8::from(next.is_multiple_of(5));
                }
            }
            samples.take(&film);
        }
        // What the pixels were given, pixel by pixel.
        let sample = |pixel: u32, rendering: u32| {
            let next = 7 * (60 * rendering + pixel + 1);
            ((1 + next * next % 1009) as f32, next.is_multiple_of(5))
        };
        samples.summarise(&mut film);
        let times = film.values(|strip| &strip.time_ns);
        let deviations = film.values(|strip| &strip.time_mad_ns);
        let rejected = film.values(|strip| &strip.n_rejected);
        let mut n_pixels = 0;
        for (pixel, ((median_ns, mad_ns), n_rejected)) in
            (0..).zip(times.zip(deviations).zip(rejected))
        {
            let expected = summary_of(&[0, 1, 2].map(|rendering| sample(pixel, rendering)));
            let found = Summary {
                median_ns,
                mad_ns,
                n_rejected,
            };
            assert_eq!(found, expected, "pixel {pixel}");
            n_pixels += 1;
        }
        assert_eq!(n_pixels, 60);
        assert!(film.n_rejected() > 0);
    }
}
