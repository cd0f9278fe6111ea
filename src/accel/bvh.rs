//! A bounding volume hierarchy of eight children a node.

use super::arena::Arena;
use super::build::{self, TooLarge};
use super::kernel::Traversal;
use super::search::Search;
use super::simd::Simd;
use super::statistics::BvhStatistics;
use crate::config::Quality;
use crate::cost::Probe;
use crate::geometry::Ray;
use crate::scene::Primitive;

/// A bounding volume hierarchy over some of a scene's primitives.
#[derive(Debug, Clone, PartialEq)]
pub struct Bvh {
    arena: Arena,
}

impl Bvh {
    /// Most primitives.
    pub const MAX_PRIMITIVES: usize = build::MAX_PRIMITIVES;

    /// Bytes of memory for each primitive, at most, while it is built.
    pub fn bytes_per_primitive(quality: Quality) -> usize {
        build::bytes_per_primitive(quality)
    }

    /// Builds the hierarchy over the primitives with these indices, at most
    /// [`MAX_PRIMITIVES`](Self::MAX_PRIMITIVES); the same one on any number of
    /// threads. `report` hears of the parts that are done, which add up to 1,
    /// from any thread.
    ///
    /// # Errors
    /// If it is larger than 8 GiB, which takes 100 million primitives or more.
    pub fn new(
        primitives: &[Primitive],
        indices: Vec<u32>,
        quality: Quality,
        report: impl Fn(f64) + Sync,
    ) -> Result<Self, TooLarge> {
        let arena = build::arena(primitives, indices, quality, report)?;
        Ok(Self { arena })
    }

    /// Its size and expected cost.
    pub fn statistics(&self) -> BvhStatistics {
        BvhStatistics::of(&self.arena)
    }

    /// Where a ray's way through it leads.
    pub(super) fn arena(&self) -> &Arena {
        &self.arena
    }

    /// The way of a ray through it; `n_tests` tests were before.
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
        simd.run(Traversal {
            arena: &self.arena,
            ray,
            search,
            probe,
            n_tests,
        });
    }
}
