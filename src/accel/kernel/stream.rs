//! The traversal of the hierarchy by many rays in flight.
//!
//! [`RAYS_IN_FLIGHT`] rays take turns. In each round every ray at a node makes
//! one step, without a branch that depends on the ray, and prefetches its next
//! node one round ahead; then every ray at a leaf is tested; then new rays
//! replace the finished ones. So the work on the other rays hides one ray's
//! cache misses, dependency chains and branch mispredictions.
#![expect(unsafe_code, reason = "the arena was checked once, for all rays")]

use std::mem::MaybeUninit;

use super::batch::Batch;
use super::children::push_entered;
use super::leaf::LeafIntersector;
use super::slab::Slabs;
use super::stack::Stack;
use crate::accel::arena::Arena;
use crate::accel::layout::NodeRef;
use crate::accel::search::{Query, Search};
use crate::cost::StreamProbe;
use crate::simd::{InstructionSet, SimdKernel};

/// Number of rays in flight: enough to hide the latency of memory, few enough
/// for their state to stay in the L1 cache.
pub const RAYS_IN_FLIGHT: usize = 16;

/// The queries of a batch with these indices, each ray on its own.
pub(in crate::accel) struct StreamTraversal<'a, Q: Query, P> {
    pub(in crate::accel) batch: Batch<'a, Q, P>,
    pub(in crate::accel) indices: &'a [u32],
}

/// The state of a ray in flight.
struct RayState<I: InstructionSet, S> {
    slabs: Slabs<I>,
    intersector: LeafIntersector<I>,
    search: S,
    /// The node or leaf to visit next.
    next: NodeRef,
    n_visits: u32,
    n_tests: u32,
    /// The index of its query.
    index: usize,
    stack: Stack,
}

impl<Q: Query, P: StreamProbe> SimdKernel for StreamTraversal<'_, Q, P> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(mut self, set: I) {
        let mut rays = [const { MaybeUninit::uninit() }; RAYS_IN_FLIGHT];
        let (mut at_nodes, mut at_leaves) = (RaySet::EMPTY, RaySet::EMPTY);
        let mut n_launched = 0;
        for (i, ray) in rays.iter_mut().enumerate() {
            at_nodes.insert_if(i, self.launch(set, &mut n_launched, ray));
        }
        while !(at_nodes.is_empty() && at_leaves.is_empty()) {
            let (mut nodes, mut leaves) = (at_nodes, at_leaves);
            at_leaves = RaySet::EMPTY;
            while let Some(i) = nodes.take() {
                // SAFETY: rays in a set are launched.
                let ray = unsafe { rays[i].assume_init_mut() };
                ray.descend::<P>(set, self.batch.arena);
                at_leaves.insert_if(i, ray.next.is_leaf());
            }
            at_nodes.remove(at_leaves);
            while let Some(i) = leaves.take() {
                // SAFETY: rays in a set are launched.
                let ray = unsafe { rays[i].assume_init_mut() };
                if ray.test::<P>(set, self.batch.arena) {
                    at_leaves.insert_if(i, ray.next.is_leaf());
                    at_nodes.insert_if(i, !ray.next.is_leaf());
                } else {
                    let RayState {
                        index,
                        n_visits,
                        n_tests,
                        search,
                        ..
                    } = ray;
                    self.batch.answer(*index, search, *n_visits, *n_tests);
                    at_nodes.insert_if(i, self.launch(set, &mut n_launched, &mut rays[i]));
                }
            }
        }
    }
}

impl<'a, Q: Query, P: StreamProbe> StreamTraversal<'a, Q, P> {
    /// Launches the next ray that has to traverse the hierarchy; answers those
    /// before it that need not. Returns `false` if no ray is left.
    #[inline(always)]
    fn launch<I: InstructionSet>(
        &mut self,
        set: I,
        n_launched: &mut usize,
        ray: &mut MaybeUninit<RayState<I, Q::Search<'a>>>,
    ) -> bool {
        let Batch {
            arena,
            primitives,
            unbounded,
            queries,
            ..
        } = self.batch;
        let n_tests = unbounded.len() as u32;
        while let Some(&index) = self.indices.get(*n_launched) {
            let index = index as usize;
            *n_launched += 1;
            let query = &queries[index];
            let mut search = query.search(primitives);
            for &primitive in unbounded {
                search.test(primitive);
            }
            if arena.is_empty() || search.is_done() {
                self.batch.answer(index, &search, 0, n_tests);
                continue;
            }
            let ray = ray.write(RayState {
                slabs: Slabs::new(set, query.ray(), arena.largest()),
                intersector: LeafIntersector::new(set, query.ray()),
                search,
                next: NodeRef::ROOT,
                n_visits: 0,
                n_tests,
                index,
                stack: Stack::new(),
            });
            ray.stack.push(NodeRef::END, f32::NEG_INFINITY);
            return true;
        }
        false
    }
}

impl<I: InstructionSet, S: Search> RayState<I, S> {
    /// Visits its node and proceeds to the next node or leaf.
    #[inline(always)]
    fn descend<P: StreamProbe>(&mut self, set: I, arena: &Arena) {
        if P::COUNTS {
            self.n_visits += 1;
        }
        // SAFETY: the reference is the root or a child of a node, and to a node.
        let node = unsafe { arena.node(self.next) };
        let limit = set.splat(self.search.limit());
        let (enter, exit) = self.slabs.span(set, node, limit);
        push_entered::<I, S>(
            set,
            node,
            enter,
            exit,
            self.slabs.order_shift(),
            &mut self.stack,
        );
        self.advance(set, arena);
    }

    /// Tests its leaf and proceeds to the next node or leaf; returns `false` if
    /// the traversal is finished.
    #[inline(always)]
    fn test<P: StreamProbe>(&mut self, set: I, arena: &Arena) -> bool {
        if self.next == NodeRef::END {
            return false;
        }
        if P::COUNTS {
            self.n_tests += self.next.leaf_size() as u32;
        }
        let limit = self.search.limit();
        // SAFETY: the reference is a child of a node, and to a leaf.
        let leaf = unsafe { arena.leaf(self.next) };
        self.intersector
            .test(leaf, self.next.leaf_kind(), &mut self.search);
        if self.search.is_done() {
            return false;
        }
        if S::NEAREST_FIRST && self.search.limit() < limit {
            self.stack.keep_up_to(self.search.limit());
        }
        self.advance(set, arena);
        true
    }

    /// Pops the next node or leaf and prefetches it for the next round.
    #[inline(always)]
    fn advance(&mut self, set: I, arena: &Arena) {
        self.next = self.stack.pop_one();
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
