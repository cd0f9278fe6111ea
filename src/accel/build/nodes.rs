//! The nodes of the binary tree.

use bytemuck::Zeroable;

use super::bounds::LaneBounds;
use super::forests::ForestChoices;
use crate::geometry::Aabb;

/// An inner node of the binary tree. The array of nodes is in depth-first order,
/// with gaps where references might have been split and were not.
#[derive(Debug, Clone, Copy, Zeroable)]
pub(super) struct BinaryNode {
    /// The box around its references.
    pub(super) bounds: Aabb,
    /// How many nodes and references further on its second child begins. The two
    /// highest bits tell which children are leaves.
    link: u32,
    /// What becomes of its subtree.
    pub(super) choices: ForestChoices,
    /// Cache lines of its subtree in the arena if it becomes a node or a leaf
    /// there.
    pub(super) n_lines: u32,
}

/// Where a subtree is in the arrays.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct TreePosition {
    /// Its first node; it has none if it is a leaf.
    pub(super) node: usize,
    /// Its first reference.
    pub(super) reference: usize,
    /// Whether it is a single reference.
    pub(super) is_leaf: bool,
}

impl BinaryNode {
    /// A node within these bounds; `link` in its parts.
    #[inline(always)]
    pub(super) fn new(
        bounds: LaneBounds,
        second: usize,
        is_leaf: [bool; 2],
        choices: ForestChoices,
        n_lines: u32,
    ) -> Self {
        let [first_leaf, second_leaf] = is_leaf.map(u32::from);
        Self {
            bounds: bounds.to_aabb(),
            link: second as u32 | first_leaf << 30 | second_leaf << 31,
            choices,
            n_lines,
        }
    }

    /// Its children, where it is at this position itself.
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
