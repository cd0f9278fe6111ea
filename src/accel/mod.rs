//! Primitives → the nearest hit, or whether there is one.
//!
//! Two structures with the same answers: [`Bvh`], and the brute force that
//! tests everything and so is the truth that the other is held to. Planes have
//! no bounds and stay outside the hierarchy. Of two hits at the same distance
//! the primitive with the lower number counts.
//!
//! The hierarchy is built (`build`) into an arena of cache lines (`layout`)
//! that rays go through (`kernel`) with eight lanes (`simd`) for what they
//! look for (`search`).

mod simd;
mod layout;
mod arena;
mod search;
mod watch;
mod build;
mod kernel;
mod statistics;
mod nodes;
mod bvh;

use crate::config::Acceleration;
use crate::cost::{NoProbe, Probe, StreamProbe};
use crate::geometry::Ray;
use crate::scene::{ObjectId, Primitive};

use arena::Arena;
pub use build::TooLarge;
pub use bvh::Bvh;
pub use kernel::RAYS_IN_FLIGHT;
use kernel::{Batch, Packets, Stream};
pub use nodes::BvhNode;
use search::{Any, Nearest, Query, Search};
pub use simd::Simd;
pub use statistics::BvhStatistics;
pub use watch::Step;
use watch::Watched;

/// A ray's hit on a primitive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Parameter along the ray, greater than 0.
    pub t: f32,
    /// The primitive's index in the scene.
    pub primitive: u32,
}

/// A ray that asks whether anything is in its way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadowRay {
    /// The ray, whose direction is a unit vector.
    pub ray: Ray,
    /// Only hits with `t` in (0, `t_max`) count.
    pub t_max: f32,
    /// An object whose hits do not count.
    pub ignored: Option<ObjectId>,
}

/// The structure that finds hits.
#[derive(Debug, Clone, PartialEq)]
pub struct Accel<'a> {
    primitives: &'a [Primitive],
    /// Primitives to test against every ray: the planes, or all.
    always: Vec<u32>,
    bvh: Option<Bvh>,
    simd: Simd,
}

impl<'a> Accel<'a> {
    /// The structure of this kind over the primitives, at most
    /// [`Bvh::MAX_PRIMITIVES`], for the best of the machine's instruction sets.
    ///
    /// # Panics
    /// If the hierarchy is too large, which [`build`](Self::build) tells.
    pub fn new(primitives: &'a [Primitive], kind: Acceleration) -> Self {
        let built = Self::build(primitives, kind, |_| {});
        built.unwrap_or_else(|too_large| panic!("{too_large}"))
    }

    /// Builds the structure, as [`new`](Self::new) does. `report` hears of the
    /// parts that are done, which add up to 1 at most, from any thread.
    ///
    /// # Errors
    /// If the hierarchy is larger than 8 GiB, which takes 100 million
    /// primitives or more.
    pub fn build(
        primitives: &'a [Primitive],
        kind: Acceleration,
        report: impl Fn(f64) + Sync,
    ) -> Result<Self, TooLarge> {
        let all = 0..primitives.len() as u32;
        let (always, bvh) = match kind {
            Acceleration::BruteForce => (all.collect(), None),
            Acceleration::Bvh(quality) => {
                let (planes, bounded): (Vec<u32>, Vec<u32>) =
                    all.partition(|&i| primitives[i as usize].is_unbounded());
                let bvh = Bvh::new(primitives, bounded, quality, report)?;
                (planes, Some(bvh))
            }
        };
        Ok(Self {
            primitives,
            always,
            bvh,
            simd: Simd::best(),
        })
    }

    /// The same structure, searched with other instructions: same hits, same
    /// counters.
    pub fn with_simd(self, simd: Simd) -> Self {
        Self { simd, ..self }
    }

    /// The hierarchy's size; `None` for brute force.
    pub fn statistics(&self) -> Option<BvhStatistics> {
        self.bvh.as_ref().map(Bvh::statistics)
    }

