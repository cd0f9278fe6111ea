//! The optimal eight-wide tree that a binary tree can be collapsed into, by the choices made in
//! `forests`.

use super::forests::Forests;
use super::nodes::{BinaryNode, TreePosition};
use super::reference::Reference;
use world::geometry::Aabb;

/// A binary tree: its inner nodes, and the references that are its leaves.
pub(super) struct BinaryTree {
    pub(super) nodes: Vec<BinaryNode>,
    pub(super) references: Vec<Reference>,
    pub(super) root: TreePosition,
}

impl BinaryTree {
    /// Returns the box of a subtree.
    pub(super) fn bounds(&self, subtree: TreePosition) -> Aabb {
        if subtree.is_leaf {
            self.references[subtree.reference].bounds().to_aabb()
        } else {
            self.nodes[subtree.node].bounds
        }
    }

    /// Returns the references of a subtree that becomes a leaf where it is a single root, or `None`
    /// if it becomes a node.
    pub(super) fn leaf(&self, subtree: TreePosition) -> Option<&[Reference]> {
        let n = if subtree.is_leaf {
            1
        } else {
            let choices = self.nodes[subtree.node].choices;
            choices.is_leaf().then(|| choices.leaf_size())?
        };
        self.references
            .get(subtree.reference..subtree.reference + n)
    }

    /// Returns the cost of a subtree as a single root, in units of half a surface area.
    pub(super) fn cost(&self, subtree: TreePosition) -> f32 {
        if subtree.is_leaf {
            Forests::from_reference(&self.references[subtree.reference]).cost()
        } else {
            self.nodes[subtree.node].cost
        }
    }

    /// Returns the cache lines of a subtree as a single root.
    pub(super) fn n_lines(&self, subtree: TreePosition) -> usize {
        if subtree.is_leaf {
            self.references[subtree.reference].kind().n_lines(1)
        } else {
            self.nodes[subtree.node].n_lines as usize
        }
    }
}

/// Up to eight subtrees.
#[derive(Default)]
pub(super) struct Roots {
    positions: [TreePosition; 8],
    n: usize,
}

impl Roots {
    /// Returns the children of an eight-wide node over the subtree.
    pub(super) fn below(tree: &BinaryTree, subtree: TreePosition) -> Self {
        let mut roots = Self::default();
        if subtree.is_leaf {
            roots.add(subtree);
        } else {
            roots.distribute(tree, subtree, 8);
        }
        roots
    }

    /// Returns the subtree as a single root.
    pub(super) fn alone(subtree: TreePosition) -> Self {
        let mut roots = Self::default();
        roots.add(subtree);
        roots
    }

    pub(super) fn positions(&self) -> &[TreePosition] {
        &self.positions[..self.n]
    }

    fn add(&mut self, subtree: TreePosition) {
        self.positions[self.n] = subtree;
        self.n += 1;
    }

    /// Adds the cheapest forest of at most `n_roots` roots of the subtree.
    fn expand(&mut self, tree: &BinaryTree, subtree: TreePosition, mut n_roots: usize) {
        if subtree.is_leaf {
            return self.add(subtree);
        }
        let choices = tree.nodes[subtree.node].choices;
        // Use fewer roots where more cost no less.
        while n_roots > 1 && choices.n_first(n_roots) == 0 {
            n_roots -= 1;
        }
        if n_roots > 1 {
            self.distribute(tree, subtree, n_roots);
        } else {
            self.add(subtree);
        }
    }

    /// Adds `n_roots` roots from the two subtrees of a node.
    fn distribute(&mut self, tree: &BinaryTree, subtree: TreePosition, n_roots: usize) {
        let node = &tree.nodes[subtree.node];
        let n_first = node.choices.n_first(n_roots);
        let [first, second] = node.children(subtree);
        self.expand(tree, first, n_first);
        self.expand(tree, second, n_roots - n_first);
    }
}
