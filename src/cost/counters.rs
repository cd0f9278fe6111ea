//! The counters of many pixels.

use super::{Cost, Counter, RayKind, Traversals};

/// The counters of some pixels: one array per counter, one entry per pixel.
///
/// To keep counting cheap, camera rays are stored as the number of samples, and
/// an array is empty while its counter is 0 for all pixels.
#[derive(Debug, Clone, Default)]
pub struct Counters {
    /// Camera rays per pixel.
    n_samples: u32,
    node_visits: Vec<u64>,
    primitive_tests: Vec<u64>,
    /// Rays by kind except camera rays, in the order of [`RayKind`]; empty if no
    /// pixel has one.
    rays: [Vec<u64>; 4],
    /// Empty if no path bounces.
    depth: Vec<u64>,
}

impl Counters {
    /// Resets all counters to those of `n_pixels` pixels with `n_samples` camera
    /// rays each.
    pub fn reset(&mut self, n_pixels: usize, n_samples: u32) {
        self.n_samples = n_samples;
        for counts in [&mut self.node_visits, &mut self.primitive_tests] {
            counts.clear();
            counts.resize(n_pixels, 0);
        }
        self.rays.iter_mut().for_each(Vec::clear);
        self.depth.clear();
    }

    /// Returns a counter of all pixels; empty if it is 0 for all.
    pub fn get(&self, counter: Counter) -> &[u64] {
        match counter {
            Counter::NodeVisits => &self.node_visits,
            Counter::PrimitiveTests => &self.primitive_tests,
            Counter::ShadowRays => &self.rays[RayKind::Shadow as usize],
            Counter::ReflectionRays => &self.rays[RayKind::Reflection as usize],
            Counter::RefractionRays => &self.rays[RayKind::Refraction as usize],
            Counter::Depth => &self.depth,
        }
    }

    /// The number of pixels.
    pub fn n_pixels(&self) -> usize {
        self.node_visits.len()
    }

    /// Returns the cost of one pixel.
    pub fn of(&self, pixel: usize) -> Cost {
        let at = |counts: &Vec<u64>| counts.get(pixel).copied().unwrap_or(0);
        let mut rays = self.rays.each_ref().map(at);
        rays[RayKind::Camera as usize] = self.n_samples.into();
        Cost {
            node_visits: self.node_visits[pixel],
            primitive_tests: self.primitive_tests[pixel],
            rays,
            depth: at(&self.depth),
        }
    }

    /// Returns the total cost of all pixels.
    pub fn total(&self) -> Cost {
        let sum = |counts: &Vec<u64>| counts.iter().sum();
        let mut rays = self.rays.each_ref().map(sum);
        rays[RayKind::Camera as usize] = self.n_pixels() as u64 * u64::from(self.n_samples);
        Cost {
            node_visits: sum(&self.node_visits),
            primitive_tests: sum(&self.primitive_tests),
            rays,
            depth: self.depth.iter().copied().max().unwrap_or(0),
        }
    }

    /// Adds the cost of one pixel.
    pub fn add(&mut self, pixel: usize, cost: &Cost) {
        debug_assert_eq!(cost.rays_of(RayKind::Camera), u64::from(self.n_samples));
        self.node_visits[pixel] += cost.node_visits;
        self.primitive_tests[pixel] += cost.primitive_tests;
        for kind in [RayKind::Shadow, RayKind::Reflection, RayKind::Refraction] {
            if cost.rays_of(kind) > 0 {
                self.add_rays(kind, pixel, cost.rays_of(kind));
            }
        }
        if cost.depth > 0 {
            self.bounce(pixel, cost.depth);
        }
    }

    /// Adds `n` rays of this kind, which are not camera rays.
    #[inline(always)]
    pub(super) fn add_rays(&mut self, kind: RayKind, pixel: usize, n: u64) {
        let n_pixels = self.n_pixels();
        allocated(&mut self.rays[kind as usize], n_pixels)[pixel] += n;
    }

    /// Adds the counters of traversal `i` to `pixels[i]`.
    #[inline(always)]
    pub(super) fn add_traversals<const N: usize>(
        &mut self,
        pixels: &[u32; N],
        traversals: &Traversals<N>,
    ) {
        // Slices, so that the compiler keeps their lengths in registers: a write
        // through a `Vec` could alias the length of either.
        let (all_visits, all_tests) = (&mut self.node_visits[..], &mut self.primitive_tests[..]);
        traversals.for_each(|i, visits, tests| {
            let pixel = pixels[i] as usize;
            all_visits[pixel] += u64::from(visits);
            all_tests[pixel] += u64::from(tests);
        });
    }

    /// A path of the pixel has reached `depth` bounces.
    #[inline(always)]
    pub(super) fn bounce(&mut self, pixel: usize, depth: u64) {
        let n_pixels = self.n_pixels();
        let deepest = &mut allocated(&mut self.depth, n_pixels)[pixel];
        *deepest = depth.max(*deepest);
    }
}

/// Returns the counts, after allocating one entry per pixel if there is none.
#[inline(always)]
fn allocated(counts: &mut Vec<u64>, n_pixels: usize) -> &mut [u64] {
    if counts.is_empty() {
        allocate(counts, n_pixels);
    }
    counts
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
            rays: [2, 3, 1, 0],
            depth: 7,
        };
        counters.add(1, &cost);
        let traversals = Traversals {
            node_visits: &[5, 7, 4],
            primitive_tests: &[u32::MAX, 9, 2],
            active: 0b101,
        };
        counters.add_traversals(&[1, 2, 0], &traversals);
        counters.add_rays(RayKind::Shadow, 0, 1);
        counters.bounce(1, 6);
        let first = Cost {
            node_visits: 4,
            primitive_tests: 2,
            rays: [2, 1, 0, 0],
            depth: 0,
        };
        let second = Cost {
            node_visits: cost.node_visits + 5,
            primitive_tests: 9 + u64::from(u32::MAX),
            ..cost
        };
        let third = Cost {
            rays: [2, 0, 0, 0],
            ..Cost::default()
        };
        assert_eq!([0, 1, 2].map(|i| counters.of(i)), [first, second, third]);
        assert_eq!(counters.total(), first.with(second).with(third));
        assert_eq!(counters.get(Counter::Depth), [0, 7, 0]);
        assert!(counters.get(Counter::RefractionRays).is_empty());
        counters.reset(1, 0);
        assert_eq!(counters.total(), Cost::default());
    }
}
