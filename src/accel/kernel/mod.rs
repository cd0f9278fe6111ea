//! Rays through the hierarchy, nearest children first.
//!
//! Three ways with the same visits, tests and answers: one ray at a time
//! ([`Traversal`]), whose time can be told; sixteen rays that go the same way
//! ([`Packets`]), which share the work; and many rays in flight ([`Stream`]),
//! which wait for memory and for each other's results together. Of a [`Batch`]
//! of rays packets take what they can, and the stream what is left.
//! All are generic functions, compiled once for each instruction set, search
//! and probe; no allocation, no recursion.
#![expect(unsafe_code, reason = "the arena was checked once, for all rays")]

mod block;
mod slab;
mod stack;
mod batch;
mod packet;
mod stream;

use super::arena::{Arena, Leaf};
use super::layout::{LeafKind, Node, Word};
use super::search::Search;
use super::simd::{InstructionSet, Lanes, Mask, N_LANES, Work};
use crate::cost::Probe;
use crate::geometry::Ray;
pub(super) use batch::Batch;
use block::Blocks;
pub(super) use packet::Packets;
use slab::Slabs;
use stack::Stack;
pub use stream::RAYS_IN_FLIGHT;
pub(super) use stream::Stream;

/// One ray's way through an arena, which is not empty.
pub(super) struct Traversal<'a, S, P> {
    pub(super) arena: &'a Arena,
    pub(super) ray: &'a Ray,
    /// What is shown the primitives that the ray may hit.
    pub(super) search: &'a mut S,
    /// What hears of the nodes and tests.
    pub(super) probe: &'a mut P,
    /// Tests that the ray had before.
    pub(super) n_tests: u32,
}

impl<S: Search, P: Probe> Work for Traversal<'_, S, P> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) {
        let slabs = Slabs::new(set, self.ray, self.arena.largest());
        let blocks = Blocks::new(set, self.ray);
        let mut stack = Stack::new();
        let (mut n_visits, mut n_tests) = (0, self.n_tests);
        let mut limit = set.splat(self.search.limit());
        let mut word = Word::ROOT;
        loop {
            let next = if word.is_leaf() {
                n_tests += word.leaf_size() as u32;
                // SAFETY: the word is a child of a node, and no node.
                let leaf = unsafe { self.arena.leaf(word) };
                if S::WATCHES {
                    let rows = word.leaf_kind().n_rows();
                    let lanes = 0..rows.map_or(0, |_| leaf.len());
                    let primitive = |lane| leaf.primitive(rows.unwrap_or(0), lane);
                    self.search.tested(word.line(), lanes.map(primitive));
                }
                test_leaf(&blocks, leaf, word.leaf_kind(), self.search);
                if self.search.is_done() {
                    break;
                }
                limit = set.splat(self.search.limit());
                None
            } else {
                n_visits += 1;
                // SAFETY: the word is the root or a child of a node, and no leaf.
                let node = unsafe { self.arena.node(word) };
                let next = descend::<I, S>(set, &slabs, node, limit, &mut stack);
                if S::WATCHES {
                    self.search.passed(word.line(), next.is_some());
                }
                next
            };
            word = match next.or_else(|| next_waiting(&mut stack, self.search)) {
                Some(word) => word,
                None => break,
            };
        }
        self.probe.traversal(n_visits, n_tests);
    }
}

/// Goes into the first of the children that the ray enters, if there is one,
/// and leaves the others on the stack.
#[inline(always)]
fn descend<I: InstructionSet, S: Search>(
    set: I,
    slabs: &Slabs<I>,
    node: &Node,
    limit: I::Lanes,
    stack: &mut Stack,
) -> Option<Word> {
    let (enter, exit) = slabs.span(set, node, limit);
    let entered = enter.le(exit).bits();
    if entered == 0 {
        return None;
    }
    if entered & (entered - 1) == 0 {
        let only = entered.trailing_zeros() as usize % N_LANES;
        return Some(Word(node.children[only]));
    }
    push_entered::<I, S>(set, node, enter, exit, slabs.order_shift(), stack);
    Some(stack.pop()?.0)
}

/// Puts the children that the ray enters before it leaves them on the stack,
/// the one to visit first on top. No branch depends on them.
#[inline(always)]
fn push_entered<I: InstructionSet, S: Search>(
    set: I,
    node: &Node,
    enter: I::Lanes,
    exit: I::Lanes,
    order_shift: I::Lanes,
    stack: &mut Stack,
) {
    let children = set.load_bits(&node.children);
    if S::NEAREST_FIRST {
        let children = children.permute(&node.order, order_shift);
        let enter = enter.permute(&node.order, order_shift);
        let exit = exit.permute(&node.order, order_shift);
        let entered = enter.le(exit);
        stack.push_all(
            children.compress(entered).to_bits(),
            enter.compress(entered).to_array(),
            entered.bits().count_ones() as usize,
        );
    } else {
        let entered = enter.le(exit);
        stack.push_all(
            children.compress(entered).to_bits(),
            [0.0; N_LANES],
            entered.bits().count_ones() as usize,
        );
    }
}

/// The next child that the ray may still hit something in.
#[inline(always)]
fn next_waiting<S: Search>(stack: &mut Stack, search: &S) -> Option<Word> {
    loop {
        let (word, enter) = stack.pop()?;
        if !S::NEAREST_FIRST || enter <= search.limit() {
            return Some(word);
        }
    }
}

/// Shows the search the hits in a leaf.
#[inline(always)]
fn test_leaf<I: InstructionSet, S: Search>(
    blocks: &Blocks<I>,
    leaf: Leaf,
    kind: LeafKind,
    search: &mut S,
) {
    match kind {
        LeafKind::Triangles => blocks.triangles(leaf, search),
        LeafKind::Spheres => blocks.spheres(leaf, search),
        LeafKind::Others => (0..leaf.len()).for_each(|i| search.test(leaf.primitive(0, i))),
    }
}
