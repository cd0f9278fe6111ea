//! Who listens while rays are traced.

use super::{Cost, RayKind};

/// Listens to the work on one pixel. Kernels count in locals and report once
/// a ray.
pub trait Probe {
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
    #[inline(always)]
    fn ray(&mut self, _: RayKind) {}
    #[inline(always)]
    fn traversal(&mut self, _: u32, _: u32) {}
    #[inline(always)]
    fn bounce(&mut self, _: u32) {}
}

impl Probe for Cost {
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
