//! Size and expected cost of a hierarchy.

use super::arena::Arena;
use super::layout::{self, CacheLine, NodeRef, WideNode};
use world::geometry::Aabb;

/// Cost of a node in the count SAH: one node visit counts as much as one primitive test.
pub(super) const NODE_COUNT: f64 = 1.0;

/// Size and expected cost of a hierarchy.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct BvhStatistics {
    /// Nodes of up to eight children.
    pub n_nodes: usize,
    /// Leaves of up to eight primitives.
    pub n_leaves: usize,
    /// References to primitives in all leaves; a primitive that was split has several.
    pub n_references: usize,
    /// Number of edges from the root to the deepest leaf.
    pub depth: usize,
    /// The count SAH: the expected number of node visits and primitive tests of a ray through the
    /// root's box, by the surface area heuristic. The build minimizes another quantity, the time
    /// SAH, in which a leaf costs the same however many primitives are tested at once
    /// (`build/forests.rs`).
    pub sah_cost: f32,
    /// The leaf cost: the part of the count SAH that is primitive tests; 0 in a summary of an older
    /// version.
    #[serde(default)]
    pub leaf_cost: f32,
    /// The end-point overlap, if it was [measured](super::Accel::measure_overlap): the expected
    /// number of visits of nodes that do not hold the surface on which a ray ends, and of
    /// primitive tests in such leaves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub epo: Option<f32>,
    /// Memory of nodes and leaves, in bytes.
    pub bytes: usize,
    /// Bytes that a node visit reads; a quarter less where the ray enters no child.
    pub bytes_per_visit: usize,
    /// Bytes of a leaf per primitive, which a visit to the leaf reads: the mean over all leaves; 0
    /// if there are none.
    pub bytes_per_test: f32,
    /// True for the hierarchy of an animation's first frame with boxes around the moved objects;
    /// left out otherwise.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_refitted: bool,
}

impl BvhStatistics {
    /// Adds the hierarchies of instanced meshes: sums, the depth of the deepest path through both
    /// levels, and the expected cost of the upper level, in which an instance counts as one test.
    pub(super) fn with_lower(self, lower: impl Iterator<Item = Self>) -> Self {
        let mut sum = self;
        for mesh in lower {
            let n = (sum.n_references + mesh.n_references).max(1) as f32;
            let bytes = sum.bytes_per_test * sum.n_references as f32
                + mesh.bytes_per_test * mesh.n_references as f32;
            sum.bytes_per_test = bytes / n;
            sum.n_nodes += mesh.n_nodes;
            sum.n_leaves += mesh.n_leaves;
            sum.n_references += mesh.n_references;
            sum.bytes += mesh.bytes;
            sum.depth = sum.depth.max(self.depth + mesh.depth);
        }
        sum
    }

    /// Measures an arena, which may be empty.
    pub(super) fn measure(arena: &Arena) -> Self {
        let lines = arena.lines();
        let mut sums = NodeSums::default();
        if !lines.is_empty() {
            let root = layout::node(lines, NodeRef::ROOT);
            let area = node_bounds(root).surface_area();
            sums.node(lines, NodeRef::ROOT, f64::from(area), 0);
            let area = f64::from(area).max(f64::MIN_POSITIVE);
            (sums.cost, sums.leaf_cost) = (sums.cost / area, sums.leaf_cost / area);
        }
        Self {
            n_nodes: sums.n_nodes,
            n_leaves: sums.n_leaves,
            n_references: sums.n_references,
            depth: sums.depth,
            sah_cost: sums.cost as f32,
            leaf_cost: sums.leaf_cost as f32,
            epo: None,
            bytes: size_of_val(lines),
            bytes_per_visit: size_of::<WideNode>(),
            bytes_per_test: (sums.n_leaf_lines * size_of::<CacheLine>()) as f32
                / sums.n_references.max(1) as f32,
            is_refitted: false,
        }
    }
}

#[derive(Default)]
struct NodeSums {
    n_nodes: usize,
    n_leaves: usize,
    n_references: usize,
    n_leaf_lines: usize,
    depth: usize,
    /// Sum of the costs, each times its surface area.
    cost: f64,
    /// The part of leaves in it.
    leaf_cost: f64,
}

impl NodeSums {
    fn node(&mut self, lines: &[CacheLine], node_ref: NodeRef, area: f64, depth: usize) {
        self.n_nodes += 1;
        self.depth = self.depth.max(depth + 1);
        self.cost += NODE_COUNT * area;
        let node = layout::node(lines, node_ref);
        for i in 0..node.n_children() {
            let child = NodeRef(node.children[i]);
            let area = f64::from(child_bounds(node, i).surface_area());
            if child.is_leaf() {
                self.n_leaves += 1;
                self.n_references += child.leaf_size();
                self.n_leaf_lines += layout::leaf_kind(lines, child).n_lines(child.leaf_size());
                self.cost += child.leaf_size() as f64 * area;
                self.leaf_cost += child.leaf_size() as f64 * area;
            } else {
                self.node(lines, child, area, depth + 1);
            }
        }
    }
}

/// Returns the box around all children of a node.
pub(super) fn node_bounds(node: &WideNode) -> Aabb {
    let bounds = (0..node.n_children()).map(|i| child_bounds(node, i));
    bounds.fold(Aabb::EMPTY, Aabb::union)
}

/// Returns the box of a node's child `i`.
pub(super) fn child_bounds(node: &WideNode, i: usize) -> Aabb {
    Aabb {
        min: node.min.map(|row| row[i]).into(),
        max: node.max.map(|row| row[i]).into(),
    }
}
