//! The hierarchy as a list of nodes, for output files.

use super::arena::Arena;
use super::layout::{self, CacheLine, NodeRef};
use super::statistics::{NODE_COUNT, child_bounds, node_bounds};
use world::geometry::Aabb;

/// A node or a leaf of the hierarchy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BvhNode {
    /// The ID that [`TraversalStep`](super::TraversalStep)s refer to: 0 for the root, ascending in
    /// the list, with gaps.
    pub id: u32,
    /// The ID of the parent, which precedes the node in the list; `None` for the root.
    pub parent: Option<u32>,
    /// The node's box in world space.
    pub bounds: Aabb,
    /// Number of edges from the root.
    pub depth: u32,
    /// True if the node has primitives instead of children.
    pub is_leaf: bool,
    /// References in the leaves below the node; a primitive that was split has several.
    pub n_primitives: u32,
    /// The expected number of node visits and primitive tests in this node and below it, for a ray
    /// through the root's box, by the surface area heuristic. At the root, it is
    /// [`BvhStatistics::sah_cost`](super::BvhStatistics::sah_cost).
    pub sah_cost: f32,
    /// The end-point overlap of this node and the nodes below it: the expected number of visits of
    /// nodes that do not hold the surface on which a ray ends, and of primitive tests in such
    /// leaves. `None` unless [measured](super::Accel::measure_overlap).
    pub epo: Option<f32>,
    /// For a node in the space of an instanced mesh: the index of the mesh among such meshes.
    pub mesh: Option<u32>,
}

impl BvhNode {
    /// Returns the node as a node of an instanced mesh, whose root has the ID `first_id`.
    pub(super) fn in_mesh(self, mesh: u32, first_id: u32) -> Self {
        Self {
            id: first_id + self.id,
            parent: self.parent.map(|parent| first_id + parent),
            mesh: Some(mesh),
            ..self
        }
    }
}

/// Returns all nodes and leaves in depth-first order.
pub(super) fn list(arena: &Arena) -> Vec<BvhNode> {
    let mut nodes = Vec::new();
    let lines = arena.lines();
    if !lines.is_empty() {
        let bounds = node_bounds(layout::node(lines, NodeRef::ROOT));
        let area = f64::from(bounds.surface_area()).max(f64::MIN_POSITIVE);
        NodeList {
            lines,
            root_area: area,
            nodes: &mut nodes,
        }
        .add(NodeRef::ROOT, bounds, None, 0);
        nodes.sort_unstable_by_key(|node| node.id);
    }
    nodes
}

struct NodeList<'a> {
    lines: &'a [CacheLine],
    root_area: f64,
    nodes: &'a mut Vec<BvhNode>,
}

impl NodeList<'_> {
    /// Adds the node or leaf of a reference and the subtree below it. Returns its number of
    /// primitives and its cost.
    fn add(
        &mut self,
        node_ref: NodeRef,
        bounds: Aabb,
        parent: Option<u32>,
        depth: u32,
    ) -> (u32, f64) {
        let probability = f64::from(bounds.surface_area()) / self.root_area;
        let index = self.nodes.len();
        let id = node_ref.line() as u32;
        self.nodes.push(BvhNode {
            id,
            parent,
            bounds,
            depth,
            is_leaf: node_ref.is_leaf(),
            n_primitives: 0,
            sah_cost: 0.0,
            epo: None,
            mesh: None,
        });
        let (n_primitives, sah_cost) = if node_ref.is_leaf() {
            let n = node_ref.leaf_size() as u32;
            (n, f64::from(n) * probability)
        } else {
            let node = layout::node(self.lines, node_ref);
            let children = 0..node.n_children();
            let below = children.map(|i| {
                let child = NodeRef(node.children[i]);
                self.add(child, child_bounds(node, i), Some(id), depth + 1)
            });
            below.fold((0, NODE_COUNT * probability), |sum, child| {
                (sum.0 + child.0, sum.1 + child.1)
            })
        };
        self.nodes[index].n_primitives = n_primitives;
        self.nodes[index].sah_cost = sah_cost as f32;
        (n_primitives, sah_cost)
    }
}
