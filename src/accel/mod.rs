//! Primitives → the nearest hit of a ray, or whether there is any.
//!
//! Two structures with the same results: [`Bvh`], and brute force, which tests
//! every primitive and serves as the reference in tests. Planes have no bounds
//! and stay outside the hierarchy. Of two hits at the same distance the one on
//! the primitive with the lower index counts.
//!
//! `build` writes the hierarchy as cache lines (`layout`, `arena`); `kernel`
//! traverses it, with eight lanes (`simd`), for a nearest-hit or an any-hit
//! `search`.

mod layout;
mod arena;
mod hit;
mod search;
mod record;
mod build;
mod kernel;
mod statistics;
mod unbounded;
mod nodes;
mod bvh;

use std::sync::Arc;

use rayon::prelude::*;

use crate::config::Acceleration;
use crate::cost::{NoProbe, Probe, StreamProbe};
use crate::geometry::{Ray, RayStream};
use crate::scene::{ObjectId, Primitive};
use crate::simd::Simd;

use arena::Arena;
pub use build::TooLarge;
pub use bvh::Bvh;
pub use hit::{Hit, ShadowRay, ShadowStream};
pub use kernel::RAYS_IN_FLIGHT;
use kernel::{Batch, PacketTraversal, StreamTraversal};
pub use nodes::BvhNode;
use record::Recorder;
pub use record::TraversalStep;
use search::{AnyHit, NearestHit, Queries, Search};
pub use statistics::BvhStatistics;
use unbounded::Unbounded;

/// An acceleration structure over the primitives of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Accel<'a> {
    primitives: &'a [Primitive],
    index: Arc<AccelIndex>,
    simd: Simd,
}

/// What an acceleration structure knows of primitives that it does not borrow.
#[derive(Debug, PartialEq)]
pub(crate) struct AccelIndex {
    unbounded: Unbounded,
    bvh: Option<Bvh>,
}

impl<'a> Accel<'a> {
    /// The structure of this kind over the primitives, at most
    /// [`Bvh::MAX_PRIMITIVES`], for the fastest instruction set of the CPU.
    ///
    /// # Panics
    /// If the hierarchy is too large: where [`build`](Self::build) returns an
    /// error.
    pub fn new(primitives: &'a [Primitive], kind: Acceleration) -> Self {
        let built = Self::build(primitives, kind, |_| {});
        built.unwrap_or_else(|too_large| panic!("{too_large}"))
    }

    /// Builds the structure, as [`new`](Self::new) does. Calls `report` with each
    /// finished share of the build, from any thread; the shares add up to at
    /// most 1.
    ///
    /// # Errors
    /// If the hierarchy is larger than 8 GiB, which takes at least 100 million
    /// primitives.
    pub fn build(
        primitives: &'a [Primitive],
        kind: Acceleration,
        report: impl Fn(f64) + Sync,
    ) -> Result<Self, TooLarge> {
        let all = 0..primitives.len() as u32;
        let (unbounded, bvh) = match kind {
            Acceleration::BruteForce => (Unbounded::one_by_one(all.collect()), None),
            Acceleration::Bvh(quality) => {
                let is_unbounded = |&i: &u32| primitives[i as usize].is_unbounded();
                let unbounded: Vec<u32> = all.into_par_iter().filter(is_unbounded).collect();
                let bvh = Bvh::new(primitives, &unbounded, quality, report)?;
                (Unbounded::new(primitives, unbounded), Some(bvh))
            }
        };
        let index = Arc::new(AccelIndex { unbounded, bvh });
        Ok(Self::of_index(primitives, index))
    }

    /// The structure with an index that was built over these primitives.
    pub(crate) fn of_index(primitives: &'a [Primitive], index: Arc<AccelIndex>) -> Self {
        Self {
            primitives,
            index,
            simd: Simd::best(),
        }
    }

    /// Its index, to build it again without the work.
    pub(crate) fn index(&self) -> Arc<AccelIndex> {
        Arc::clone(&self.index)
    }

    /// The same structure, traversed with another instruction set: same hits,
    /// same counters.
    pub fn with_simd(self, simd: Simd) -> Self {
        Self { simd, ..self }
    }

    /// The instruction set.
    pub fn simd(&self) -> Simd {
        self.simd
    }

    /// Size and expected cost of the hierarchy; `None` for brute force.
    pub fn statistics(&self) -> Option<BvhStatistics> {
        self.index.bvh.as_ref().map(Bvh::statistics)
    }

