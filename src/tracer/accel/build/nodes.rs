//! The nodes of the binary tree.

use bytemuck::Zeroable;

use super::bounds::LaneBounds;
use super::forests::{ForestChoices, Forests};
use math::simd::InstructionSet;
use world::geometry::Aabb;

/// An inner node of the binary tree. The array of nodes is in depth-first order, with gaps where
/// references might have been split and were not.
#[derive(Debug, Clone, Copy, Zeroable)]
pub(super) struct BinaryNode {
    /// The box around the node's references.
    pub(super) bounds: Aabb,
    /// Number of nodes, and of references, from this node to its second child. The two highest bits
    /// mark the children that are leaves.
    link: u32,
    /// The form of the node's subtree.
    pub(super) choices: ForestChoices,
    /// Cache lines of the subtree in the arena if it becomes a node or a leaf there.
    pub(super) n_lines: u32,
    /// Cost of the subtree in the time SAH, in units of half a surface area.
    pub(super) cost: f32,
}

/// The position of a subtree in the arrays.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct TreePosition {
    /// Index of the first node; unused for a leaf.
    pub(super) node: usize,
    /// Index of the first reference.
    pub(super) reference: usize,
    /// True for a single reference.
    pub(super) is_leaf: bool,
}

impl BinaryNode {
    /// Returns the positions of the children of a node at position `own`.
    pub(super) fn children(&self, own: TreePosition) -> [TreePosition; 2] {
        let second = (self.link & ((1 << 30) - 1)) as usize;
        [
            TreePosition {
                node: own.node + 1,
                reference: own.reference,
                is_leaf: self.link >> 30 & 1 != 0,
            },
            TreePosition {
                node: own.node + second,
                reference: own.reference + second,
                is_leaf: self.link >> 31 != 0,
            },
        ]
    }
}

/// The root of a subtree whose children are being built.
pub(super) struct OpenNode<'a> {
    pub(super) node: &'a mut BinaryNode,
    pub(super) bounds: LaneBounds,
    /// Number of nodes, and of references, from this node to its second child.
    pub(super) second: usize,
    /// True for each child that is a single reference.
    pub(super) is_leaf: [bool; 2],
}

impl OpenNode<'_> {
    /// Writes the node. Returns the forests of the subtree.
    #[inline(always)]
    pub(super) fn close<I: InstructionSet>(
        self,
        set: I,
        first: &Forests,
        second: &Forests,
    ) -> Forests {
        let forests = Forests::combine(set, first, second, &self.bounds);
        self.write(forests)
    }

    /// Writes the node with these forests and choices. Returns the forests.
    #[inline(always)]
    pub(super) fn write(self, (forests, choices): (Forests, ForestChoices)) -> Forests {
        let [first_leaf, second_leaf] = self.is_leaf.map(u32::from);
        *self.node = BinaryNode {
            bounds: self.bounds.to_aabb(),
            link: self.second as u32 | first_leaf << 30 | second_leaf << 31,
            choices,
            n_lines: forests.n_lines(),
            cost: forests.cost(),
        };
        forests
    }
}
