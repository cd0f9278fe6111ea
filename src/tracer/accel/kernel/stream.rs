//! Traversal of the hierarchy by many rays in flight.
//!
//! [`RAYS_IN_FLIGHT`] rays take turns. In each round new rays replace the finished ones; then every
//! ray at a node makes one step and prefetches its next node one round ahead; then every ray at a
//! leaf is tested. So the work on the other rays hides one ray's cache misses and dependency
//! chains. The only branch that depends on a ray is the one on a hit: a mispredicted one costs as
//! much as a node.
#![expect(unsafe_code, reason = "the arena was checked once, for all rays")]

use std::mem::MaybeUninit;

use arrayvec::ArrayVec;
use bytemuck::Zeroable;

use super::batch::Batch;
use super::block::RayBlock;
use super::children::push_entered;
use super::leaf::LeafIntersector;
use super::slab::Slabs;
use super::stack::{Stacks, Top};
use crate::accel::arena::Arena;
use crate::accel::layout::NodeRef;
use crate::accel::search::{Queries, Search};
use crate::cost::StreamProbe;
use math::simd::{InstructionSet, N_LANES, SimdKernel};

/// Number of rays in flight: enough to hide the latency of memory, few enough for their state to
/// stay in the L1 cache.
pub const RAYS_IN_FLIGHT: usize = 32;

/// The queries of a batch with these indices, each traversed as a separate ray.
pub(in crate::accel) struct StreamTraversal<'a, Q: Queries, P> {
    pub(in crate::accel) batch: Batch<'a, Q, P>,
    pub(in crate::accel) indices: &'a [u32],
}

/// The state of a ray in flight.
struct RayState<S> {
    slabs: Slabs,
    intersector: LeafIntersector,
    search: S,
    /// The node or leaf to visit next.
    next: NodeRef,
    n_visits: u32,
    n_tests: u32,
    /// Index of the query.
    index: u32,
    top: Top,
}

impl<Q: Queries, P: StreamProbe> SimdKernel for StreamTraversal<'_, Q, P> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(mut self, set: I) {
        let mut rays = [const { MaybeUninit::uninit() }; RAYS_IN_FLIGHT];
        let (mut at_nodes, mut at_leaves) = (RaySet::EMPTY, RaySet::EMPTY);
        let (mut finished, mut idle) = (RaySet::EMPTY, RaySet::ALL);
        let (mut block, mut n_launched) = (RayBlock::zeroed(), 0);
        let mut searches = ArrayVec::new();
        let mut stacks = Stacks::<RAYS_IN_FLIGHT>::new(self.batch.arena);
        while !(idle.is_empty() && at_nodes.is_empty() && at_leaves.is_empty()) {
            // Launch new rays in the idle slots.
            while let Some(i) = idle.take() {
                let top = stacks.restart(i);
                let ray = &mut rays[i];
                let is_launched =
                    self.launch(set, &mut block, &mut searches, &mut n_launched, top, ray);
                at_nodes.insert_if(i, is_launched);
            }
            // Rays at nodes: test the children, go to the nearest.
            let (mut nodes, mut leaves) = (at_nodes, at_leaves);
            at_leaves = RaySet::EMPTY;
            while let Some(i) = nodes.take() {
                // SAFETY: rays in a set are launched.
                let ray = unsafe { rays[i].assume_init_mut() };
                ray.descend::<I, P>(set, self.batch.arena, &mut stacks);
                at_leaves.insert_if(i, ray.next.is_leaf());
                finished.insert_if(i, ray.next == NodeRef::END);
            }
            at_nodes.remove(at_leaves);
            at_leaves.remove(finished);
            // Rays at leaves: test the primitives, pop the next node or leaf.
            while let Some(i) = leaves.take() {
                // SAFETY: rays in a set are launched.
                let ray = unsafe { rays[i].assume_init_mut() };
                ray.test::<I, P>(set, self.batch.arena, &mut stacks, i);
                at_leaves.insert_if(i, ray.next.is_leaf());
                at_nodes.insert_if(i, !ray.next.is_leaf());
                finished.insert_if(i, ray.next == NodeRef::END);
            }
            at_leaves.remove(finished);
            // Answer the queries of the finished rays; their slots are idle again.
            idle = finished;
            while let Some(i) = finished.take() {
                // SAFETY: rays in a set are launched.
                let ray = unsafe { rays[i].assume_init_ref() };
                let index = ray.index as usize;
                self.batch
                    .answer(index, &ray.search, ray.n_visits, ray.n_tests);
            }
        }
    }
}

impl<'a, Q: Queries, P: StreamProbe> StreamTraversal<'a, Q, P> {
    /// Starts the searches of a block of rays, testing planes.
    #[inline(always)]
    fn begin<I: InstructionSet>(
        &self,
        set: I,
        block: &RayBlock,
        indices: &[u32],
        searches: &mut ArrayVec<Q::Search<'a>, N_LANES>,
    ) {
        // Start one search per ray.
        let mut limits = [0.0; N_LANES];
        searches.clear();
        for (&index, limit) in indices.iter().zip(&mut limits) {
            let search = self
                .batch
                .queries
                .search(index as usize, self.batch.primitives);
            *limit = search.limit();
            searches.push(search);
        }
        // Test the planes, with rays in the lanes.
        let [origin, direction] = block.rays(set);
        let limits = set.load(&limits);
        let found = |lane: usize, t: f32, primitive: u32| {
            let search: &mut Q::Search<'a> = &mut searches[lane];
            if t < search.limit() {
                search.found(t, primitive);
            }
        };
        let unbounded = self.batch.unbounded;
        unbounded.test_planes(set, origin, direction, limits, found);
    }