    /// The nearest hit with `t > 0` of the ray, whose direction is a unit
    /// vector.
    pub fn nearest<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        let mut nearest = NearestHit::new(self.primitives);
        self.search(ray, &mut nearest, probe);
        nearest.hit()
    }

    /// Whether the ray, whose direction is a unit vector, hits anything with `t`
    /// in (0, `t_max`) that does not belong to `ignored`.
    ///
    /// Brute force tests all primitives even after a hit: it counts as many
    /// tests as there are primitives.
    pub fn occluded<P: Probe>(
        &self,
        ray: &Ray,
        t_max: f32,
        ignored: Option<ObjectId>,
        probe: &mut P,
    ) -> bool {
        let mut any = AnyHit::new(self.primitives, t_max, ignored);
        self.search(ray, &mut any, probe);
        any.found
    }

    /// [`nearest`](Self::nearest); appends every step of the traversal to
    /// `steps`.
    pub fn record_nearest(&self, ray: &Ray, steps: &mut Vec<TraversalStep>) -> Option<Hit> {
        let nearest = NearestHit::new(self.primitives);
        let mut recorder = Recorder::new(nearest, self.primitives, steps);
        self.search(ray, &mut recorder, &mut NoProbe);
        recorder.into_parts().0.hit()
    }

    /// [`occluded`](Self::occluded); appends every step of the traversal to
    /// `steps` and returns the hit that occludes the ray.
    pub fn record_occluded(
        &self,
        shadow: &ShadowRay,
        steps: &mut Vec<TraversalStep>,
    ) -> Option<Hit> {
        let ray = &shadow.ray;
        let any = AnyHit::new(self.primitives, shadow.t_max, shadow.ignored);
        let mut recorder = Recorder::new(any, self.primitives, steps);
        self.search(ray, &mut recorder, &mut NoProbe);
        recorder.into_parts().1
    }

    /// The nodes and leaves of the hierarchy, parents before their children.
    pub fn nodes(&self) -> Vec<BvhNode> {
        self.index
            .bvh
            .as_ref()
            .map(|bvh| nodes::list(bvh.arena()))
            .unwrap_or_default()
    }

    /// [`nearest`](Self::nearest) of many rays at once. Overwrites `hits` with one
    /// entry per ray, and reports the counters of each ray to the probe by its
    /// index, in any order.
    pub fn nearest_stream<P: StreamProbe>(
        &self,
        rays: &RayStream,
        hits: &mut Vec<Option<Hit>>,
        probe: &mut P,
    ) {
        self.stream(rays, hits, probe);
    }

    /// [`occluded`](Self::occluded) of many rays at once, in the manner of
    /// [`nearest_stream`](Self::nearest_stream).
    pub fn occluded_stream<P: StreamProbe>(
        &self,
        rays: &ShadowStream,
        occluded: &mut Vec<bool>,
        probe: &mut P,
    ) {
        self.stream(rays, occluded, probe);
    }

    /// Answers all queries: coherent rays in packets, the others as a stream.
    fn stream<Q: Queries, P: StreamProbe>(
        &self,
        queries: &Q,
        answers: &mut Vec<Q::Answer>,
        probe: &mut P,
    ) {
        answers.clear();
        answers.resize_with(queries.rays().len(), Q::Answer::default);
        let empty = Arena::default();
        let mut batch = Batch {
            arena: self.index.bvh.as_ref().map_or(&empty, Bvh::arena),
            primitives: self.primitives,
            unbounded: &self.index.unbounded,
            queries,
            answers,
            probe,
        };
        if queries.rays().is_empty() {
            return;
        }
        let incoherent = self.simd.run(PacketTraversal(batch.reborrow()));
        if !incoherent.is_empty() {
            self.simd.run(StreamTraversal {
                batch,
                indices: &incoherent,
            });
        }
    }

    /// Tests the search against all primitives that the ray may hit; reports the
    /// counters to the probe.
    fn search<S: Search, P: Probe>(&self, ray: &Ray, search: &mut S, probe: &mut P) {
        self.index.unbounded.test(ray, search);
        let n_tests = self.index.unbounded.len() as u32;
        match &self.index.bvh {
            Some(bvh) if !search.is_done() => bvh.traverse(self.simd, ray, search, probe, n_tests),
            _ => probe.traversal(0, n_tests),
        }
    }
}
