//! The observation of many pixels, on all threads, within a limit of memory.

use std::fmt;

use rayon::prelude::*;

use crate::attribution::{PathObserver, RayTree, TracedRay};
use base::stop;
use math::statistics::upper_median;

/// Number of observations of a timed pixel. In the first one the caches are cold, unlike in a
/// rendering, where the neighboring pixels have warmed them.
const N_TIMES: usize = 5;

/// Least number of paths between two checks of the memory.
const N_SAMPLES: u32 = 1 << 12;

/// A pixel and its rays.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservedPixel {
    /// Column and row; row 0 is on top.
    pub place: (u32, u32),
    /// The rays of the pixel.
    pub tree: RayTree,
}

/// Error: the rays need more memory than is available, or there are more than an `i32` can count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TooManyRays {
    /// Number of observed pixels.
    pub n_pixels: usize,
    /// Number of their rays, which is too large.
    pub n_rays: usize,
}

impl fmt::Display for TooManyRays {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "these are too many rays: {} pixels have {} of them already",
            self.n_pixels, self.n_rays
        )
    }
}

impl std::error::Error for TooManyRays {}

impl PathObserver<'_> {
    /// Observes many pixels on the current rayon pool. The time of each ray is the median of
    /// several observations. Calls `report` with the number of pixels that have been finished since
    /// the last call.
    ///
    /// # Errors
    /// As soon as the rays take more than `n_bytes` of memory, or there are more than an `i32` can
    /// count.
    pub fn observe_many(
        &self,
        places: impl Iterator<Item = (u32, u32)>,
        n_bytes: u64,
        report: impl Fn(u64),
    ) -> Result<Vec<ObservedPixel>, TooManyRays> {
        let batch_len = N_SAMPLES.div_ceil(self.most_samples()) as usize;
        let mut places = places.peekable();
        let (mut pixels, mut n_rays) = (Vec::new(), 0);
        while places.peek().is_some() && !stop::is_requested() {
            let batch: Vec<_> = places.by_ref().take(batch_len).collect();
            let n_new = batch.len();
            pixels.par_extend(
                batch
                    .into_par_iter()
                    .map(|place| self.observe_repeatedly(place)),
            );
            let new: &[ObservedPixel] = &pixels[pixels.len() - n_new..];
            n_rays += new.iter().map(|pixel| pixel.tree.rays.len()).sum::<usize>();
            report(n_new as u64);
            let used = n_rays * size_of::<TracedRay>() + pixels.len() * size_of::<ObservedPixel>();
            if used as u64 > n_bytes || i32::try_from(n_rays).is_err() {
                let n_pixels = pixels.len();
                return Err(TooManyRays { n_pixels, n_rays });
            }
        }
        Ok(pixels)
    }

    /// Observes a pixel; several times if it is timed.
    fn observe_repeatedly(&self, place: (u32, u32)) -> ObservedPixel {
        let mut tree = RayTree::default();
        self.observe(place, &mut tree);
        if self.is_timed() {
            let mut again = RayTree::default();
            let mut times: Vec<_> = tree.rays.iter().map(|ray| [ray.time_ns; N_TIMES]).collect();
            for time in 1..N_TIMES {
                self.observe(place, &mut again);
                for (times, ray) in times.iter_mut().zip(&again.rays) {
                    times[time] = ray.time_ns;
                }
            }
            for (ray, mut times) in tree.rays.iter_mut().zip(times) {
                let median = upper_median(&mut times, f32::total_cmp);
                ray.time_ns = median.unwrap_or(ray.time_ns);
            }
        }
        tree.rays.shrink_to_fit();
        ObservedPixel { place, tree }
    }
}
