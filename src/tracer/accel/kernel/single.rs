//! Traversal of the hierarchy by one ray.
#![expect(unsafe_code, reason = "the arena was checked once, for all rays")]

use super::children::push_entered;
use super::leaf::LeafIntersector;
use super::slab::Slabs;
use super::stack::{Stacks, Top};
use crate::accel::arena::Arena;
use crate::accel::layout::{NodeRef, WideNode};
use crate::accel::search::{BoxTests, Search};
use crate::cost::Probe;
use math::simd::{Arithmetic, InstructionSet, Mask, N_LANES, SimdKernel};
use world::geometry::Ray;

/// Traversal of an arena, which is not empty, by one ray.
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
        // Prepare the ray: slabs for boxes, shear for triangles.
        let slabs = Slabs::new(self.ray, self.arena.largest());
        let intersector = LeafIntersector::new(self.ray);
        let mut stacks = Stacks::<1>::new(self.arena);
        // Start at the root with an empty stack.
        let mut top = stacks.restart(0);
        let (mut n_visits, mut n_tests) = (0, self.n_tests);
        let mut limit = set.splat(self.search.limit());
        let mut current = NodeRef::ROOT;
        loop {
            let next = if current.is_leaf() {
                // At a leaf: test its primitives; an occlusion search may end here.
                n_tests += current.leaf_size() as u32;
                // SAFETY: the reference is a child of a node, and refers to a leaf.
                let leaf = unsafe { self.arena.leaf(current) };
                if S::RECORDS {
                    let n = if leaf.kind().is_tested_at_once() {
                        leaf.len()
                    } else {
                        0
                    };
                    let lanes = 0..n;
                    let primitive = |lane| leaf.primitive(leaf.kind().n_rows(), lane);
                    self.search.visit_leaf(current.line(), lanes.map(primitive));
                }
                intersector.test(set, leaf, self.search);
                if self.search.is_done() {
                    break;
                }
                // Hits only shorten the ray: later boxes must start before them.
                limit = set.splat(self.search.limit());
                None
            } else {
                // At an inner node: test all children at once, push the far ones, go to the
                // nearest.
                n_visits += 1;
                // SAFETY: the reference is the root or a child of a node, and refers to a node.
                let node = unsafe { self.arena.node(current) };
                if S::RECORDS {
                    let boxes = test_boxes(set, &slabs, node, limit);
                    self.search.visit_node(current.line(), boxes);
                }
                // SAFETY: the node belongs to the arena.
                unsafe { descend::<I, S>(set, &slabs, node, limit, &mut stacks, &mut top) }
            };
            // If no child is hit: pop, skipping children past the closest hit.
            current = match next.or_else(|| pop_within_limit(&mut stacks, &mut top, self.search)) {
                Some(next) => next,
                None => break,
            };
        }
        self.probe.traversal(n_visits, n_tests);
    }
}

/// Counts the tests of the boxes of a node's children, for a search that records.
#[inline(always)]
fn test_boxes<I: InstructionSet>(
    set: I,
    slabs: &Slabs,
    node: &WideNode,
    limit: I::Lanes,
) -> BoxTests {
    let (enter, exit) = slabs.span(set, node, limit);
    BoxTests {
        n: node.n_children() as u8,
        n_hits: enter.lt(exit).bits().count_ones() as u8,
    }
}

/// Returns the nearest child that the ray enters, or `None`, and pushes the others.
///
/// # Safety
/// `node` belongs to an arena; it is the root or was popped off this stack.
#[inline(always)]
unsafe fn descend<I: InstructionSet, S: Search>(
    set: I,
    slabs: &Slabs,
    node: &WideNode,
    limit: I::Lanes,
    stacks: &mut Stacks<1>,
    top: &mut Top,
) -> Option<NodeRef> {
    // Intersect the ray with the eight boxes.
    let (enter, exit) = slabs.span(set, node, limit);
    let entered = enter.lt(exit).bits();
    // No child is hit.
    if entered == 0 {
        return None;
    }
    let order_shift = slabs.order_shift();
    let by_distance = |i: usize| (node.order[i] >> order_shift) as usize;
    let first = if !S::NEAREST_FIRST {
        last_entered(node, entered, |i| i)
    } else if entered.is_power_of_two() {
        return Some(last_entered(node, entered, |i| i));
    } else {
        last_entered(node, entered, by_distance)
    };
    // Push all children in order, and drop the one to visit.
    // SAFETY: the caller's promise; a child was pushed.
    unsafe {
        push_entered::<I, S, 1>(set, node, enter, exit, order_shift, stacks, top);
        stacks.pop(top);
    }
    Some(first)
}

/// Returns the last child that is entered; there is one. `lane` takes the number of a child in the
/// order of visits, the first visited last, to its lane.
///
/// A branch for each child in place of a bit scan: the CPU predicts them, and loads the next node
/// while it still tests the boxes of this one (after pull requests 287 and 288 of tinybvh).
#[inline(always)]
fn last_entered(node: &WideNode, entered: u8, lane: impl Fn(usize) -> usize) -> NodeRef {
    let mut last = 0;
    for i in (0..N_LANES).rev() {
        last = lane(i) % N_LANES;
        if entered >> last & 1 != 0 {
            break;
        }
    }
    NodeRef(node.children[last])
}

/// Pops the next child that the ray enters before the limit, or `None` if the stack is empty.
#[inline(always)]
fn pop_within_limit<S: Search>(
    stacks: &mut Stacks<1>,
    top: &mut Top,
    search: &S,
) -> Option<NodeRef> {
    loop {
        // SAFETY: the sentinel is popped last; a search for the nearest hit pushes parameters.
        let (node_ref, is_late) = unsafe {
            let node_ref = stacks.pop(top);
            let is_late = S::NEAREST_FIRST && stacks.popped_enter(top) >= search.limit();
            (node_ref, is_late)
        };
        if !is_late {
            return (node_ref != NodeRef::END).then_some(node_ref);
        }
    }
}
