//! The counters of many pixels.

use super::{Cost, Counter, RayKind, Traversals};

/// The counters of some pixels: one array per counter, one entry per pixel.
///
/// To keep counting cheap, camera rays are stored as the number of samples where all pixels have
/// the same, and the array of a counter that few pictures need is empty while it is 0 for all
/// pixels.
#[derive(Debug, Clone, Default)]
pub struct Counters {
    n_pixels: usize,
    /// Camera rays of every pixel; 0 if they are counted.
    n_samples: u32,
    /// In the order of [`Counter::ALL`]. The counters of traversals are never empty.
    counts: [Vec<u64>; Counter::ALL.len()],
    /// The nanoseconds of launches on a device since they were last taken.
    pub(super) device_ns: f64,
}

impl Counters {
    /// Resets all counters for `n_pixels` pixels with `n_samples` camera rays each; 0 if camera
    /// rays will be counted.
    pub fn reset(&mut self, n_pixels: usize, n_samples: u32) {
        (self.n_pixels, self.n_samples) = (n_pixels, n_samples);
        self.counts.iter_mut().for_each(Vec::clear);
        for counter in [Counter::NodeVisits, Counter::PrimitiveTests] {
            self.counts[counter as usize].resize(n_pixels, 0);
        }
    }

    /// Returns a counter of all pixels; empty if it is 0 for all.
    #[inline]
    pub fn get(&self, counter: Counter) -> &[u64] {
        &self.counts[counter as usize]
    }

    /// Returns the number of pixels.
    #[inline]
    pub fn n_pixels(&self) -> usize {
        self.n_pixels
    }

    /// Returns the cost of one pixel.
    #[inline]
    pub fn pixel(&self, pixel: usize) -> Cost {
        self.cost(1, |counts| counts.get(pixel).copied().unwrap_or(0))
    }

    /// Returns the total cost of all pixels.
    pub fn total(&self) -> Cost {
        let depths = self.get(Counter::Depth).iter();
        Cost {
            depth: depths.copied().max().unwrap_or(0),
            ..self.cost(self.n_pixels as u64, |counts| counts.iter().sum())
        }
    }

    /// Returns the cost of `n_pixels` pixels with these sums of their counters.
    fn cost(&self, n_pixels: u64, sum: impl Fn(&[u64]) -> u64) -> Cost {
        let mut cost = Cost::default();
        for counter in Counter::ALL {
            *cost.get_mut(counter) = sum(self.get(counter));
        }
        cost.rays[RayKind::Camera as usize] += n_pixels * u64::from(self.n_samples);
        cost
    }

    /// Adds the cost of one pixel.
    #[inline]
    pub fn add(&mut self, pixel: usize, cost: &Cost) {
        let n_samples = u64::from(self.n_samples);
        debug_assert!(n_samples == 0 || n_samples == cost.rays_of(RayKind::Camera));
        self.add_path(pixel, cost);
    }

    /// Adds the cost of a path of one pixel; camera rays only if they are counted.
    pub(super) fn add_path(&mut self, pixel: usize, cost: &Cost) {
        let n_samples = u64::from(self.n_samples);
        for counter in Counter::ALL {
            match cost.get(counter) {
                0 => {}
                _ if counter == Counter::Samples && n_samples > 0 => {}
                depth if counter == Counter::Depth => self.bounce(&[pixel as u32], depth),
                count => self.allocated(counter)[pixel] += count,
            }
        }
    }

    /// Adds `n` camera rays, if they are counted.
    pub(super) fn add_camera_rays(&mut self, pixel: usize, n: u64) {
        self.allocated(Counter::rays(RayKind::Camera))[pixel] += n;
    }

    /// Adds a ray of this kind, which is not a camera ray, to each of these pixels.
    pub(super) fn add_rays_of_pixels(&mut self, kind: RayKind, pixels: &[u32]) {
        if !pixels.is_empty() {
            let counts = self.allocated(Counter::rays(kind));
            for &pixel in pixels {
                counts[pixel as usize] += 1;
            }
        }
    }

    /// Adds the counters of traversal `i` to `pixels[i]`.
    #[inline(always)]
    pub(super) fn add_traversals<const N: usize>(
        &mut self,
        pixels: &[u32; N],
        traversals: &Traversals<N>,
    ) {
        const { assert!(Counter::NodeVisits as usize == 0 && Counter::PrimitiveTests as usize == 1) }
        // Slices, so that the compiler keeps their lengths in registers: a write through a `Vec`
        // could alias the length of either.
        let [all_visits, all_tests, ..] = &mut self.counts;
        let (all_visits, all_tests) = (&mut all_visits[..], &mut all_tests[..]);
        traversals.for_each(|i, visits, tests| {
            let pixel = pixels[i] as usize;
            all_visits[pixel] += u64::from(visits);
            all_tests[pixel] += u64::from(tests);
        });
    }

    /// Records that a path of each of these pixels has reached `depth` bounces.
    pub(super) fn bounce(&mut self, pixels: &[u32], depth: u64) {
        if !pixels.is_empty() {
            let all = self.allocated(Counter::Depth);
            for &pixel in pixels {
                let deepest = &mut all[pixel as usize];
                *deepest = depth.max(*deepest);
            }
        }
    }

    /// Returns a counter, after allocating one entry per pixel if there is none.
    #[inline(always)]
    fn allocated(&mut self, counter: Counter) -> &mut [u64] {
        let counts = &mut self.counts[counter as usize];
        if counts.is_empty() {
            allocate(counts, self.n_pixels);
        }
        counts
    }
}

#[cold]
#[inline(never)]
fn allocate(counts: &mut Vec<u64>, n_pixels: usize) {
    counts.resize(n_pixels, 0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_counted_separately_and_the_total_is_their_sum() {
        let mut counters = Counters::default();
        counters.reset(3, 2);
        let cost = Cost {
            node_visits: 1 << 40,
            primitive_tests: 9,
            rays: [2, 3, 1, 0, 0],
            depth: 7,
        };
        counters.add(1, &cost);
        let traversals = Traversals {
            node_visits: &[5, 7, 4],
            primitive_tests: &[u32::MAX, 9, 2],
            active: 0b101,
        };
        counters.add_traversals(&[1, 2, 0], &traversals);
        counters.add_rays_of_pixels(RayKind::Shadow, &[0]);
        counters.bounce(&[1], 6);
        let first = Cost {
            node_visits: 4,
            primitive_tests: 2,
            rays: [2, 1, 0, 0, 0],
            depth: 0,
        };
        let second = Cost {
            node_visits: cost.node_visits + 5,
            primitive_tests: 9 + u64::from(u32::MAX),
            ..cost
        };
        let third = Cost {
            rays: [2, 0, 0, 0, 0],
            ..Cost::default()
        };
        assert_eq!([0, 1, 2].map(|i| counters.pixel(i)), [first, second, third]);
        assert_eq!(counters.total(), first.with(second).with(third));
        assert_eq!(counters.get(Counter::Depth), [0, 7, 0]);
        assert!(counters.get(Counter::RefractionRays).is_empty());
        counters.reset(1, 0);
        assert_eq!(counters.total(), Cost::default());
        counters.add_camera_rays(0, 7);
        counters.add(0, &cost);
        assert_eq!(counters.pixel(0).rays, [9, 3, 1, 0, 0]);
        assert_eq!(counters.total(), counters.pixel(0));
    }
}
