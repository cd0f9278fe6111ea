//! The memory of a hierarchy, checked once, so that traversals need no checks.
#![expect(unsafe_code, reason = "a check at every node costs 5 % of the time")]

use glam::Vec3;

use super::layout::{
    self, CAPSULE_BIT, CacheLine, ID_BIT, LEAF_WINDOW, LEAF_WINDOW_LINES, LeafKind, MAX_DEPTH,
    MAX_LEAF, NODE_LINES, NodeRef, WideNode,
};
use math::simd::N_LANES;
use world::geometry::Aabb;

/// Cache lines in which every reference that a traversal can reach refers to a whole node or leaf.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Arena {
    /// The root first; empty if there are no primitives.
    lines: Vec<CacheLine>,
    /// Largest magnitude of a coordinate of the boxes.
    largest: f32,
    /// Number of levels of nodes, at most one more than [`MAX_DEPTH`].
    n_levels: usize,
}

impl Arena {
    /// Checks the cache lines of a hierarchy within these bounds.
    ///
    /// # Panics
    /// If a reference points outside the lines, or a path is too long.
    pub(super) fn new(lines: Vec<CacheLine>, bounds: Aabb) -> Self {
        let n_levels = if lines.is_empty() {
            0
        } else {
            check(&lines, NodeRef::ROOT)
        };
        assert!(n_levels <= MAX_DEPTH + 1, "paths are short");
        let largest = bounds.largest();
        Self {
            lines,
            largest,
            n_levels,
        }
    }

    /// Returns true if there are no primitives.
    pub(super) fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }

    /// Returns the largest magnitude of a coordinate of the boxes.
    pub(super) fn largest(&self) -> f32 {
        self.largest
    }

    /// Returns the number of levels of nodes, at most one more than [`MAX_DEPTH`].
    pub(super) fn n_levels(&self) -> usize {
        self.n_levels
    }

    /// Returns all cache lines.
    pub(super) fn lines(&self) -> &[CacheLine] {
        &self.lines
    }

    /// Returns the node of a reference.
    ///
    /// # Safety
    /// The reference refers to a node: the root of this arena, which is not empty, or a child of
    /// one of its nodes.
    #[inline(always)]
    pub(super) unsafe fn node(&self, node_ref: NodeRef) -> &WideNode {
        debug_assert!(node_ref.line() + NODE_LINES <= self.lines.len());
        // Less work than adding lines.
        let n_bytes = 2 * node_ref.0 as usize;
        // SAFETY: `check` made sure that the whole node is within the lines. A line has the
        // alignment of a node, for which all bits are valid.
        unsafe { &*self.lines.as_ptr().byte_add(n_bytes).cast() }
    }

    /// Returns the leaf of a reference.
    ///
    /// # Safety
    /// The reference refers to a leaf that is a child of one of this arena's nodes.
    #[inline(always)]
    pub(super) unsafe fn leaf(&self, node_ref: NodeRef) -> Leaf<'_> {
        debug_assert!(node_ref.line() + LEAF_WINDOW_LINES <= self.lines.len());
        // SAFETY: `check` made sure that the window is within the lines. All bits are valid for
        // numbers.
        let numbers: &[f32; LEAF_WINDOW] =
            unsafe { &*self.lines.as_ptr().add(node_ref.line()).cast() };
        Leaf {
            numbers,
            n: node_ref.leaf_size(),
            kind: LeafKind::from_leaf(node_ref, numbers[0]),
        }
    }

    /// Returns the address of a node or leaf.
    #[inline(always)]
    pub(super) fn address(&self, node_ref: NodeRef) -> *const CacheLine {
        self.lines.as_ptr().wrapping_add(node_ref.line())
    }
}

/// Checks that the subtree below a node lies within the lines. Returns the number of its levels.
/// References point forward, so the recursion ends.
fn check(lines: &[CacheLine], node_ref: NodeRef) -> usize {
    let node = layout::node(lines, node_ref);
    let mut n_levels = 0;
    for &child in &node.children[..node.n_children()] {
        let child = NodeRef(child);
        assert!(child.line() > node_ref.line(), "references point forward");
        if child.is_leaf() {
            assert!(
                child.line() + LEAF_WINDOW_LINES <= lines.len(),
                "leaves lie within the arena"
            );
        } else {
            n_levels = n_levels.max(check(lines, child));
        }
    }
    n_levels + 1
}

/// A leaf.
#[derive(Clone, Copy)]
pub(super) struct Leaf<'a> {
    numbers: &'a [f32; LEAF_WINDOW],
    /// Number of primitives, from 1 to 8.
    n: usize,
    kind: LeafKind,
}

impl Leaf<'_> {
    /// Returns the number of primitives, from 1 to 8.
    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.n
    }

    /// Returns the kind of the primitives.
    #[inline(always)]
    pub(super) fn kind(&self) -> LeafKind {
        self.kind
    }

    /// Returns row `i` and the numbers that follow it.
    #[inline(always)]
    pub(super) fn row(&self, i: usize) -> &[f32; N_LANES] {
        // The mask changes nothing and avoids a bounds check.
        let row = self.numbers[(self.n * i) & 127..].first_chunk();
        row.expect("the window extends a row beyond number 127")
    }

    /// Returns the rows of a coordinate of the three vertices, in a leaf of triangles.
    #[inline(always)]
    pub(super) fn coordinate(&self, axis: usize) -> [&[f32; N_LANES]; 3] {
        // The mask changes nothing and bounds the rows.
        let (first, step) = (self.n * (axis & 3), 3 * self.n);
        const { assert!((3 + 6) * MAX_LEAF + N_LANES <= LEAF_WINDOW) };
        // SAFETY: a row of eight numbers from here on ends within the window.
        let row = |start: usize| unsafe { &*self.numbers.as_ptr().add(start).cast() };
        [row(first), row(first + step), row(first + 2 * step)]
    }

    /// Returns the vertices in a lane of a leaf of triangles.
    #[inline]
    pub(super) fn triangle(&self, lane: usize) -> [Vec3; 3] {
        let at = |row| self.row(row)[lane % N_LANES];
        [0, 3, 6].map(|first| Vec3::new(at(first), at(first + 1), at(first + 2)))
    }

    /// Returns the index of the primitive in a lane; `n_rows` rows precede the indices.
    #[inline(always)]
    pub(super) fn primitive(&self, n_rows: usize, lane: usize) -> u32 {
        self.row(n_rows)[lane % N_LANES].to_bits() & !(ID_BIT | CAPSULE_BIT)
    }
}
