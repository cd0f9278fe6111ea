//! The memory of a hierarchy, checked once, so that rays need not check.
#![expect(
    unsafe_code,
    reason = "a check at every node costs a twentieth of the time"
)]

use super::layout::{self, ID_BIT, LEAF_WINDOW, LEAF_WINDOW_LINES, Line, NODE_LINES, Node, Word};
use super::simd::N_LANES;
use crate::geometry::Aabb;

/// Lines in which all words that a ray can come across name whole nodes and
/// leaves.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Arena {
    /// The root first; empty if there are no primitives.
    lines: Vec<Line>,
    /// The boxes' largest coordinate in magnitude.
    largest: f32,
}

impl Arena {
    /// Checks the lines of a hierarchy within these bounds.
    ///
    /// # Panics
    /// If a word names what is not there.
    pub(super) fn new(lines: Vec<Line>, bounds: Aabb) -> Self {
        if !lines.is_empty() {
            check(&lines, Word::ROOT);
        }
        let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
        Self { lines, largest }
    }

    /// Whether there are no primitives.
    pub(super) fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }

    /// The boxes' largest coordinate in magnitude.
    pub(super) fn largest(&self) -> f32 {
        self.largest
    }

    /// All lines.
    pub(super) fn lines(&self) -> &[Line] {
        &self.lines
    }

    /// The node that a word names.
    ///
    /// # Safety
    /// The word names a node: the root of this arena, which is not empty, or a
    /// child of one of its nodes.
    #[inline(always)]
    pub(super) unsafe fn node(&self, word: Word) -> &Node {
        debug_assert!(word.line() + NODE_LINES <= self.lines.len());
        // SAFETY: `check` found the node whole; a line is aligned as a node is,
        // which may have any bits.
        unsafe { &*self.lines.as_ptr().add(word.line()).cast() }
    }

    /// The leaf that a word names.
    ///
    /// # Safety
    /// The word names a leaf, as a child of one of this arena's nodes.
    #[inline(always)]
    pub(super) unsafe fn leaf(&self, word: Word) -> Leaf<'_> {
        debug_assert!(word.line() + LEAF_WINDOW_LINES <= self.lines.len());
        // SAFETY: `check` found so many lines; numbers may have any bits.
        let numbers = unsafe { &*self.lines.as_ptr().add(word.line()).cast() };
        Leaf {
            numbers,
            n: word.leaf_size(),
        }
    }

    /// Where what a word names begins.
    #[inline(always)]
    pub(super) fn address(&self, word: Word) -> *const Line {
        self.lines.as_ptr().wrapping_add(word.line())
    }
}

/// Makes sure that all below a node lies within the lines. Words lead forward,
/// so that there is an end to it.
fn check(lines: &[Line], word: Word) {
    let node = layout::node(lines, word);
    for &child in &node.children[..node.n_children()] {
        let child = Word(child);
        assert!(child.line() > word.line(), "words lead forward");
        if child.is_leaf() {
            assert!(
                child.line() + LEAF_WINDOW_LINES <= lines.len(),
                "leaves end"
            );
        } else {
            check(lines, child);
        }
    }
}

/// A leaf.
#[derive(Clone, Copy)]
pub(super) struct Leaf<'a> {
    numbers: &'a [f32; LEAF_WINDOW],
    /// How many primitives it has, from 1 to 8.
    n: usize,
}

impl Leaf<'_> {
    /// How many primitives it has, from 1 to 8.
    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.n
    }

    /// Row `i`, and what follows it.
    #[inline(always)]
    pub(super) fn row(&self, i: usize) -> &[f32; N_LANES] {
        // The mask changes nothing, and spares a check.
        let row = self.numbers[(self.n * i) & 127..].first_chunk();
        row.expect("the window is larger than 127 and a row")
    }

    /// The index of the primitive in a lane, after so many rows of numbers.
    #[inline(always)]
    pub(super) fn primitive(&self, n_rows: usize, lane: usize) -> u32 {
        self.row(n_rows)[lane % N_LANES].to_bits() & !ID_BIT
    }
}
