//! The structure of an animation's frame: built, or refitted from the first frame.

use std::sync::Arc;

use super::build::TooLarge;
use super::index::AccelIndex;
use super::level::SearchLevel;
use super::{Accel, BuildReport};
use super::{Acceleration, HierarchyUpdate, Quality};
use world::scene::World;

/// The origin of a frame's structure.
#[derive(Debug, Clone)]
pub struct FrameBase {
    /// The structures of instanced meshes.
    meshes: Vec<Arc<SearchLevel>>,
    first: Option<FirstIndex>,
}

/// The structure of the first frame, which may be refitted.
#[derive(Debug, Clone)]
struct FirstIndex {
    index: Arc<AccelIndex>,
    /// Expected cost per ray.
    sah_cost: f64,
    update: HierarchyUpdate,
}

impl FrameBase {
    /// Starts from the structure of the first frame; other frames are derived from it by `update`.
    pub fn new(accel: &Accel, update: HierarchyUpdate) -> Self {
        let first = FirstIndex {
            index: accel.index(),
            sah_cost: accel.index.sah_cost(accel.world),
            update,
        };
        Self {
            first: Some(first),
            ..Self::from_meshes(&accel.index)
        }
    }

    /// Starts from only the structures of the meshes of another frame.
    pub fn from_meshes(index: &AccelIndex) -> Self {
        Self {
            meshes: index.lower.clone(),
            first: None,
        }
    }

    /// Returns the index of the first frame, or `None` if only meshes are shared.
    pub fn first_index(&self) -> Option<Arc<AccelIndex>> {
        let first = self.first.as_ref();
        first.map(|first| Arc::clone(&first.index))
    }
}

impl FirstIndex {
    /// Returns the index refitted to the primitives of a frame of `n_rays` camera rays, or `None`
    /// if building a new one pays.
    fn refitted(&self, world: World, kind: Acceleration, n_rays: u64) -> Option<AccelIndex> {
        let refitted = self.index.refitted(world)?;
        let more_per_ray = refitted.sah_cost(world) - self.sah_cost;
        let more = n_rays as f64 * more_per_ray;
        let pays = self.update == HierarchyUpdate::Refit
            || more <= build_cost(kind) * world.primitives.len() as f64;
        pays.then_some(refitted)
    }
}

/// Returns the cost of building a hierarchy, per primitive, in node visits or primitive tests that
/// take the same time. Measured once, since the choice between refit and build must not depend on a
/// clock.
fn build_cost(kind: Acceleration) -> f64 {
    match kind {
        Acceleration::BruteForce => 0.0,
        Acceleration::Bvh(Quality::Fast) => 20.0,
        Acceleration::Bvh(Quality::Balanced) => 30.0,
        Acceleration::Bvh(Quality::High) => 250.0,
    }
}

impl<'a> Accel<'a> {
    /// Returns the structure of a frame of `n_rays` camera rays: refitted from another frame where
    /// this pays, otherwise [built](Self::build), reusing the structures of meshes that have not
    /// changed.
    ///
    /// # Errors
    /// The errors of [`build`](Self::build).
    pub fn build_frame(
        world: impl Into<World<'a>>,
        kind: Acceleration,
        base: Option<(&FrameBase, u64)>,
        report: BuildReport,
    ) -> Result<Self, TooLarge> {
        let world = world.into();
        let refitted = base.and_then(|(base, n_rays)| {
            let first = base.first.as_ref()?;
            first.refitted(world, kind, n_rays)
        });
        let index = match refitted {
            Some(index) => index,
            None => {
                let meshes = base.map_or(&[][..], |(base, _)| &base.meshes);
                AccelIndex::build(world, kind, meshes, report)?
            }
        };
        Ok(Self::from_index(world, Arc::new(index)))
    }

    /// Returns true if the structure was refitted from another frame.
    pub fn is_refitted(&self) -> bool {
        self.index.is_refitted
    }

    /// Returns the structure refitted to these primitives, or `None` if their number or kinds
    /// differ, or if there is no hierarchy.
    pub fn refitted<'b>(&self, world: impl Into<World<'b>>) -> Option<Accel<'b>> {
        let world = world.into();
        let index = self.index.refitted(world)?;
        let accel = Accel::from_index(world, Arc::new(index));
        Some(accel.with_simd(self.simd).with_traversal(self.traversal))
    }
}
