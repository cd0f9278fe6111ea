//! The size of a hierarchy.

use super::arena::Arena;
use super::layout::{self, Line, Node, Word};
use crate::geometry::Aabb;

/// Cost of a node, in primitive tests.
pub(super) const NODE_COST: f64 = 1.0;

/// The size of a hierarchy.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct BvhStatistics {
    /// Nodes of up to eight children.
    pub n_nodes: usize,
    /// Leaves of up to eight primitives.
    pub n_leaves: usize,
    /// Primitives in all leaves; those that were cut are in several.
    pub n_references: usize,
    /// Edges from the root to the deepest leaf.
    pub depth: usize,
    /// Expected cost of a ray through the root's box, in primitive tests, by
    /// the surface area heuristic.
    pub sah_cost: f32,
    /// Memory of nodes and leaves.
    pub bytes: usize,
    /// What a ray reads of a node, in bytes; a quarter less where it enters no
    /// child.
    pub bytes_per_visit: usize,
    /// What a ray reads of a leaf for each of its primitives, in bytes: the mean
    /// over all leaves; 0 if there is none.
    pub bytes_per_test: f32,
}

impl BvhStatistics {
    /// Of an arena, which may be empty.
    pub(super) fn of(arena: &Arena) -> Self {
        let lines = arena.lines();
        let mut count = Count::default();
        if !lines.is_empty() {
            let root = layout::node(lines, Word::ROOT);
            let area = node_bounds(root).surface_area();
            count.node(lines, Word::ROOT, f64::from(area), 0);
            count.cost /= f64::from(area).max(f64::MIN_POSITIVE);
        }
        Self {
            n_nodes: count.n_nodes,
            n_leaves: count.n_leaves,
            n_references: count.n_references,
            depth: count.depth,
            sah_cost: count.cost as f32,
            bytes: size_of_val(lines),
            bytes_per_visit: size_of::<Node>(),
            bytes_per_test: (count.n_leaf_lines * size_of::<Line>()) as f32
                / count.n_references.max(1) as f32,
        }
    }
}

#[derive(Default)]
struct Count {
    n_nodes: usize,
    n_leaves: usize,
    n_references: usize,
    n_leaf_lines: usize,
    depth: usize,
    /// Sum of costs times areas.
    cost: f64,
}

impl Count {
    fn node(&mut self, lines: &[Line], word: Word, area: f64, depth: usize) {
        self.n_nodes += 1;
        self.depth = self.depth.max(depth + 1);
        self.cost += NODE_COST * area;
        let node = layout::node(lines, word);
        for i in 0..node.n_children() {
            let child = Word(node.children[i]);
            let area = f64::from(child_bounds(node, i).surface_area());
            if child.is_leaf() {
                self.n_leaves += 1;
                self.n_references += child.leaf_size();
                self.n_leaf_lines += child.leaf_kind().n_lines(child.leaf_size());
                self.cost += child.leaf_size() as f64 * area;
            } else {
                self.node(lines, child, area, depth + 1);
            }
        }
    }
}

/// The box around all children of a node.
pub(super) fn node_bounds(node: &Node) -> Aabb {
    let bounds = (0..node.n_children()).map(|i| child_bounds(node, i));
    bounds.fold(Aabb::EMPTY, Aabb::union)
}

/// The box of a node's child `i`.
pub(super) fn child_bounds(node: &Node, i: usize) -> Aabb {
    Aabb {
        min: node.min.map(|row| row[i]).into(),
        max: node.max.map(|row| row[i]).into(),
    }
}
