//! A ray through the hierarchy, nearest children first.
//!
//! One generic function, compiled once for each instruction set, search and
//! probe; no allocation, no recursion. The order of visits is the same on
//! every instruction set, and so are the counters.

mod block;
mod slab;
mod stack;

use super::layout::{self, LeafKind, Line, MAX_LEAF_LEN, Word};
use super::search::Search;
use super::simd::{InstructionSet, Lanes, Mask, N_LANES, Work};
use crate::cost::Probe;
use crate::geometry::Ray;
use block::Blocks;
use slab::Slabs;
use stack::Stack;

/// One ray's way through an arena, which is not empty.
pub(super) struct Traversal<'a, S, P> {
    pub(super) lines: &'a [Line],
    /// The boxes' largest coordinate in magnitude.
    pub(super) largest: f32,
    pub(super) ray: &'a Ray,
    /// What is shown the primitives that the ray may hit.
    pub(super) search: &'a mut S,
    /// What hears of the nodes and tests.
    pub(super) probe: &'a mut P,
    /// Tests that the ray had before.
    pub(super) n_tests: u32,
}

/// Where a ray goes next.
enum Step {
    Into(Word),
    Back,
}

impl<S: Search, P: Probe> Work for Traversal<'_, S, P> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) {
        let slabs = Slabs::new(set, self.ray, self.largest);
        let blocks = Blocks::new(set, self.ray);
        let mut stack = Stack::new();
        let (mut n_visits, mut n_tests) = (0, self.n_tests);
        let mut limit = set.splat(self.search.limit());
        let mut word = Word::ROOT;
        loop {
            let step = match word.leaf_kind() {
                None => {
                    n_visits += 1;
                    let node = layout::node(self.lines, word);
                    let (enter, hits) = slabs.enter(set, node, limit);
                    descend::<I, S>(enter, hits, &node.children, &mut stack)
                }
                Some(kind) => {
                    let (numbers, n) = (layout::leaf(self.lines, word), word.leaf_size());
                    n_tests += n as u32;
                    match kind {
                        LeafKind::Triangles => blocks.triangles(numbers, n, self.search),
                        LeafKind::Spheres => blocks.spheres(numbers, n, self.search),
                        LeafKind::Others => others(numbers, n, self.search),
                    }
                    if self.search.is_done() {
                        break;
                    }
                    limit = set.splat(self.search.limit());
                    Step::Back
                }
            };
            word = match step {
                Step::Into(word) => word,
                Step::Back => match next_waiting(&mut stack, self.search) {
                    Some(word) => word,
                    None => break,
                },
            };
        }
        self.probe.traversal(n_visits, n_tests);
    }
}

/// Leaves all children that were hit but one on the stack and goes into that
/// one: the nearest, where the search asks for order.
#[inline(always)]
fn descend<I: InstructionSet, S: Search>(
    enter: I::Lanes,
    hits: <I::Lanes as Lanes>::Mask,
    children: &[u32; N_LANES],
    stack: &mut Stack,
) -> Step {
    let bits = hits.bits();
    let first = bits.trailing_zeros() as usize % N_LANES;
    let others = bits & bits.wrapping_sub(1);
    if bits == 0 {
        return Step::Back;
    }
    if others == 0 {
        return Step::Into(Word(children[first]));
    }
    let n = bits.count_ones() as usize;
    if !S::NEAREST_FIRST {
        let words = I::Lanes::compress(hits, children);
        stack.push_all(words, [0.0; N_LANES], n - 1);
        return Step::Into(Word(words[(n - 1) % N_LANES]));
    }
    if others & (others - 1) == 0 {
        let second = others.trailing_zeros() as usize % N_LANES;
        let enter = enter.to_array();
        let (near, far) = match enter[first] <= enter[second] {
            true => (first, second),
            false => (second, first),
        };
        stack.push(children[far], enter[far]);
        return Step::Into(Word(children[near]));
    }
    let (words, enter) = enter.far_to_near(hits, children);
    stack.push_all(words, enter, n - 1);
    Step::Into(Word(words[(n - 1) % N_LANES]))
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

/// Tests primitives one by one.
#[inline(always)]
fn others<S: Search>(numbers: &[f32; MAX_LEAF_LEN], n: usize, search: &mut S) {
    for &number in &numbers[..n] {
        search.test(layout::primitive_index(number));
    }
}
