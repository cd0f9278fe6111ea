//! Searches through both levels of a scene with instances.
//!
//! An instance is a primitive of the upper level. Its test moves the ray into the space of the
//! mesh, where its parameter stays the same, and traverses the mesh's hierarchy with the same
//! search.
//!
//! # Why the hierarchy of the upper level hides no hit
//!
//! Rounding in the space of the mesh may move a hit out of the instance's box in world space. So a
//! hit counts only if the ray enters that box before it. The margin of its slabs is at most the
//! margin of the hierarchy's boxes around it: their arithmetic is monotonic, so a ray that enters
//! the box enters these, and not later. Brute force has the same rule.

use std::sync::Arc;

use super::hit::Hit;
use super::kernel::Slabs;
use super::level::SearchLevel;
use super::search::{AnyHit, BoxTests, Search};
use crate::cost::{Probe, RayKind};
use math::simd::Simd;
use world::geometry::Ray;
use world::scene::{InstanceId, Instances, PlacedPrimitive, World};

/// A search that distinguishes instances.
pub(super) trait PlacedSearch: Search {
    /// Reports [`Search::found`] on a primitive of an instance's mesh.
    fn found_in(&mut self, instance: InstanceId, t: f32, primitive: u32);
    /// Called before the tests of an instance, with the index of its box.
    fn enter(&mut self, _primitive: u32) {}
    /// Called after the tests of an instance.
    fn leave(&mut self) {}
}

/// The lower level of a structure.
#[derive(Clone, Copy)]
pub(super) struct LowerLevels<'a> {
    pub(super) world: World<'a>,
    pub(super) instances: &'a Instances,
    /// The structure of each mesh.
    pub(super) levels: &'a [Arc<SearchLevel>],
    /// The ID of the first node of each mesh.
    pub(super) first_ids: &'a [u32],
    pub(super) simd: Simd,
}

/// A search through both levels.
#[derive(Clone, Copy)]
pub(super) struct Instanced<'a, S> {
    pub(super) search: S,
    lower: LowerLevels<'a>,
    pub(super) counts: LevelCounts,
}

/// Numbers of node visits and primitive tests.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct LevelCounts {
    pub(super) n_visits: u32,
    pub(super) n_tests: u32,
}

impl Probe for LevelCounts {
    const COUNTS: bool = true;

    fn ray(&mut self, _: RayKind) {}

    #[inline]
    fn traversal(&mut self, node_visits: u32, primitive_tests: u32) {
        self.n_visits += node_visits;
        self.n_tests += primitive_tests;
    }

    fn bounce(&mut self, _: u32) {}
}

impl<'a, S: PlacedSearch> Instanced<'a, S> {
    /// Returns the search of a ray through the upper level and these lower levels.
    pub(super) fn new(search: S, lower: LowerLevels<'a>) -> Self {
        Self {
            search,
            lower,
            counts: LevelCounts::default(),
        }
    }

    /// Searches both levels. Returns the counters of both.
    pub(super) fn run(&mut self, upper: &SearchLevel, ray: &Ray) -> LevelCounts {
        let mut counts = LevelCounts::default();
        upper.search(self.lower.simd, ray, self, &mut counts);
        counts.traversal(self.counts.n_visits, self.counts.n_tests);
        counts
    }

    /// Tests the triangles of an instance.
    fn test_instance(&mut self, ray: &Ray, id: InstanceId) {
        let lower = self.lower;
        let instance = lower.instances.get(id);
        let mesh = instance.mesh as usize;
        let mut in_mesh = InMesh {
            outer: &mut self.search,
            lower,
            ray,
            id,
            first: lower.instances.mesh_of(id).triangles.start,
            first_id: lower.first_ids[mesh],
        };
        let mesh_ray = instance.transform.mesh_ray(ray);
        lower.levels[mesh].search(lower.simd, &mesh_ray, &mut in_mesh, &mut self.counts);
    }
}

impl<S: PlacedSearch> Search for Instanced<'_, S> {
    const NEAREST_FIRST: bool = S::NEAREST_FIRST;
    const RECORDS: bool = S::RECORDS;

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.search.limit()
    }

    #[inline(always)]
    fn is_done(&self) -> bool {
        self.search.is_done()
    }

    fn test(&mut self, ray: &Ray, primitive: u32) {
        match self.lower.instances.by_box(primitive) {
            None => self.search.test(ray, primitive),
            Some(instance) => {
                self.search.enter(primitive);
                self.test_instance(ray, instance);
                self.search.leave();
            }
        }
    }

    fn visit_node(&mut self, id: usize, boxes: BoxTests) {
        self.search.visit_node(id, boxes);
    }

    fn visit_leaf(&mut self, id: usize, primitives: impl Iterator<Item = u32>) {
        self.search.visit_leaf(id, primitives);
    }

    #[inline(always)]
    fn found(&mut self, t: f32, primitive: u32) {
        self.search.found(t, primitive);
    }
}

