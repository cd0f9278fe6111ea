//! Who listens while rays are traced.

use super::{Cost, RayKind};

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

impl From<NoProbe> for Cost {
    /// Nothing.
    fn from(_: NoProbe) -> Self {
        Self::default()
    }
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

/// Passes on what a stream's rays tell to the probes of their pixels.
#[derive(Debug)]
pub struct ByPixel<'a, P> {
    probes: &'a mut [P],
    pixels: &'a [u32],
}

impl<'a, P: Probe> ByPixel<'a, P> {
    /// The pixel of ray `i` is `pixels[i]`, an index into `probes`.
    pub fn new(probes: &'a mut [P], pixels: &'a [u32]) -> Self {
        Self { probes, pixels }
    }

    /// All rays of the stream, of one kind, start.
    pub fn rays(&mut self, kind: RayKind) {
        if P::COUNTS {
            for &pixel in self.pixels {
                self.probes[pixel as usize].ray(kind);
            }
        }
    }
}

impl<P: Probe> StreamProbe for ByPixel<'_, P> {
    const COUNTS: bool = P::COUNTS;

    #[inline(always)]
    fn traversal(&mut self, ray: usize, node_visits: u32, primitive_tests: u32) {
        if P::COUNTS {
            let pixel = self.pixels[ray] as usize;
            self.probes[pixel].traversal(node_visits, primitive_tests);
        }
    }
}
