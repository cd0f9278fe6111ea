//! Primitives → the nearest hit of a ray, or its occlusion.
//!
//! Two structures give the same results: [`Bvh`], and brute force, which tests every primitive and
//! serves as the reference in tests. Planes have no bounds and stay outside the hierarchy. Of two
//! hits at the same distance, the hit on the primitive with the lower index counts.
//!
//! A scene with instances has two levels ([`World`]): a ray that is tested against an instance
//! traverses the structure of its mesh (`instanced`).
//!
//! `build` writes the hierarchy as cache lines (`layout`, `arena`); `kernel` traverses it, with
//! eight lanes (`simd`), for a nearest-hit or an any-hit `search`.

mod acceleration;
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
mod overlap;
mod bvh;
mod level;
mod index;
mod instanced;
mod update;
mod device;

use std::cell::RefCell;
use std::sync::Arc;

use crate::cost::{NoProbe, Probe, StreamProbe};
use math::simd::Simd;
use world::geometry::{Ray, RayStream};
use world::scene::{ObjectId, World};

pub use acceleration::{Acceleration, HierarchyUpdate, Quality, Structure, Traversal};
use arena::Arena;
pub use build::TooLarge;
pub use bvh::Bvh;
pub use device::{CountRay, LevelArrays, PathStream, RayDevice, TakePath};
pub use hit::{Hit, ShadowRay, ShadowStream};
pub use index::AccelIndex;
use instanced::{Instanced, LevelCounts, LowerLevels, NearestPlaced, PlacedSearch};
use kernel::{Batch, PacketTraversal, StreamTraversal};
pub use kernel::{RAYS_IN_FLIGHT, SlabSetup};
pub use layout::{CAPSULE_BIT, ID_BIT};
use level::SearchLevel;
pub use nodes::BvhNode;
use record::Recorder;
pub use record::TraversalStep;
pub use search::BoxTests;
use search::{AnyHit, NearestHit, Queries, Search};
pub use statistics::BvhStatistics;
pub use update::FrameBase;

thread_local! {
    /// The indices of a batch's incoherent rays, reused from batch to batch: threads that allocate
    /// for each wave of rays would wait for the lock of the heap.
    static INCOHERENT: RefCell<Vec<u32>> = const { RefCell::new(Vec::new()) };
}

/// An acceleration structure over everything in a scene that rays can hit.
#[derive(Debug, Clone)]
pub struct Accel<'a> {
    world: World<'a>,
    index: Arc<AccelIndex>,
    simd: Simd,
    traversal: Traversal,
    device: Option<&'a dyn RayDevice>,
}

/// Receives finished shares of a build, from any thread. Not a generic parameter: each crate that
/// builds would compile the builders again.
pub type BuildReport<'a> = &'a (dyn Fn(f64) + Sync);

impl<'a> Accel<'a> {
    /// Builds a structure of this kind over the primitives, at most [`Bvh::MAX_PRIMITIVES`], for
    /// the fastest instruction set of the CPU.
    ///
    /// # Panics
    /// If the hierarchy is too large: where [`build`](Self::build) returns an error.
    pub fn new(world: impl Into<World<'a>>, kind: Acceleration) -> Self {
        let built = Self::build(world, kind, &|_| {});
        built.unwrap_or_else(|too_large| panic!("{too_large}"))
    }

    /// Builds the structure, as [`new`](Self::new) does. Calls `report` with each finished share of
    /// the build, from any thread; the shares add up to at most 1.
    ///
    /// # Errors
    /// If the hierarchy is larger than 8 GiB, which takes at least 100 million primitives.
    pub fn build(
        world: impl Into<World<'a>>,
        kind: Acceleration,
        report: BuildReport,
    ) -> Result<Self, TooLarge> {
        Self::build_frame(world, kind, None, report)
    }

    /// Returns the structure with an index that was built over the same primitives.
    pub fn from_index(world: impl Into<World<'a>>, index: Arc<AccelIndex>) -> Self {
        Self {
            world: world.into(),
            index,
            simd: Simd::best(),
            traversal: Traversal::default(),
            device: None,
        }
    }

    /// Returns the index, from which the same structure can be made again without building.
    pub fn index(&self) -> Arc<AccelIndex> {
        Arc::clone(&self.index)
    }

    /// Returns the same structure, traversed with another instruction set: same hits, same
    /// counters.
    pub fn with_simd(self, simd: Simd) -> Self {
        Self { simd, ..self }
    }

