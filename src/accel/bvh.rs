//! A bounding volume hierarchy of eight children a node.

use super::build;
use super::kernel::Traversal;
use super::layout::Line;
use super::search::Search;
use super::simd::Simd;
use super::statistics::BvhStatistics;
use crate::cost::Probe;
use crate::geometry::Ray;
use crate::scene::Primitive;

/// A bounding volume hierarchy over some of a scene's primitives.
#[derive(Debug, Clone, PartialEq)]
pub struct Bvh {
    /// The root first; empty if there are no primitives.
    lines: Vec<Line>,
    /// The largest coordinate in magnitude.
    largest: f32,
}

impl Bvh {
    /// Most primitives that are sure to fit.
    pub const MAX_PRIMITIVES: usize = build::MAX_PRIMITIVES;

    /// Bytes of memory for each primitive, at most, while it is built.
    pub const MAX_BYTES_PER_PRIMITIVE: usize = build::MAX_BYTES_PER_PRIMITIVE;

    /// Builds the hierarchy over the primitives with these indices; the same
    /// one on any number of threads.
    ///
    /// # Panics
    /// If it is larger than 8 GiB, which takes more than
    /// [`MAX_PRIMITIVES`](Self::MAX_PRIMITIVES), and commonly ten times as many.
    pub fn new(primitives: &[Primitive], indices: Vec<u32>) -> Self {
        let (lines, bounds) = build::arena(primitives, indices);
        let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
        Self { lines, largest }
    }

    /// Its size and expected cost.
    pub fn statistics(&self) -> BvhStatistics {
        BvhStatistics::of(&self.lines)
    }

    /// Shows the primitives that the ray may hit to the search; tells the probe
    /// of the nodes, and of the tests with `n_tests` more.
    #[inline]
    pub(super) fn traverse<S: Search, P: Probe>(
        &self,
        simd: Simd,
        ray: &Ray,
        search: &mut S,
        probe: &mut P,
        n_tests: u32,
    ) {
        if self.lines.is_empty() {
            return probe.traversal(0, n_tests);
        }
        simd.run(Traversal {
            lines: &self.lines,
            largest: self.largest,
            ray,
            search,
            probe,
            n_tests,
        });
    }
}
