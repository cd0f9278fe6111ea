//! The pixel times of all renderings → their median and deviation.

use rayon::prelude::*;

use crate::film::{Film, Strip};
use math::statistics::median;

/// Bytes of one time of a pixel.
pub(super) const SAMPLE_BYTES: usize = size_of::<f32>();

/// The pixel times of all renderings so far.
pub(super) struct Samples {
    /// For each strip of the film one list per rendering, in the order of pixels.
    strips: Vec<Vec<Vec<f32>>>,
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
        strips.for_each(|(samples, strip)| samples.push(strip.time_ns.clone()));
    }

    /// Writes medians and deviations to the film.
    pub(super) fn summarize(self, film: &mut Film) {
        let strips = film.strips.par_iter_mut().zip(self.strips);
        strips.for_each(|(strip, samples)| summarize_strip(strip, &samples));
    }
}

fn summarize_strip(strip: &mut Strip, samples: &[Vec<f32>]) {
    strip.time_mad_ns = vec![0.0; strip.time_ns.len()];
    if samples.len() == 1 {
        return;
    }
    let mut of_pixel = Vec::with_capacity(samples.len());
    for i in 0..strip.time_ns.len() {
        of_pixel.clear();
        of_pixel.extend(samples.iter().map(|rendering| f64::from(rendering[i])));
        [strip.time_ns[i], strip.time_mad_ns[i]] = median_and_deviation(&mut of_pixel);
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
        fn summaries_are_those_of_the_slow_twin(times in prop::collection::vec(1_u16..100, 1..=12)) {
            // Halves of small whole numbers: exact in both.
            let mut times: Vec<f64> = times.into_iter().map(f64::from).collect();
            let median = plain_median(&times);
            let deviations: Vec<f64> = times.iter().map(|ns| (ns - median).abs()).collect();
            let expected = [median, plain_median(&deviations)].map(|ns| ns as f32);
            prop_assert_eq!(median_and_deviation(&mut times), expected);
        }
    }

    #[test]
    fn the_film_gets_the_summary_of_each_pixel() {
        let mut film = Film::new(TileGrid::new(3, 20, 8), 1, CostMode::Time);
        let mut samples = Samples::new(&film);
        let time_ns = |next: u32| (1 + 7 * next * (7 * next) % 1009) as f32;
        let mut next = 0..;
        for _ in 0..3 {
            for strip in &mut film.strips {
                for ns in &mut strip.time_ns {
                    *ns = next.next().map_or(0.0, time_ns);
                }
            }
            samples.take(&film);
        }
        samples.summarize(&mut film);
        let times = film.values(|strip| &strip.time_ns);
        let found: Vec<[f32; 2]> = times
            .zip(film.values(|strip| &strip.time_mad_ns))
            .map(|(median_ns, mad_ns)| [median_ns, mad_ns])
            .collect();
        let summary = |pixel: u32| {
            let mut times = [0, 1, 2].map(|rendering| time_ns(60 * rendering + pixel).into());
            median_and_deviation(&mut times)
        };
        assert_eq!(found, (0..60).map(summary).collect::<Vec<_>>());
    }
}
