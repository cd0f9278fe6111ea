//! Rays by the number of bounces before them.

/// Numbers of rays of a pixel, by the number of bounces between the camera and their start: the
/// last entry includes all later bounces. Shadow rays count at the bounce of the point that they
/// leave.
pub type RaysByBounce = [u32; N_BOUNCES];

/// Number of bounce counts kept separately.
pub const N_BOUNCES: usize = 8;

/// Rays of many pixels by bounce, if requested.
#[derive(Debug, Clone, Default)]
pub struct BounceCounts {
    is_kept: bool,
    counts: Vec<RaysByBounce>,
}

impl BounceCounts {
    /// Creates counts that are kept only if `is_kept`.
    pub fn new(is_kept: bool) -> Self {
        Self {
            is_kept,
            counts: Vec::new(),
        }
    }

    /// Returns true if rays are counted.
    #[inline]
    pub fn is_kept(&self) -> bool {
        self.is_kept
    }

    /// Resets the counts for `n_pixels` pixels.
    pub fn reset(&mut self, n_pixels: usize) {
        if self.is_kept {
            self.counts.clear();
            self.counts.resize(n_pixels, [0; N_BOUNCES]);
        }
    }

    /// Resets the counts of one pixel.
    pub fn reset_pixel(&mut self, pixel: usize) {
        if self.is_kept {
            self.counts[pixel] = [0; N_BOUNCES];
        }
    }

    /// Adds rays of a pixel, if rays are counted.
    #[inline]
    pub fn add(&mut self, pixel: usize, bounce: u32, n_rays: u32) {
        if self.is_kept {
            self.counts[pixel][(bounce as usize).min(N_BOUNCES - 1)] += n_rays;
        }
    }

    /// Adds rays of a pixel by bounce, if rays are counted.
    pub fn add_all(&mut self, pixel: usize, n_rays: &RaysByBounce) {
        if self.is_kept {
            for (sum, n) in self.counts[pixel].iter_mut().zip(n_rays) {
                *sum += n;
            }
        }
    }

    /// Adds a ray to each of these pixels, if rays are counted.
    pub fn add_to_pixels(&mut self, pixels: &[u32], bounce: u32) {
        if self.is_kept {
            for &pixel in pixels {
                self.add(pixel as usize, bounce, 1);
            }
        }
    }

    /// Returns the counts of each pixel; empty if rays are not counted.
    pub fn get(&self) -> &[RaysByBounce] {
        &self.counts
    }
}