/// A search in the space of an instance's mesh.
struct InMesh<'s, 'a, S> {
    outer: &'s mut S,
    lower: LowerLevels<'a>,
    /// The ray in world space.
    ray: &'s Ray,
    id: InstanceId,
    /// Index of the mesh's first triangle among the primitives, and the ID of its first node.
    first: u32,
    first_id: u32,
}

impl<S> InMesh<'_, '_, S> {
    /// Returns true if the ray enters the instance's box before a hit at `t`.
    fn enters_box_before(&self, t: f32) -> bool {
        let of_box = self.lower.instances.box_of(self.id);
        let bounds = self.lower.world.primitives[of_box as usize].bounds();
        let largest = bounds.largest();
        let (enter, exit) = Slabs::new(self.ray, largest).span_of(&bounds);
        enter < exit && enter < t
    }
}

impl<S: PlacedSearch> Search for InMesh<'_, '_, S> {
    const NEAREST_FIRST: bool = S::NEAREST_FIRST;
    const RECORDS: bool = S::RECORDS;

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.outer.limit()
    }

    #[inline(always)]
    fn is_done(&self) -> bool {
        self.outer.is_done()
    }

    fn test(&mut self, ray: &Ray, primitive: u32) {
        if S::RECORDS {
            self.outer.visit_test(self.first + primitive);
        }
        let triangle = &self.lower.world.primitives[(self.first + primitive) as usize];
        if let Some(t) = triangle.intersect(ray, self.limit()) {
            self.found(t, primitive);
        }
    }

    fn visit_node(&mut self, id: usize, boxes: BoxTests) {
        self.outer.visit_node(self.first_id as usize + id, boxes);
    }

    fn visit_leaf(&mut self, id: usize, primitives: impl Iterator<Item = u32>) {
        let (first, first_id) = (self.first, self.first_id as usize);
        self.outer
            .visit_leaf(first_id + id, primitives.map(|primitive| first + primitive));
    }

    #[inline(always)]
    fn found(&mut self, t: f32, primitive: u32) {
        if self.enters_box_before(t) {
            self.outer.found_in(self.id, t, self.first + primitive);
        }
    }
}

/// The search for a ray's nearest hit in a scene with instances.
#[derive(Clone, Copy)]
pub(super) struct NearestPlaced<'a> {
    world: World<'a>,
    /// The nearest hit so far, if any.
    pub(super) nearest: Option<Hit>,
    /// The next float after the `t` of that hit: hits at equal distance count.
    limit: f32,
}

impl<'a> NearestPlaced<'a> {
    pub(super) fn new(world: World<'a>) -> Self {
        Self {
            world,
            nearest: None,
            limit: f32::INFINITY,
        }
    }

    /// Records a hit if it is nearer. Among hits at the same distance the one in world space
    /// counts, then the one with the lowest instance, then the lowest primitive index.
    fn found_at(&mut self, t: f32, at: PlacedPrimitive) {
        let order = |at: PlacedPrimitive| (at.instance, at.primitive);
        let is_nearer = self.nearest.is_none_or(|nearest| {
            t < nearest.t || t == nearest.t && order(at) < order(nearest.placed())
        });
        if is_nearer {
            self.nearest = Some(Hit {
                t,
                primitive: at.primitive,
                instance: at.instance,
            });
            // The next greater float, since `t` is finite and not negative.
            self.limit = f32::from_bits(t.to_bits() + 1);
        }
    }
}

impl Search for NearestPlaced<'_> {
    const NEAREST_FIRST: bool = true;

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }

    #[inline(always)]
    fn is_done(&self) -> bool {
        false
    }

    fn test(&mut self, ray: &Ray, primitive: u32) {
        let shape = &self.world.primitives[primitive as usize];
        if let Some(t) = shape.intersect(ray, self.limit) {
            self.found(t, primitive);
        }
    }

    fn found(&mut self, t: f32, primitive: u32) {
        self.found_at(t, primitive.into());
    }
}

impl PlacedSearch for NearestPlaced<'_> {
    fn found_in(&mut self, instance: InstanceId, t: f32, primitive: u32) {
        let instance = Some(instance);
        self.found_at(
            t,
            PlacedPrimitive {
                primitive,
                instance,
            },
        );
    }
}

impl PlacedSearch for AnyHit<'_> {
    fn found_in(&mut self, _: InstanceId, t: f32, primitive: u32) {
        // The triangles of a mesh have the object of its instances.
        self.found(t, primitive);
    }
}
