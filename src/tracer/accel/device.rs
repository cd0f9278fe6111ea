//! Streams of rays that a device traces, and the structure in its memory.

use std::fmt;

use super::Accel;
use super::hit::{Hit, ShadowStream};
use super::level::SearchLevel;
use crate::cost::{DeviceLaunch, FollowedPath};
use math::sampling::Sampler;
use world::camera::RayCone;
use world::geometry::RayStream;
use world::scene::World;

/// Traces streams of rays elsewhere, with the hits and the counters of the traversals of this crate.
pub trait RayDevice: fmt::Debug + Sync {
    /// Finds the nearest hits of many rays, as [`Accel::nearest_stream`] does. Overwrites `hits`
    /// with one entry per ray, and reports each ray's counters.
    fn nearest(
        &self,
        rays: &RayStream,
        hits: &mut Vec<Option<Hit>>,
        count: CountRay,
    ) -> DeviceLaunch;

    /// Tests if many rays are occluded, as [`Accel::occluded_stream`] does.
    fn occluded(
        &self,
        rays: &ShadowStream,
        occluded: &mut Vec<bool>,
        count: CountRay,
    ) -> DeviceLaunch;

    /// Returns true if it also follows whole paths, whose samples have the numbers of this sampler,
    /// and whose camera rays have this footprint.
    fn follows_paths(&self, _: &Sampler, _: Option<RayCone>) -> bool {
        false
    }

    /// Follows paths from their camera rays to their ends, with the colors and the counters of the
    /// waves of this crate, and reports each; none if it does not [follow
    /// paths](Self::follows_paths).
    fn follow(&self, _: &PathStream, _: TakePath) -> DeviceLaunch {
        DeviceLaunch::default()
    }
}

/// Paths that start with camera rays.
#[derive(Debug, Clone, Copy)]
pub struct PathStream<'a> {
    /// The camera rays.
    pub rays: &'a RayStream,
    /// The number of the pixel and of the sample of each; empty in a scene that needs no random
    /// numbers.
    pub samples: &'a [[u32; 2]],
    /// The media in which each starts, in the order in which they were entered: their materials
    /// plus 1, then 0 for empty places; empty in a scene without.
    pub media: &'a [[u32; 4]],
}

/// Receives the number of a path in its stream, the path, and the hit of its camera ray.
pub type TakePath<'a> = &'a mut dyn FnMut(usize, &FollowedPath, Option<Hit>);

/// Receives the number of a ray in its stream, its node visits and its primitive tests.
pub type CountRay<'a> = &'a mut dyn FnMut(usize, u32, u32);

/// One level of an acceleration structure, as arrays.
#[derive(Debug)]
pub struct LevelArrays<'a> {
    /// The nodes and leaves of the hierarchy, 16 numbers a cache line; empty without bounded
    /// primitives.
    pub lines: &'a [f32],
    /// Largest magnitude of a coordinate of the boxes.
    pub largest: f32,
    /// Number of levels of nodes.
    pub n_levels: usize,
    /// Indices of the primitives of this level that are tested before, in order.
    pub unbounded: Vec<u32>,
}

impl<'a> Accel<'a> {
    /// Returns the same structure, whose streams of rays the device traces.
    pub fn with_device(self, device: Option<&'a dyn RayDevice>) -> Self {
        Self { device, ..self }
    }

    /// Returns the device that traces its streams of rays, if there is one.
    pub fn device(&self) -> Option<&'a dyn RayDevice> {
        self.device
    }

    /// Returns the world.
    pub fn world(&self) -> World<'a> {
        self.world
    }

    /// Returns the arrays of the upper level, and of the instanced meshes.
    pub fn levels(&self) -> Vec<LevelArrays<'_>> {
        let lower = self.index.lower.iter().map(AsRef::as_ref);
        let all = std::iter::once(&self.index.upper).chain(lower);
        all.map(SearchLevel::arrays).collect()
    }
}

impl SearchLevel {
    /// Returns the level as arrays.
    fn arrays(&self) -> LevelArrays<'_> {
        let arena = self.bvh.as_ref().map(super::Bvh::arena);
        LevelArrays {
            lines: arena.map_or(&[], |arena| bytemuck::cast_slice(arena.lines())),
            largest: arena.map_or(0.0, |arena| arena.largest()),
            n_levels: arena.map_or(0, |arena| arena.n_levels()),
            unbounded: self.unbounded.indices().collect(),
        }
    }
}
