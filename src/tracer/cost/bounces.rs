//! Rays by the number of bounces before them.

/// Numbers of rays of a pixel, by the number of bounces between the camera and their start:
/// the last one has those of all later bounces, too. Shadow rays count at the bounce of
/// the point that they leave.
pub type RaysByBounce = [u32; N_BOUNCES];

/// How many numbers of bounces are counted separately.
pub const N_BOUNCES: usize = 8;

/// The rays of many pixels by bounce, if they are asked for.
#[derive(Debug, Clone, Default)]
pub struct BounceCounts {
    is_kept: bool,
    counts: Vec<RaysByBounce>,
}

impl BounceCounts {
    /// Counts only if it is to keep them.
    pub fn new(is_kept: bool) -> Self {
        Self {
            is_kept,
            counts: Vec::new(),
        }
    }

    /// Whether it counts.
    #[inline]
    pub fn is_kept(&self) -> bool {
        self.is_kept
    }

    /// Resets all counts to those of `n_pixels` pixels.
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

    /// Adds rays of a pixel, unless it does not count.
    #[inline]
    pub fn add(&mut self, pixel: usize, bounce: u32, n_rays: u32) {
        if self.is_kept {
            self.counts[pixel][(bounce as usize).min(N_BOUNCES - 1)] += n_rays;
        }
    }

    /// The counts of each pixel; empty if it does not count.
    pub fn get(&self) -> &[RaysByBounce] {
        &self.counts
    }
}