    /// Returns the same structure, whose streams of rays are traced in this way: same hits, same
    /// counters.
    pub fn with_traversal(self, traversal: Traversal) -> Self {
        Self { traversal, ..self }
    }

    /// Returns the way in which streams of rays are traced.
    pub fn traversal(&self) -> Traversal {
        self.traversal
    }

    /// Returns the instruction set.
    pub fn simd(&self) -> Simd {
        self.simd
    }

    /// Returns the size and expected cost of the hierarchy, including the hierarchies of instanced
    /// meshes; `None` for brute force.
    pub fn statistics(&self) -> Option<BvhStatistics> {
        self.index.statistics()
    }

    /// Returns the nearest hit with `t > 0` of the ray, whose direction is a unit vector.
    pub fn nearest<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        if let Some(lower) = self.lower_levels() {
            return self.nearest_placed(lower, ray, probe);
        }
        let mut nearest = NearestHit::new(self.world.primitives);
        self.search(ray, &mut nearest, probe);
        nearest.hit()
    }

    /// Returns true if the ray, whose direction is a unit vector, hits anything with `t` in (0,
    /// `t_max`) that does not belong to `ignored`.
    ///
    /// Brute force tests all primitives even after a hit: its count of tests is the number of
    /// primitives.
    pub fn occluded<P: Probe>(
        &self,
        ray: &Ray,
        t_max: f32,
        ignored: Option<ObjectId>,
        probe: &mut P,
    ) -> bool {
        let mut any = AnyHit::new(self.world.primitives, t_max, ignored);
        match self.lower_levels() {
            None => self.search(ray, &mut any, probe),
            Some(lower) => any = self.search_both(any, lower, ray, probe),
        }
        any.found
    }

    /// Finds the [`nearest`](Self::nearest) hit and appends every step of the traversal to `steps`.
    pub fn record_nearest(&self, ray: &Ray, steps: &mut Vec<TraversalStep>) -> Option<Hit> {
        let primitives = self.world.primitives;
        if let Some(lower) = self.lower_levels() {
            let nearest = NearestPlaced::new(self.world);
            let recorder = Recorder::new(nearest, primitives, steps);
            let recorder = self.search_both(recorder, lower, ray, &mut NoProbe);
            return recorder.into_parts().0.nearest;
        }
        let nearest = NearestHit::new(primitives);
        let mut recorder = Recorder::new(nearest, primitives, steps);
        self.search(ray, &mut recorder, &mut NoProbe);
        recorder.into_parts().0.hit()
    }

    /// Tests if the ray is [`occluded`](Self::occluded), appends every step of the traversal to
    /// `steps`, and returns the hit that occludes the ray.
    pub fn record_occluded(
        &self,
        shadow: &ShadowRay,
        steps: &mut Vec<TraversalStep>,
    ) -> Option<Hit> {
        let ray = &shadow.ray;
        let any = AnyHit::new(self.world.primitives, shadow.t_max, shadow.ignored);
        let mut recorder = Recorder::new(any, self.world.primitives, steps);
        match self.lower_levels() {
            None => self.search(ray, &mut recorder, &mut NoProbe),
            Some(lower) => recorder = self.search_both(recorder, lower, ray, &mut NoProbe),
        }
        recorder.into_parts().1
    }

    /// Returns the nodes and leaves of the hierarchy, parents before their children; then, for each
    /// instanced mesh, its nodes and leaves in the space of the mesh.
    pub fn nodes(&self) -> Vec<BvhNode> {
        let list = |level: &SearchLevel| {
            let arena = level.bvh.as_ref().map(Bvh::arena);
            arena.map(nodes::list).unwrap_or_default()
        };
        let mut nodes = list(&self.index.upper);
        let lower = self.index.lower.iter().zip(&self.index.first_ids);
        for (mesh, (level, &first_id)) in (0..).zip(lower) {
            let of_mesh = list(level).into_iter();
            nodes.extend(of_mesh.map(|node| node.in_mesh(mesh, first_id)));
        }
        nodes
    }

    /// Sets the end-point overlap of the [`nodes`](Self::nodes); not in scenes with instances, whose
    /// surfaces are in many places.
    pub fn measure_overlap(&self, nodes: &mut [BvhNode]) {
        let World {
            primitives,
            instances,
        } = self.world;
        if let (None, Some(bvh)) = (instances, &self.index.upper.bvh) {
            overlap::measure(bvh.arena().lines(), primitives, nodes);
        }
    }

    /// Finds the [`nearest`](Self::nearest) hits of many rays at once. Overwrites `hits` with one
    /// entry per ray, and reports the counters of each ray to the probe by its index, in any order.
    pub fn nearest_stream<P: StreamProbe>(
        &self,
        rays: &RayStream,
        hits: &mut Vec<Option<Hit>>,
        probe: &mut P,
    ) {
        if let Some(device) = self.device {
            let launch = device.nearest(rays, hits, &mut |i, n_visits, n_tests| {
                probe.traversal(i, n_visits, n_tests);
            });
            return probe.launched(launch);
        }
        if self.is_traced_in_streams() {
            return self.stream(rays, hits, probe);
        }
        one_by_one(rays, hits, probe, |i, counts| {
            self.nearest(&rays.get(i), counts)
        });
    }

    /// Tests if many rays are [`occluded`](Self::occluded) at once, in the manner of
    /// [`nearest_stream`](Self::nearest_stream).
    pub fn occluded_stream<P: StreamProbe>(
        &self,
        rays: &ShadowStream,
        occluded: &mut Vec<bool>,
        probe: &mut P,
    ) {
        if let Some(device) = self.device {
            let launch = device.occluded(rays, occluded, &mut |i, n_visits, n_tests| {
                probe.traversal(i, n_visits, n_tests);
            });
            return probe.launched(launch);
        }
        if self.is_traced_in_streams() {
            return self.stream(rays, occluded, probe);
        }
        one_by_one(rays.rays(), occluded, probe, |i, counts| {
            let shadow = rays.get(i);
            self.occluded(&shadow.ray, shadow.t_max, shadow.ignored, counts)
        });
    }

    /// Returns true if many rays are traced at a time: not in scenes with instances.
    fn is_traced_in_streams(&self) -> bool {
        self.traversal == Traversal::Stream && self.lower_levels().is_none()
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
            arena: self.index.upper.bvh.as_ref().map_or(&empty, Bvh::arena),
            primitives: self.world.primitives,
            unbounded: &self.index.upper.unbounded,
            queries,
            answers,
            probe,
        };
        if queries.rays().is_empty() {
            return;
        }
        let mut incoherent = INCOHERENT.take();
        self.simd.run(PacketTraversal {
            batch: batch.reborrow(),
            incoherent: &mut incoherent,
        });
        if !incoherent.is_empty() {
            self.simd.run(StreamTraversal {
                batch,
                indices: &incoherent,
            });
        }
        INCOHERENT.set(incoherent);
    }

    /// Tests the search against all primitives that the ray may hit. Reports the counters to the
    /// probe.
    #[inline]
    fn search<S: Search, P: Probe>(&self, ray: &Ray, search: &mut S, probe: &mut P) {
        self.index.upper.search(self.simd, ray, search, probe);
    }

    /// Returns the lower levels of a scene with instances.
    #[inline]
    fn lower_levels(&self) -> Option<LowerLevels<'_>> {
        Some(LowerLevels {
            world: self.world,
            instances: self.world.instances?,
            levels: &self.index.lower,
            first_ids: &self.index.first_ids,
            simd: self.simd,
        })
    }

    /// Finds the [`nearest`](Self::nearest) hit in a scene with instances.
    fn nearest_placed<P: Probe>(
        &self,
        lower: LowerLevels,
        ray: &Ray,
        probe: &mut P,
    ) -> Option<Hit> {
        let nearest = NearestPlaced::new(lower.world);
        self.search_both(nearest, lower, ray, probe).nearest
    }

    /// Searches both levels; reports the counters to the probe.
    fn search_both<S: PlacedSearch, P: Probe>(
        &self,
        search: S,
        lower: LowerLevels,
        ray: &Ray,
        probe: &mut P,
    ) -> S {
        let mut both = Instanced::new(search, lower);
        let counts = both.run(&self.index.upper, ray);
        probe.traversal(counts.n_visits, counts.n_tests);
        both.search
    }
}

/// Answers queries one after the other; `answer` gets each query's index and the probe for its
/// counters.
fn one_by_one<A, P: StreamProbe>(
    rays: &RayStream,
    answers: &mut Vec<A>,
    probe: &mut P,
    answer: impl Fn(usize, &mut LevelCounts) -> A,
) {
    answers.clear();
    for i in 0..rays.len() {
        let mut counts = LevelCounts::default();
        answers.push(answer(i, &mut counts));
        probe.traversal(i, counts.n_visits, counts.n_tests);
    }
}
