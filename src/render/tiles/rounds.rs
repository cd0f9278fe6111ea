//! Adaptive sampling: rounds of samples, and the pixels that need another one.

use std::ops::Range;

use glam::Vec3;

use math::simd::{Real, Vector};
use scene::config::Image;

/// Light below which the curve of a display is a straight line.
const DARK: f32 = 0.0015;

/// The samples of a pixel, round by round.
#[derive(Debug, Clone, Copy)]
pub struct Rounds {
    /// Samples of the first round.
    n_first: u32,
    /// Greatest number of samples.
    n_most: u32,
    limit: Option<NoiseLimit>,
}

/// The noise of a pixel that needs no more samples.
#[derive(Debug, Clone, Copy)]
struct NoiseLimit {
    /// The greatest variance of the mean of a channel, over that mean: its root is twice the
    /// standard error of the mean's square root.
    variance: f32,
    /// The factor from radiance to the light of the picture.
    gain: f32,
}

/// Sums over the samples of a pixel.
#[derive(Debug, Clone, Copy)]
pub struct SampleSums<R> {
    pub colors: Vector<R>,
    /// Sum of the colors' squares.
    pub squares: Vector<R>,
}

impl Rounds {
    /// Creates the rounds of the pixels of an image, whose picture scales light by this gain.
    pub fn new(image: &Image, gain: f32) -> Self {
        let n_most = image.samples_per_pixel;
        let n_first = image
            .adaptive
            .map_or(n_most, |adaptive| adaptive.min_samples);
        Self {
            n_first: n_first.min(n_most),
            n_most,
            limit: image.adaptive.map(|adaptive| NoiseLimit {
                variance: (2.0 * adaptive.noise).powi(2),
                gain,
            }),
        }
    }

    /// Returns true if pixels may have different numbers of samples.
    pub(crate) fn are_adaptive(&self) -> bool {
        self.limit.is_some()
    }

    /// Returns the samples that each pixel gets.
    pub fn first(&self) -> Range<u32> {
        0..self.n_first
    }

    /// Returns the number of samples of every pixel; 0 if pixels may differ.
    pub(crate) fn n_uniform(&self) -> u32 {
        match self.limit {
            None => self.n_most,
            Some(_) => 0,
        }
    }

    /// Returns the greatest number of samples of a pixel.
    pub fn n_most(&self) -> u32 {
        self.n_most
    }

    /// Returns the samples that a pixel with these sums of `n` samples gets next; empty if it needs
    /// no more.
    pub fn next(&self, sums: &SampleSums<f32>, n: u32) -> Range<u32> {
        let is_noisy = |limit: NoiseLimit| n < self.n_most && limit.is_exceeded(sums, n);
        if self.limit.is_some_and(is_noisy) {
            self.after(n)
        } else {
            n..n
        }
    }

    /// Returns the samples that a noisy pixel gets after `n` samples: a quarter of that number, so
    /// that there are few rounds and few superfluous samples. Empty at the end.
    pub fn after(&self, n: u32) -> Range<u32> {
        let n_more = self.n_first.max(n / 4);
        n..self.n_most.min(n + n_more)
    }
}

impl NoiseLimit {
    /// Returns true if a pixel with these sums of `n` samples, at least 2, is noisier.
    ///
    /// The variance is estimated as if samples were independent: evenly spread samples have a lower
    /// variance.
    fn is_exceeded(&self, sums: &SampleSums<f32>, n: u32) -> bool {
        let n = n as f32;
        let exceeds = |sum: f32, square: f32| {
            let mean = sum / n;
            let variance = (square / n - mean * mean) / (n - 1.0);
            let light = (self.gain * mean).max(DARK);
            self.gain * self.gain * variance > self.variance * light
        };
        let SampleSums { colors, squares } = sums;
        exceeds(colors.x, squares.x) || exceeds(colors.y, squares.y) || exceeds(colors.z, squares.z)
    }
}

impl<R: Real> SampleSums<R> {
    /// Returns the sums of no samples; `like` sets the number of lanes.
    pub fn zero(like: R) -> Self {
        let zero = Vector::splat(like, Vec3::ZERO);
        Self {
            colors: zero,
            squares: zero,
        }
    }

    /// Adds a sample.
    #[inline(always)]
    pub fn add(&mut self, color: Vector<R>) {
        self.colors = self.colors + color;
        self.squares = self.squares + color.times(color);
    }
}
