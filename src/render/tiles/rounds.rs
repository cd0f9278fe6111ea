//! Adaptive sampling: rounds of samples, and the pixels that need another one.

use std::ops::Range;

use glam::Vec3;

use math::simd::{Real, Vector};
use scene::build::Sensor;
use scene::config::{Adaptive, MAX_SAMPLES, SampleRule};

/// Light below which the curve of a display is a straight line.
const DARK: f32 = 0.0015;

/// Greatest number of samples by efficiency, relative to the mean: first samples that are all the
/// same but for a rare bright one would send too many more.
const MOST_PER_MEAN: u32 = 8;

/// The samples of a pixel, round by round.
#[derive(Debug, Clone, Copy)]
pub struct Rounds {
    /// Samples of the first round.
    n_first: u32,
    /// Greatest number of samples.
    n_most: u32,
    limit: SampleLimit,
    /// The factor from radiance to the light of the picture.
    gain: f32,
    /// True if the film has the noise of each pixel.
    pub(super) keeps_noise: bool,
}

/// The reason for which a pixel needs no more samples.
#[derive(Debug, Clone, Copy)]
enum SampleLimit {
    /// It has as many as all others.
    Number,
    /// The greatest variance of the mean of a channel, over that mean: its root is twice the
    /// standard error of the mean's square root.
    Noise(f32),
    /// It has this many per root of its neighbors' variance over cost.
    PerRoot(f64),
}

/// The first samples of a pixel.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct FirstSamples {
    /// The variance of one sample.
    pub(super) variance: f64,
    /// Node visits and primitive tests of all of them.
    pub(super) cost: u64,
}

/// Sums over the samples of a pixel.
#[derive(Debug, Clone, Copy)]
pub struct SampleSums<R> {
    pub colors: Vector<R>,
    /// The color of the first sample.
    pub first: Vector<R>,
    /// Sum of the squares of the colors' differences from the first one: squares of the colors
    /// themselves would lose the digits of low noise in bright light.
    pub squares: Vector<R>,
}

impl Rounds {
    /// Creates the rounds of the pixels that a sensor sees.
    pub fn new(sensor: &Sensor) -> Self {
        let image = &sensor.image;
        let n = image.samples_per_pixel;
        let (n_first, n_most, limit) = match image.adaptive {
            None => (n, n, SampleLimit::Number),
            Some(Adaptive {
                by: SampleRule::Efficiency,
                min_samples,
                ..
            }) => {
                let n_most = n.saturating_mul(MOST_PER_MEAN).min(MAX_SAMPLES);
                let per_root = sensor.samples_per_root.unwrap_or(0.0);
                (min_samples, n_most, SampleLimit::PerRoot(per_root))
            }
            Some(Adaptive {
                noise, min_samples, ..
            }) => {
                let variance = (2.0 * noise.unwrap_or(0.0)).powi(2);
                (min_samples, n, SampleLimit::Noise(variance))
            }
        };
        Self {
            n_first: n_first.min(n),
            n_most,
            limit,
            gain: sensor.development.gain(),
            keeps_noise: sensor.extra_arrays.noise.is_some(),
        }
    }

    /// Returns the first samples of all pixels only, whose squares are summed up.
    pub(super) fn only_first(&self) -> Self {
        Self {
            keeps_noise: true,
            ..self.with_samples(self.n_first)
        }
    }

    /// Returns the rounds of pixels that have this number of samples.
    pub(crate) fn with_samples(&self, n: u32) -> Self {
        Self {
            n_first: n,
            n_most: n,
            limit: SampleLimit::Number,
            ..*self
        }
    }

    /// Returns true if pixels may have different numbers of samples.
    pub(crate) fn are_adaptive(&self) -> bool {
        !matches!(self.limit, SampleLimit::Number)
    }

    /// Returns true if the number of samples of each pixel is planned.
    pub(super) fn are_planned(&self) -> bool {
        matches!(self.limit, SampleLimit::PerRoot(_))
    }

    /// Returns true if the squares of samples are summed up.
    pub(crate) fn measure_noise(&self) -> bool {
        self.keeps_noise || self.are_adaptive()
    }

    /// Returns the samples that each pixel gets.
    pub fn first(&self) -> Range<u32> {
        0..self.n_first
    }

    /// Returns the number of samples of every pixel; 0 if pixels may differ.
    pub(crate) fn n_uniform(&self) -> u32 {
        match self.limit {
            SampleLimit::Number => self.n_most,
            _ => 0,
        }
    }

    /// Returns the least number of samples of a pixel.
    pub(super) fn n_least(&self) -> u32 {
        self.n_first
    }

    /// Returns the greatest number of samples of a pixel.
    pub fn n_most(&self) -> u32 {
        self.n_most
    }

    /// Returns the samples that a pixel with these sums of `n` samples gets next; empty if it needs
    /// no more.
    pub fn next(&self, sums: &SampleSums<f32>, n: u32) -> Range<u32> {
        match self.limit {
            SampleLimit::Noise(variance)
                if n < self.n_most && self.is_exceeded(variance, sums, n) =>
            {
                self.after(n)
            }
            _ => n..n,
        }
    }