    /// Launches the next ray that has to traverse the hierarchy, answering the queries before it
    /// that need no traversal. Returns `false` if no ray is left.
    #[inline(always)]
    fn launch<I: InstructionSet>(
        &mut self,
        set: I,
        block: &mut RayBlock,
        searches: &mut ArrayVec<Q::Search<'a>, N_LANES>,
        n_launched: &mut usize,
        top: Top,
        ray: &mut MaybeUninit<RayState<Q::Search<'a>>>,
    ) -> bool {
        let Batch {
            arena,
            unbounded,
            queries,
            ..
        } = self.batch;
        let n_tests = unbounded.len() as u32;
        while let Some(&index) = self.indices.get(*n_launched) {
            // Prepare the next eight rays at once.
            let lane = *n_launched % N_LANES;
            if lane == 0 {
                let indices = &self.indices[*n_launched..];
                block.prepare(set, queries.rays(), indices, arena.largest());
                self.begin(set, block, &indices[..N_LANES.min(indices.len())], searches);
            }
            *n_launched += 1;
            // Test the other unbounded primitives; they may answer the query.
            let mut search = searches[lane];
            if !unbounded.are_planes() {
                unbounded.test_others(&queries.rays().get(index as usize), &mut search);
            }
            if arena.is_empty() || search.is_done() {
                self.batch.answer(index as usize, &search, 0, n_tests);
                continue;
            }
            let state = ray.as_mut_ptr();
            // Start at the root.
            // SAFETY: all fields are written. Written one by one, they are not copied.
            unsafe {
                (&raw mut (*state).slabs).write(block.slabs(lane));
                (&raw mut (*state).intersector).write(block.intersector(lane));
                (&raw mut (*state).search).write(search);
                (&raw mut (*state).next).write(NodeRef::ROOT);
                (&raw mut (*state).n_visits).write(0);
                (&raw mut (*state).n_tests).write(n_tests);
                (&raw mut (*state).index).write(index);
                (&raw mut (*state).top).write(top);
            }
            return true;
        }
        false
    }
}

impl<S: Search> RayState<S> {
    /// Visits the current node and proceeds to the next node or leaf.
    #[inline(always)]
    fn descend<I: InstructionSet, P: StreamProbe>(
        &mut self,
        set: I,
        arena: &Arena,
        stacks: &mut Stacks<RAYS_IN_FLIGHT>,
    ) {
        if P::COUNTS {
            self.n_visits += 1;
        }
        let Self { slabs, top, .. } = self;
        // Test all children at once, push those that are entered, pop the nearest; the sentinel if
        // none is left.
        // SAFETY: the reference is the root or was popped off the stack, and refers to a node.
        unsafe {
            let node = arena.node(self.next);
            let limit = set.splat(self.search.limit());
            let (enter, exit) = slabs.span(set, node, limit);
            push_entered::<I, S, _>(set, node, enter, exit, slabs.order_shift(), stacks, top);
            self.next = stacks.pop(top);
        }
        self.prefetch(set, arena);
    }

    /// Tests the current leaf and proceeds to the next node or leaf.
    #[inline(always)]
    fn test<I: InstructionSet, P: StreamProbe>(
        &mut self,
        set: I,
        arena: &Arena,
        stacks: &mut Stacks<RAYS_IN_FLIGHT>,
        i: usize,
    ) {
        if P::COUNTS {
            self.n_tests += self.next.leaf_size() as u32;
        }
        // Test the primitives of the leaf.
        let limit = self.search.limit();
        // SAFETY: the reference is a child of a node, and refers to a leaf.
        let leaf = unsafe { arena.leaf(self.next) };
        self.intersector.test(set, leaf, &mut self.search);
        if S::NEAREST_FIRST && self.search.limit() < limit {
            // Drop the children past the new hit.
            // SAFETY: this is the ray's stack.
            unsafe { stacks.keep_before(set, i, &mut self.top, self.search.limit()) };
        }
        // Pop the next node or leaf; an occlusion search may end here.
        // SAFETY: the ray has not popped the sentinel yet.
        self.next = unsafe { stacks.pop(&mut self.top) };
        if self.search.is_done() {
            self.next = NodeRef::END;
        }
        self.prefetch(set, arena);
    }

    /// Prefetches the next node or leaf for the next round.
    #[inline(always)]
    fn prefetch<I: InstructionSet>(&self, set: I, arena: &Arena) {
        let line = arena.address(self.next);
        set.prefetch(line);
        set.prefetch(line.wrapping_add(1));
        set.prefetch(line.wrapping_add(2));
        set.prefetch(line.wrapping_add(3));
    }
}

/// A set of rays in flight.
#[derive(Clone, Copy)]
struct RaySet(u32);

impl RaySet {
    const EMPTY: Self = Self(0);
    const ALL: Self = Self(u32::MAX >> (32 - RAYS_IN_FLIGHT));

    #[inline(always)]
    fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Inserts a ray if `condition` holds, without a branch on it.
    #[inline(always)]
    fn insert_if(&mut self, ray: usize, condition: bool) {
        self.0 |= u32::from(condition) << ray;
    }

    /// Removes the rays of another set.
    #[inline(always)]
    fn remove(&mut self, others: Self) {
        self.0 &= !others.0;
    }

    /// Removes a ray and returns it.
    #[inline(always)]
    fn take(&mut self) -> Option<usize> {
        let ray = self.0.trailing_zeros() as usize % RAYS_IN_FLIGHT;
        let is_some = self.0 != 0;
        self.0 &= self.0.wrapping_sub(1);
        is_some.then_some(ray)
    }
}
