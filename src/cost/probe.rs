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

/// Listens to rays that are traced many at a time.
pub trait StreamProbe {
    /// Whether [`traversal`](Self::traversal) wants to be called.
    const COUNTS: bool;
    /// Ray number `ray` of the stream has ended after so many nodes and tests.
    fn traversal(&mut self, ray: usize, node_visits: u32, primitive_tests: u32);
}

impl StreamProbe for NoProbe {
    const COUNTS: bool = false;

    #[inline(always)]
    fn traversal(&mut self, _: usize, _: u32, _: u32) {}
}

/// Listens to the work on many pixels, which have numbers from 0 on.
pub trait PixelProbe: Default {
    /// Whether it listens at all.
    const COUNTS: bool;
    /// Forgets all, and is ready for so many pixels.
    fn reset(&mut self, n_pixels: usize);
    /// A ray of this kind starts for each of these pixels.
    fn rays(&mut self, kind: RayKind, pixels: &[u32]);
    /// A ray of a pixel has ended after so many nodes and tests.
    fn traversal(&mut self, pixel: usize, node_visits: u32, primitive_tests: u32);
    /// A path of a pixel has come to this many bounces.
    fn bounce(&mut self, pixel: usize, depth: u32);
    /// What it has counted, if it listens.
    fn counted(&self) -> Option<&Counters>;
}

impl PixelProbe for NoProbe {
    const COUNTS: bool = false;

    fn reset(&mut self, _: usize) {}
    fn rays(&mut self, _: RayKind, _: &[u32]) {}
    #[inline(always)]
    fn traversal(&mut self, _: usize, _: u32, _: u32) {}
    #[inline(always)]
    fn bounce(&mut self, _: usize, _: u32) {}

    fn counted(&self) -> Option<&Counters> {
        None
    }
}

impl PixelProbe for Counters {
    const COUNTS: bool = true;

    fn reset(&mut self, n_pixels: usize) {
        self.reset(n_pixels);
    }

    fn rays(&mut self, kind: RayKind, pixels: &[u32]) {
        self.add_rays(kind, pixels);
    }

    #[inline(always)]
    fn traversal(&mut self, pixel: usize, node_visits: u32, primitive_tests: u32) {
        self.add_traversal(pixel, node_visits, primitive_tests);
    }

    #[inline(always)]
    fn bounce(&mut self, pixel: usize, depth: u32) {
        self.bounce(pixel, depth);
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

    /// All rays of the stream, of one kind, start.
    pub fn rays(&mut self, kind: RayKind) {
        self.probe.rays(kind, self.pixels);
    }
}

impl<P: PixelProbe> StreamProbe for ByPixel<'_, P> {
    const COUNTS: bool = P::COUNTS;

    #[inline(always)]
    fn traversal(&mut self, ray: usize, node_visits: u32, primitive_tests: u32) {
        if P::COUNTS {
            let pixel = self.pixels[ray] as usize;
            self.probe.traversal(pixel, node_visits, primitive_tests);
        }
    }
}
