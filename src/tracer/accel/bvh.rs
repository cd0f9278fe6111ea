//! A bounding volume hierarchy with up to eight children per node.

use super::arena::Arena;
use super::build::{self, TooLarge};
use super::kernel::SingleTraversal;
use super::layout::{self, NodeRef};
use super::search::Search;
use super::statistics::{BvhStatistics, node_bounds};
use crate::accel::Quality;
use crate::cost::Probe;
use math::simd::Simd;
use world::geometry::Ray;
use world::scene::Primitive;

/// A bounding volume hierarchy over some of a scene's primitives.
#[derive(Debug, Clone, PartialEq)]
pub struct Bvh {
    arena: Arena,
}

impl Bvh {
    /// Greatest number of primitives.
    pub const MAX_PRIMITIVES: usize = build::MAX_PRIMITIVES;

    /// Returns the expected bytes per primitive of the hierarchy, and the bytes of its build, which are
    /// free later.
    pub fn bytes_per_primitive(quality: Quality) -> [usize; 2] {
        build::bytes_per_primitive(quality)
    }

    /// Returns the expected IDs of nodes, per primitive.
    pub fn ids_per_primitive(quality: Quality) -> f64 {
        build::lines_per_primitive(quality)
    }

    /// Builds the hierarchy over all primitives except the `unbounded`, whose indices ascend; over
    /// at most [`MAX_PRIMITIVES`](Self::MAX_PRIMITIVES). The result does not depend on the number
    /// of threads. Calls `report` with each finished share of the build, from any thread; the
    /// shares add up to 1.
    ///
    /// # Errors
    /// If the hierarchy is larger than 8 GiB, which takes at least 100 million primitives.
    pub fn new(
        primitives: &[Primitive],
        unbounded: &[u32],
        quality: Quality,
        report: impl Fn(f64) + Sync,
    ) -> Result<Self, TooLarge> {
        let arena = build::arena(Simd::best(), primitives, unbounded, quality, report)?;
        Ok(Self { arena })
    }

    /// Returns the hierarchy refitted to other primitives, or `None` if their number or kinds
    /// differ.
    pub(super) fn refitted(&self, primitives: &[Primitive]) -> Option<Self> {
        let arena = build::refitted(Simd::best(), &self.arena, primitives)?;
        Some(Self { arena })
    }

    /// Returns true if the hierarchy is over these triangles.
    pub(super) fn is_of_triangles(&self, triangles: &[Primitive]) -> bool {
        build::has_triangles(&self.arena, triangles)
    }

    /// Returns the size and expected cost.
    pub fn statistics(&self) -> BvhStatistics {
        BvhStatistics::measure(&self.arena)
    }

    /// Returns the surface area of the root's box; 0 if it is empty.
    pub(super) fn surface_area(&self) -> f64 {
        if self.arena.is_empty() {
            return 0.0;
        }
        let root = layout::node(self.arena.lines(), NodeRef::ROOT);
        node_bounds(root).surface_area().into()
    }

    /// Returns the nodes and leaves.
    pub(super) fn arena(&self) -> &Arena {
        &self.arena
    }

    /// Traverses the hierarchy with one ray, which has had `n_tests` tests before.
    #[inline]
    pub(super) fn traverse<S: Search, P: Probe>(
        &self,
        simd: Simd,
        ray: &Ray,
        search: &mut S,
        probe: &mut P,
        n_tests: u32,
    ) {
        if self.arena.is_empty() {
            return probe.traversal(0, n_tests);
        }
        simd.run(SingleTraversal {
            arena: &self.arena,
            ray,
            search,
            probe,
            n_tests,
        });
    }
}