    /// Returns the samples that a pixel gets after `n` samples, at least 1; empty at the end. If it is
    /// noisy, a quarter of that number, so that there are few rounds and few superfluous samples. If
    /// the number is planned, all up to the next power of two or three halves of one: after these,
    /// Sobol' points are spread most evenly.
    pub fn after(&self, n: u32) -> Range<u32> {
        let end = if self.are_planned() {
            let power = 1 << n.ilog2();
            let between = power + power / 2;
            if n < between { between } else { 2 * power }
        } else {
            n + self.n_first.max(n / 4)
        };
        n..self.n_most.min(end)
    }

    /// Returns the number of samples of a pixel whose neighbors have this root of variance over
    /// cost: the nearest end of a round.
    pub(super) fn planned(&self, root: f64) -> u32 {
        let SampleLimit::PerRoot(factor) = self.limit else {
            return self.n_most;
        };
        let wanted = factor * root;
        let mut n = self.n_first;
        loop {
            let next = self.after(n).end;
            if next == n || wanted < 0.5 * f64::from(n + next) {
                return n;
            }
            n = next;
        }
    }

    /// Returns the variance of a sample and the cost of the first samples of a pixel.
    ///
    /// The variance is of the square root of light, as a display shows it: errors count by how much
    /// they are seen.
    pub(super) fn first_samples(&self, sums: &SampleSums<f32>, cost: u64) -> FirstSamples {
        let n = self.n_first;
        if n < 2 {
            return FirstSamples::default();
        }
        let noise = self.gain * self.gain * sums.variance_of_mean(n) / self.light(sums, n);
        FirstSamples {
            variance: f64::from(noise.element_sum()) * f64::from(n),
            cost,
        }
    }

    /// Returns true if a pixel with these sums of `n` samples, at least 2, is noisier than the
    /// limit.
    fn is_exceeded(&self, limit: f32, sums: &SampleSums<f32>, n: u32) -> bool {
        let noise = self.gain * self.gain * sums.variance_of_mean(n);
        noise.cmpgt(limit * self.light(sums, n)).any()
    }

    /// Returns the light of the picture in a pixel with these sums of `n` samples.
    fn light(&self, sums: &SampleSums<f32>, n: u32) -> Vec3 {
        let mean = Vec3::from(sums.colors) / n as f32;
        (self.gain * mean).max(Vec3::splat(DARK))
    }
}

impl SampleSums<f32> {
    /// Returns the variance of the mean of `n` samples, at least 2, for each channel.
    ///
    /// It is estimated as if samples were independent: evenly spread samples have a lower variance.
    fn variance_of_mean(&self, n: u32) -> Vec3 {
        let n = n as f32;
        let [colors, first, squares] = [self.colors, self.first, self.squares].map(Vec3::from);
        let shift = colors / n - first;
        ((squares / n - shift * shift) / (n - 1.0)).max(Vec3::ZERO)
    }

    /// Returns the standard error of the mean of `n` samples, as the root of the mean over the
    /// channels; NaN for less than 2.
    pub fn noise(&self, n: u32) -> f32 {
        match n {
            0 | 1 => f32::NAN,
            _ => (self.variance_of_mean(n).element_sum() / 3.0).sqrt(),
        }
    }
}

impl<R: Real> SampleSums<R> {
    /// Returns the sums of no samples; `like` sets the number of lanes.
    pub fn zero(like: R) -> Self {
        let zero = Vector::splat(like, Vec3::ZERO);
        Self {
            colors: zero,
            first: zero,
            squares: zero,
        }
    }

    /// Adds a sample, or the first one.
    #[inline(always)]
    pub fn add(&mut self, color: Vector<R>, is_first: bool) {
        if is_first {
            self.first = color;
        }
        let difference = color - self.first;
        self.colors = self.colors + color;
        self.squares = self.squares + difference.times(difference);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Returns the noise of samples in two passes, with 64 bits.
    fn noise(samples: &[[f32; 3]]) -> f64 {
        let n = samples.len() as f64;
        let channel = |i: usize| {
            let values = || samples.iter().map(|sample| f64::from(sample[i]));
            let mean = values().sum::<f64>() / n;
            values().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0) / n
        };
        ((channel(0) + channel(1) + channel(2)) / 3.0).sqrt()
    }

    proptest! {
        #[test]
        fn noise_equals_that_of_the_slow_twin(
            light in 0.0_f32..1e4,
            spread in 1e-3_f32..1.0,
            samples in prop::collection::vec(prop::array::uniform3(0.0_f32..1.0), 2..200),
        ) {
            // Also where the light is far above its noise.
            let samples: Vec<[f32; 3]> = samples
                .iter()
                .map(|sample| sample.map(|x| light * (1.0 + spread * x)))
                .collect();
            let mut sums = SampleSums::zero(0.0);
            for (i, &sample) in samples.iter().enumerate() {
                sums.add(Vec3::from(sample).into(), i == 0);
            }
            let [found, expected] = [f64::from(sums.noise(samples.len() as u32)), noise(&samples)];
            prop_assert!((found - expected).abs() <= 1e-2 * expected + 1e-7 * f64::from(light));
        }
    }

    #[test]
    fn one_sample_shows_no_noise_and_equal_ones_have_none() {
        let mut sums = SampleSums::zero(0.0);
        sums.add(Vec3::splat(0.1).into(), true);
        assert!(sums.noise(1).is_nan());
        (1..100).for_each(|_| sums.add(Vec3::splat(0.1).into(), false));
        assert_eq!(sums.noise(100), 0.0);
    }
}
