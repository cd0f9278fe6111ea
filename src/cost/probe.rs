//! Who listens while rays are traced.

use super::{Cost, Counters, RayKind};

/// Listens to the work on one pixel. Kernels count in locals and report once
/// a ray.
pub trait Probe {
    /// Whether it listens at all.
    const COUNTS: bool;
    /// A ray starts.
    fn ray(&mut self, kind: RayKind);
    /// A ray has ended after so many nodes and tests.
    fn traversal(&mut self, node_visits: u32, primitive_tests: u32);
    /// A path has come to this many bounces.
    fn bounce(&mut self, depth: u32);
}

/// Hears nothing and costs nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoProbe;

impl Probe for NoProbe {
    const COUNTS: bool = false;

    #[inline(always)]
    fn ray(&mut self, _: RayKind) {}
    #[inline(always)]
    fn traversal(&mut self, _: u32, _: u32) {}
    #[inline(always)]
    fn bounce(&mut self, _: u32) {}
}

impl Probe for Cost {
    const COUNTS: bool = true;

    #[inline]
    fn ray(&mut self, kind: RayKind) {
        self.rays[kind as usize] += 1;
    }

    #[inline]
    fn traversal(&mut self, node_visits: u32, primitive_tests: u32) {
        self.node_visits += u64::from(node_visits);
        self.primitive_tests += u64::from(primitive_tests);
    }

    #[inline]
    fn bounce(&mut self, depth: u32) {
        self.depth = self.depth.max(depth.into());
    }
}

/// What the ways of some rays in a row were.
#[derive(Debug, Clone, Copy)]
pub struct Traversals<'a, const N: usize> {
    /// Nodes that each has visited.
    pub node_visits: &'a [u32; N],
    /// Primitives that each was tested with.
    pub primitive_tests: &'a [u32; N],
    /// A bit each, the first ray's the lowest: whether this is told of it.
    pub told: u32,
}

impl<const N: usize> Traversals<'_, N> {
    /// Tells of each ray of which this is told: its index, nodes and tests.
    #[inline(always)]
    pub fn for_each(&self, mut tell: impl FnMut(usize, u32, u32)) {
        let mut tell = |i: usize| tell(i, self.node_visits[i], self.primitive_tests[i]);
        if self.told.count_ones() as usize == N {
            // As good as always: without a branch for each.
            (0..N).for_each(tell);
        } else {
            let mut told = self.told;
            while told != 0 {
                tell(told.trailing_zeros() as usize % N);
                told &= told - 1;
            }
        }
    }
}

/// Listens to rays that are traced many at a time.
pub trait StreamProbe {
    /// Whether [`traversals`](Self::traversals) wants to be called.
    const COUNTS: bool;
    /// Rays of the stream from number `first` on have ended after so many nodes
    /// and tests.
    fn traversals<const N: usize>(&mut self, first: usize, traversals: &Traversals<N>);
}

impl StreamProbe for NoProbe {
    const COUNTS: bool = false;

    #[inline(always)]
    fn traversals<const N: usize>(&mut self, _: usize, _: &Traversals<N>) {}
}

/// Listens to the work on many pixels, which have numbers from 0 on.
pub trait PixelProbe: Default {
    /// Whether it listens at all.
    const COUNTS: bool;
    /// Forgets all, and is ready for so many pixels of so many samples: as many
    /// camera rays.
    fn reset(&mut self, n_pixels: usize, n_samples: u32);
    /// So many rays of this kind, not the camera's, start for a pixel.
    fn rays(&mut self, kind: RayKind, pixel: usize, n: usize);
    /// A ray of each of these pixels has ended after so many nodes and tests.
    fn traversals<const N: usize>(&mut self, pixels: &[u32; N], traversals: &Traversals<N>);
    /// A path of a pixel has come to this many bounces.
    fn bounce(&mut self, pixel: usize, depth: u32);
    /// What it has counted, if it listens.
    fn counted(&self) -> Option<&Counters>;
}

impl PixelProbe for NoProbe {
    const COUNTS: bool = false;

    fn reset(&mut self, _: usize, _: u32) {}
    #[inline(always)]
    fn rays(&mut self, _: RayKind, _: usize, _: usize) {}
    #[inline(always)]
    fn traversals<const N: usize>(&mut self, _: &[u32; N], _: &Traversals<N>) {}
    #[inline(always)]
    fn bounce(&mut self, _: usize, _: u32) {}

    fn counted(&self) -> Option<&Counters> {
        None
    }
}

impl PixelProbe for Counters {
    const COUNTS: bool = true;

    fn reset(&mut self, n_pixels: usize, n_samples: u32) {
        self.reset(n_pixels, n_samples);
    }

    #[inline(always)]
    fn rays(&mut self, kind: RayKind, pixel: usize, n: usize) {
        self.add_rays(kind, pixel, n as u64);
    }

    #[inline(always)]
    fn traversals<const N: usize>(&mut self, pixels: &[u32; N], traversals: &Traversals<N>) {
        self.add_traversals(pixels, traversals);
    }

    #[inline(always)]
    fn bounce(&mut self, pixel: usize, depth: u32) {
        self.bounce(pixel, depth.into());
    }

    fn counted(&self) -> Option<&Counters> {
        Some(self)
    }
}

/// Passes on what a stream's rays tell, each to its pixel.
#[derive(Debug)]
pub struct ByPixel<'a, P> {
    probe: &'a mut P,
    pixels: &'a [u32],
}

impl<'a, P: PixelProbe> ByPixel<'a, P> {
    /// The pixel of ray `i` is `pixels[i]`.
    pub fn new(probe: &'a mut P, pixels: &'a [u32]) -> Self {
        Self { probe, pixels }
    }
}

impl<P: PixelProbe> StreamProbe for ByPixel<'_, P> {
    const COUNTS: bool = P::COUNTS;

    #[inline(always)]
    fn traversals<const N: usize>(&mut self, first: usize, traversals: &Traversals<N>) {
        if P::COUNTS {
            let pixels = self.pixels[first..].first_chunk();
            self.probe
                .traversals(pixels.expect("a pixel a ray"), traversals);
        }
    }
}
