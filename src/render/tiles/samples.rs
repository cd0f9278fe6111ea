//! The pixel times of all renderings → their median and deviation.

use rayon::prelude::*;

use crate::film::{Film, Strip};
use math::statistics::median;

/// Bytes of one sample of a pixel.
pub(super) const SAMPLE_BYTES: usize = size_of::<Sample>();

/// A time in nanoseconds, at least 1. The sign bit marks a rejected sample, which takes no extra
/// memory.
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

/// The pixel times of all renderings so far.
pub(super) struct Samples {
    /// For each strip of the film one list per rendering, in the order of pixels.
    strips: Vec<Vec<Vec<Sample>>>,
}

impl Samples {
    pub(super) fn new(film: &Film) -> Self {
        Self {
            strips: vec![Vec::new(); film.strips.len()],
        }
    }

    /// Adds the times of a rendering.
    pub(super) fn take(&mut self, film: &Film) {
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

    /// Writes medians, deviations and numbers of rejections to the film.
    pub(super) fn summarize(self, film: &mut Film) {
        let strips = film.strips.par_iter_mut().zip(self.strips);
        strips.for_each(|(strip, samples)| summarize_strip(strip, &samples));
    }
}

fn summarize_strip(strip: &mut Strip, samples: &[Vec<Sample>]) {
    strip.time_mad_ns = vec![0.0; strip.time_ns.len()];
    if samples.len() == 1 {
        return;
    }
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

/// The statistics of a pixel's samples.
#[derive(Debug, Clone, Copy, PartialEq)]
struct SampleSummary {
    median_ns: f32,
    mad_ns: f32,
    n_rejected: u8,
}

/// Computes the statistics of 1 to 255 samples; `kept` is a reused buffer.
fn summary(samples: &[Sample], kept: &mut Vec<f64>) -> SampleSummary {
    kept.clear();
    let is_kept = |sample: &&Sample| !sample.is_rejected();
    let ns = |sample: &Sample| f64::from(sample.ns());
    kept.extend(samples.iter().filter(is_kept).map(ns));
    let n_rejected = samples.len() - kept.len();
    if kept.is_empty() {
        // Without accepted samples, use the rejected ones.
        kept.extend(samples.iter().map(ns));
    }
    let [median_ns, mad_ns] = median_and_deviation(kept);
    SampleSummary {
        median_ns,
        mad_ns,
        n_rejected: n_rejected as u8,
    }
}

/// Returns the median of times, and their median absolute deviation; reorders the times.
pub(super) fn median_and_deviation(times_ns: &mut [f64]) -> [f32; 2] {
    let median_ns = median(times_ns).unwrap_or_default();
    times_ns
        .iter_mut()
        .for_each(|ns| *ns = (*ns - median_ns).abs());
    [median_ns, median(times_ns).unwrap_or_default()].map(|ns| ns as f32)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::schedule::TileGrid;
    use scene::config::CostMode;

    fn summary_of(samples: &[(f32, bool)]) -> SampleSummary {
        let samples: Vec<Sample> = samples
            .iter()
            .map(|&(ns, is_rejected)| Sample::new(ns, is_rejected))
            .collect();
        summary(&samples, &mut Vec::new())
    }

    /// Returns the reference: the value with equal numbers of values below and above.
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
            let expected = SampleSummary {
                median_ns: median as f32,
                mad_ns: plain_median(&deviations) as f32,
                n_rejected: n_rejected as u8,
            };
            prop_assert_eq!(summary_of(&samples), expected);
        }
    }

    #[test]
    fn rejected_samples_are_used_only_if_all_are_rejected() {
        let summary = summary_of(&[(100.0, false), (9000.0, true), (104.0, false)]);
        let [median_ns, mad_ns] = [102.0, 2.0];
        assert_eq!(
            summary,
            SampleSummary {
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
        // The samples above, by pixel.
        let sample = |pixel: u32, rendering: u32| {
            let next = 7 * (60 * rendering + pixel + 1);
            ((1 + next * next % 1009) as f32, next.is_multiple_of(5))
        };
        samples.summarize(&mut film);
        let times = film.values(|strip| &strip.time_ns);
        let deviations = film.values(|strip| &strip.time_mad_ns);
        let rejected = film.values(|strip| &strip.n_rejected);
        let mut n_pixels = 0;
        for (pixel, ((median_ns, mad_ns), n_rejected)) in
            (0..).zip(times.zip(deviations).zip(rejected))
        {
            let expected = summary_of(&[0, 1, 2].map(|rendering| sample(pixel, rendering)));
            let found = SampleSummary {
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
