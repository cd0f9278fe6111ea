//! One level of an acceleration structure: a hierarchy, and the unbounded primitives.

use std::sync::Arc;

use rayon::prelude::*;

use super::build::TooLarge;
use super::bvh::Bvh;
use super::layout::CacheLine;
use super::search::Search;
use super::unbounded::Unbounded;
use crate::accel::Acceleration;
use crate::cost::Probe;
use math::simd::Simd;
use world::geometry::Ray;
use world::scene::Primitive;

/// A structure over primitives that are in the same space.
#[derive(Debug, PartialEq)]
pub(super) struct SearchLevel {
    pub(super) unbounded: Unbounded,
    /// `None` for brute force.
    pub(super) bvh: Option<Bvh>,
    n_primitives: usize,
}

impl SearchLevel {
    /// Builds a structure of this kind over the primitives. Calls `report` with each finished share
    /// of the build, from any thread; the shares add up to at most 1.
    ///
    /// # Errors
    /// If the hierarchy is larger than 8 GiB.
    pub(super) fn build(
        primitives: &[Primitive],
        kind: Acceleration,
        report: impl Fn(f64) + Sync,
    ) -> Result<Self, TooLarge> {
        let (unbounded, bvh) = match kind {
            Acceleration::BruteForce => {
                let all = 0..primitives.len() as u32;
                (Unbounded::one_by_one(all.collect()), None)
            }
            Acceleration::Bvh(quality) => {
                let unbounded = unbounded_of(primitives);
                let bvh = Bvh::new(primitives, &unbounded, quality, report)?;
                (Unbounded::new(primitives, unbounded), Some(bvh))
            }
        };
        Ok(Self {
            unbounded,
            bvh,
            n_primitives: primitives.len(),
        })
    }

    /// Returns the structure refitted to other primitives, or `None` if their number or kinds
    /// differ, or for brute force.
    pub(super) fn refitted(&self, primitives: &[Primitive]) -> Option<Self> {
        let unbounded = Unbounded::new(primitives, unbounded_of(primitives));
        let is_alike = primitives.len() == self.n_primitives
            && unbounded.indices().eq(self.unbounded.indices());
        let bvh = self.bvh.as_ref().filter(|_| is_alike)?;
        Some(Self {
            unbounded,
            bvh: Some(bvh.refitted(primitives)?),
            n_primitives: self.n_primitives,
        })
    }

    /// Returns true if this is the structure over these triangles.
    pub(super) fn is_of_triangles(&self, triangles: &[Primitive]) -> bool {
        let bvh = self.bvh.as_ref();
        triangles.len() == self.n_primitives
            && bvh.is_some_and(|bvh| bvh.is_of_triangles(triangles))
    }

    /// Tests the search against all primitives that the ray may hit. Reports the counters to the
    /// probe.
    #[inline]
    pub(super) fn search<S: Search, P: Probe>(
        &self,
        simd: Simd,
        ray: &Ray,
        search: &mut S,
        probe: &mut P,
    ) {
        self.unbounded.test(ray, search);
        let n_tests = self.unbounded.len() as u32;
        match &self.bvh {
            Some(bvh) if !search.is_done() => bvh.traverse(simd, ray, search, probe, n_tests),
            _ => probe.traversal(0, n_tests),
        }
    }

    /// Returns the number of cache lines of the hierarchy, an upper bound of its node IDs.
    pub(super) fn n_ids(&self) -> u64 {
        let lines = self.bvh.as_ref().map(|bvh| bvh.arena().lines().len());
        lines.unwrap_or(0) as u64
    }
}

/// Returns the indices of the primitives without bounds.
fn unbounded_of(primitives: &[Primitive]) -> Vec<u32> {
    let is_unbounded = |&i: &u32| primitives[i as usize].is_unbounded();
    let all = (0..primitives.len() as u32).into_par_iter();
    all.filter(is_unbounded).collect()
}

/// Returns the ID of the first node of each lower level: IDs ascend from level to level.
///
/// # Errors
/// If 32 bits do not suffice.
pub(super) fn first_ids(
    upper: &SearchLevel,
    lower: &[Arc<SearchLevel>],
) -> Result<Vec<u32>, TooLarge> {
    let mut next = upper.n_ids();
    let mut first_ids = Vec::with_capacity(lower.len());
    for level in lower {
        let end = next + level.n_ids();
        if end > u64::from(u32::MAX) {
            let bytes = end * size_of::<CacheLine>() as u64;
            return Err(TooLarge { bytes });
        }
        first_ids.push(next as u32);
        next = end;
    }
    Ok(first_ids)
}
