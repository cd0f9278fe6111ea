//! The structure of a frame of an animation: built, or that of the first frame, refitted.

use std::sync::Arc;

use super::Accel;
use super::build::TooLarge;
use super::index::AccelIndex;
use super::level::SearchLevel;
use crate::animation::HierarchyUpdate;
use crate::config::{Acceleration, Quality};
use crate::scene::World;

/// The origin of a frame's structure.
#[derive(Debug, Clone)]
pub(crate) struct FrameBase {
    /// The structures of meshes that are placed many times.
    meshes: Vec<Arc<SearchLevel>>,
    first: Option<FirstIndex>,
}

/// The structure of the first frame, which may be refitted.
#[derive(Debug, Clone)]
struct FirstIndex {
    index: Arc<AccelIndex>,
    /// Its expected cost per ray.
    sah_cost: f64,
    update: HierarchyUpdate,
}

impl FrameBase {
    /// The structure of the first frame, from which those of others come in this way.
    pub(crate) fn of(accel: &Accel, update: HierarchyUpdate) -> Self {
        let first = FirstIndex {
            index: accel.index(),
            sah_cost: accel.index.sah_cost(accel.world),
            update,
        };
        Self {
            first: Some(first),
            ..Self::of_meshes(&accel.index)
        }
    }

    /// Only the structures of the meshes of another frame.
    pub(crate) fn of_meshes(index: &AccelIndex) -> Self {
        Self {
            meshes: index.lower.clone(),
            first: None,
        }
    }

    /// The index of the first frame; `None` if it has only the meshes of another one.
    pub(crate) fn first_index(&self) -> Option<Arc<AccelIndex>> {
        let first = self.first.as_ref();
        first.map(|first| Arc::clone(&first.index))
    }
}

impl FirstIndex {
    /// The index refitted to the primitives of a frame of `n_rays` camera rays; `None` if the
    /// frame has to build its own.
    fn refitted(&self, world: World, kind: Acceleration, n_rays: u64) -> Option<AccelIndex> {
        let refitted = self.index.refitted(world)?;
        let more_per_ray = refitted.sah_cost(world) - self.sah_cost;
        let more = n_rays as f64 * more_per_ray;
        let pays = self.update == HierarchyUpdate::Refit
            || more <= build_cost(kind) * world.primitives.len() as f64;
        pays.then_some(refitted)
    }
}

/// What it takes to build a hierarchy, per primitive: so many node visits or primitive tests of
/// a ray take as long. Measured once, since the choice between refit and build must not depend
/// on a clock.
fn build_cost(kind: Acceleration) -> f64 {
    match kind {
        Acceleration::BruteForce => 0.0,
        Acceleration::Bvh(Quality::Fast) => 20.0,
        Acceleration::Bvh(Quality::Balanced) => 30.0,
        Acceleration::Bvh(Quality::High) => 250.0,
    }
}

impl<'a> Accel<'a> {
    /// The structure of a frame of `n_rays` camera rays: refitted from that of another frame
    /// where this pays, or [built](Self::build), with the structures of its meshes that have not
    /// changed.
    ///
    /// # Errors
    /// The errors of [`build`](Self::build).
    pub(crate) fn of_frame(
        world: impl Into<World<'a>>,
        kind: Acceleration,
        base: Option<(&FrameBase, u64)>,
        report: impl Fn(f64) + Sync,
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
        Ok(Self::of_index(world, Arc::new(index)))
    }

    /// Whether it is that of another frame, refitted.
    pub(crate) fn is_refitted(&self) -> bool {
        self.index.is_refitted
    }

    /// The structure over other primitives, refitted to these; `None` if they are not as many
    /// and of the same kinds, or without a hierarchy.
    pub fn refitted<'b>(&self, world: impl Into<World<'b>>) -> Option<Accel<'b>> {
        let world = world.into();
        let index = self.index.refitted(world)?;
        let accel = Accel::of_index(world, Arc::new(index));
        Some(accel.with_simd(self.simd).with_traversal(self.traversal))
    }
}
