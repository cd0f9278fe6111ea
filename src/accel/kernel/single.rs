//! The traversal of the hierarchy by one ray.
#![expect(unsafe_code, reason = "the arena was checked once, for all rays")]

use super::children::push_entered;
use super::leaf::LeafIntersector;
use super::slab::Slabs;
use super::stack::Stack;
use crate::accel::arena::Arena;
use crate::accel::layout::{NodeRef, WideNode};
use crate::accel::search::Search;
use crate::cost::Probe;
use crate::geometry::Ray;
use crate::simd::{InstructionSet, Mask, N_LANES, Real, SimdKernel};

/// One ray's traversal of an arena, which is not empty.
pub(in crate::accel) struct SingleTraversal<'a, S, P> {
    pub(in crate::accel) arena: &'a Arena,
    pub(in crate::accel) ray: &'a Ray,
    /// Tests the primitives that the ray may hit.
    pub(in crate::accel) search: &'a mut S,
    /// Receives the numbers of node visits and primitive tests.
    pub(in crate::accel) probe: &'a mut P,
    /// Number of tests that the ray has had before.
    pub(in crate::accel) n_tests: u32,
}

impl<S: Search, P: Probe> SimdKernel for SingleTraversal<'_, S, P> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) {
        let slabs = Slabs::new(set, self.ray, self.arena.largest());
        let intersector = LeafIntersector::new(set, self.ray);
        let mut stack = Stack::new();
        let (mut n_visits, mut n_tests) = (0, self.n_tests);
        let mut limit = set.splat(self.search.limit());
        let mut current = NodeRef::ROOT;
        loop {
            let next = if current.is_leaf() {
                n_tests += current.leaf_size() as u32;
                // SAFETY: the reference is a child of a node, and to a leaf.
                let leaf = unsafe { self.arena.leaf(current) };
                if S::RECORDS {
                    let rows = current.leaf_kind().n_rows();
                    let lanes = 0..rows.map_or(0, |_| leaf.len());
                    let primitive = |lane| leaf.primitive(rows.unwrap_or(0), lane);
                    self.search.visit_leaf(current.line(), lanes.map(primitive));
                }
                intersector.test(leaf, current.leaf_kind(), self.search);
                if self.search.is_done() {
                    break;
                }
                limit = set.splat(self.search.limit());
                None
            } else {
                n_visits += 1;
                // SAFETY: the reference is the root or a child of a node, and to
                // a node.
                let node = unsafe { self.arena.node(current) };
                let next = descend::<I, S>(set, &slabs, node, limit, &mut stack);
                if S::RECORDS {
                    self.search.visit_node(current.line(), next.is_some());
                }
                next
            };
            current = match next.or_else(|| pop_within_limit(&mut stack, self.search)) {
                Some(next) => next,
                None => break,
            };
        }
        self.probe.traversal(n_visits, n_tests);
    }
}

/// Returns the first of the children that the ray enters, if there is one, and
/// pushes the others.
#[inline(always)]
fn descend<I: InstructionSet, S: Search>(
    set: I,
    slabs: &Slabs<I>,
    node: &WideNode,
    limit: I::Lanes,
    stack: &mut Stack,
) -> Option<NodeRef> {
    let (enter, exit) = slabs.span(set, node, limit);
    let entered = enter.le(exit).bits();
    if entered == 0 {
        return None;
    }
    if entered & (entered - 1) == 0 {
        let only = entered.trailing_zeros() as usize % N_LANES;
        return Some(NodeRef(node.children[only]));
    }
    push_entered::<I, S>(set, node, enter, exit, slabs.order_shift(), stack);
    Some(stack.pop()?.0)
}

/// Pops the next child that the ray enters before the limit.
#[inline(always)]
fn pop_within_limit<S: Search>(stack: &mut Stack, search: &S) -> Option<NodeRef> {
    loop {
        let (node_ref, enter) = stack.pop()?;
        if !S::NEAREST_FIRST || enter <= search.limit() {
            return Some(node_ref);
        }
    }
}
