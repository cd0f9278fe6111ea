//! Counters of many pixels at a time.

use super::{Cost, Counter, RayKind, Traversals};

/// What the work on some pixels cost, array by array, an entry a pixel.
///
/// To count shall cost little beside what is counted: camera rays are as many as
/// there are samples, and what no pixel has takes no memory.
#[derive(Debug, Clone, Default)]
pub struct Counters {
    /// Camera rays of each pixel.
    n_samples: u32,
    node_visits: Vec<u64>,
    primitive_tests: Vec<u64>,
    /// Rays of each kind but the camera's, in the order of [`RayKind`]; empty
    /// where no pixel has one.
    rays: [Vec<u64>; 4],
    /// Empty where no path bounces.
    depth: Vec<u64>,
}

impl Counters {
    /// Begins anew with so many pixels of so many samples, whose camera rays are
    /// counted with that.
    pub fn reset(&mut self, n_pixels: usize, n_samples: u32) {
        self.n_samples = n_samples;
        for counts in [&mut self.node_visits, &mut self.primitive_tests] {
            counts.clear();
            counts.resize(n_pixels, 0);
        }
        self.rays.iter_mut().for_each(Vec::clear);
        self.depth.clear();
    }

    /// One counter of each pixel; empty where it is 0 for all.
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

    /// How many pixels.
    pub fn n_pixels(&self) -> usize {
        self.node_visits.len()
    }

    /// What one pixel cost.
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

    /// What all pixels cost together.
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

    /// Adds what one pixel cost.
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

    /// Adds so many rays of this kind, not the camera's.
    #[inline(always)]
    pub(super) fn add_rays(&mut self, kind: RayKind, pixel: usize, n: u64) {
        let n_pixels = self.n_pixels();
        present(&mut self.rays[kind as usize], n_pixels)[pixel] += n;
    }

    /// Adds the counters of one ray's traversal to each of these pixels.
    #[inline(always)]
    pub(super) fn add_traversals<const N: usize>(
        &mut self,
        pixels: &[u32; N],
        traversals: &Traversals<N>,
    ) {
        // Slices of their own: what is written through a `Vec` could be its
        // length, and that of the other, which would be read again each time.
        let (all_visits, all_tests) = (&mut self.node_visits[..], &mut self.primitive_tests[..]);
        traversals.for_each(|i, visits, tests| {
            let pixel = pixels[i] as usize;
            all_visits[pixel] += u64::from(visits);
            all_tests[pixel] += u64::from(tests);
        });
    }

    /// A path of the pixel has come to so many bounces.
    #[inline(always)]
    pub(super) fn bounce(&mut self, pixel: usize, depth: u64) {
        let n_pixels = self.n_pixels();
        let deepest = &mut present(&mut self.depth, n_pixels)[pixel];
        *deepest = depth.max(*deepest);
    }
}

/// The counts, which have an entry a pixel from now on.
#[inline(always)]
fn present(counts: &mut Vec<u64>, n_pixels: usize) -> &mut [u64] {
    if counts.is_empty() {
        begin(counts, n_pixels);
    }
    counts
}

#[cold]
#[inline(never)]
fn begin(counts: &mut Vec<u64>, n_pixels: usize) {
    counts.resize(n_pixels, 0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_pixel_has_its_own_and_the_total_is_the_sum() {
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