    /// The nearest hit with `t > 0` of the ray, whose direction is a unit
    /// vector.
    pub fn nearest<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        let mut nearest = Nearest::new(self.primitives, ray);
        self.search(ray, &mut nearest, probe);
        nearest.hit()
    }

    /// Whether anything is hit with `t` in (0, `t_max`) that does not belong
    /// to `ignored`, by the ray, whose direction is a unit vector.
    ///
    /// Brute force tests all primitives even after a hit: its count of tests
    /// is rays times primitives.
    pub fn occluded<P: Probe>(
        &self,
        ray: &Ray,
        t_max: f32,
        ignored: Option<ObjectId>,
        probe: &mut P,
    ) -> bool {
        let mut any = Any::new(self.primitives, ray, t_max, ignored);
        self.search(ray, &mut any, probe);
        any.found
    }

    /// [`nearest`](Self::nearest), with every step of the ray added to `steps`.
    pub fn watch_nearest(&self, ray: &Ray, steps: &mut Vec<Step>) -> Option<Hit> {
        let nearest = Nearest::new(self.primitives, ray);
        let mut watched = Watched::new(nearest, self.primitives, ray, steps);
        self.search(ray, &mut watched, &mut NoProbe);
        watched.into_found().0.hit()
    }

    /// [`occluded`](Self::occluded), with every step of the ray added to
    /// `steps`; gives the hit that is in the way.
    pub fn watch_occluded(&self, shadow: &ShadowRay, steps: &mut Vec<Step>) -> Option<Hit> {
        let ray = &shadow.ray;
        let any = Any::new(self.primitives, ray, shadow.t_max, shadow.ignored);
        let mut watched = Watched::new(any, self.primitives, ray, steps);
        self.search(ray, &mut watched, &mut NoProbe);
        watched.into_found().1
    }

    /// The nodes and leaves of the hierarchy, each before those below it.
    pub fn nodes(&self) -> Vec<BvhNode> {
        self.bvh
            .as_ref()
            .map(|bvh| nodes::of(bvh.arena()))
            .unwrap_or_default()
    }

    /// [`nearest`](Self::nearest) of many rays at once: `hits` becomes one entry
    /// for each ray, and the probe hears of each ray by its index, in any
    /// order.
    pub fn nearest_stream<P: StreamProbe>(
        &self,
        rays: &[Ray],
        hits: &mut Vec<Option<Hit>>,
        probe: &mut P,
    ) {
        self.stream(rays, hits, probe);
    }

    /// [`occluded`](Self::occluded) of many rays at once, as
    /// [`nearest_stream`](Self::nearest_stream) does it.
    pub fn occluded_stream<P: StreamProbe>(
        &self,
        rays: &[ShadowRay],
        occluded: &mut Vec<bool>,
        probe: &mut P,
    ) {
        self.stream(rays, occluded, probe);
    }

    /// Answers all queries.
    fn stream<Q: Query, P: StreamProbe>(
        &self,
        queries: &[Q],
        answers: &mut Vec<Q::Answer>,
        probe: &mut P,
    ) {
        answers.clear();
        answers.resize_with(queries.len(), Q::Answer::default);
        let nothing = Arena::default();
        let mut batch = Batch {
            arena: self.bvh.as_ref().map_or(&nothing, Bvh::arena),
            primitives: self.primitives,
            always: &self.always,
            queries,
            answers,
            probe,
        };
        if queries.is_empty() {
            return;
        }
        let others = self.simd.run(Packets(batch.reborrow()));
        if !others.is_empty() {
            self.simd.run(Stream {
                batch,
                numbers: &others,
            });
        }
    }

    /// Shows what the ray may hit to the search, and tells the probe.
    fn search<S: Search, P: Probe>(&self, ray: &Ray, search: &mut S, probe: &mut P) {
        self.always
            .iter()
            .for_each(|&primitive| search.test(primitive));
        let n_tests = self.always.len() as u32;
        match &self.bvh {
            Some(bvh) if !search.is_done() => bvh.traverse(self.simd, ray, search, probe, n_tests),
            _ => probe.traversal(0, n_tests),
        }
    }
}
