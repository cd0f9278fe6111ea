//! References → a binary tree down to single primitives.

use super::bins::Split;
use super::reference::{Corners, Reference};
use crate::accel::layout::LeafKind;
use crate::geometry::Aabb;

/// Deepest node, the root being at 0.
pub(in crate::accel) const MAX_DEPTH: usize = 64;

/// From so many references on the halves grow in parallel.
const PARALLEL: usize = 4096;
/// From so many references on there are more bins.
const MANY: usize = 48;

/// A node of the binary tree; the nodes stand depth first.
#[derive(Debug, Clone, Copy)]
pub(super) struct BinaryNode {
    /// The box around it.
    pub(super) bounds: Aabb,
    pub(super) kind: Kind,
    /// For `collapse`.
    pub(super) choices: u32,
    /// Lines of its subtree in the arena if it becomes a node or a leaf there;
    /// by `collapse`.
    pub(super) n_lines: u32,
}

/// What a node of the binary tree is.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kind {
    /// A primitive by its index.
    Leaf { primitive: u32, kind: LeafKind },
    /// The first child is the next node, the second one so many nodes on.
    Inner { second: u32 },
}

impl Default for BinaryNode {
    fn default() -> Self {
        Self {
            bounds: Aabb::EMPTY,
            kind: Kind::Inner { second: 0 },
            choices: 0,
            n_lines: 0,
        }
    }
}

/// Grows the tree over `n` references into `2 * n - 1` nodes. `spare` is as
/// long as `references`; the order in both is lost.
pub(super) fn grow(
    references: &mut [Reference],
    spare: &mut [Reference],
    nodes: &mut [BinaryNode],
    bounds: Corners,
    centers: Corners,
    depth: usize,
) {
    let n = references.len();
    let (node, below) = nodes.split_first_mut().expect("a node for each subtree");
    node.bounds = bounds.to_aabb();
    if let [reference] = references {
        node.kind = Kind::Leaf {
            primitive: reference.index,
            kind: reference.kind(),
        };
        return;
    }
    let (parts, from, to) = match split(references, &centers, depth) {
        Some(split) => (part(references, spare, &split), spare, references),
        None => (halves(references), references, spare),
    };
    let [left, right] = parts;
    node.kind = Kind::Inner {
        second: 2 * left.n as u32,
    };
    let (from_left, from_right) = from.split_at_mut(left.n);
    let (to_left, to_right) = to.split_at_mut(left.n);
    let (nodes_left, nodes_right) = below.split_at_mut(2 * left.n - 1);
    let mut grow_left = || {
        grow(
            from_left,
            to_left,
            nodes_left,
            left.bounds,
            left.centers,
            depth + 1,
        );
    };
    let mut grow_right = || {
        grow(
            from_right,
            to_right,
            nodes_right,
            right.bounds,
            right.centers,
            depth + 1,
        );
    };
    if n < PARALLEL {
        grow_left();
        grow_right();
    } else {
        rayon::join(grow_left, grow_right);
    }
}

/// The way to part the references; `None` to halve them as they stand.
fn split(references: &[Reference], centers: &Corners, depth: usize) -> Option<Split> {
    let n = references.len();
    // Halving needs log2(n) levels more: switch to it before they run out.
    let levels_of_halves = n.next_power_of_two().trailing_zeros() as usize;
    match n {
        2 => None,
        _ if depth + levels_of_halves >= MAX_DEPTH => None,
        _ if n < MANY => Split::best::<8>(references, centers),
        _ => Split::best::<32>(references, centers),
    }
}

/// One side of a split.
struct Part {
    n: usize,
    bounds: Corners,
    /// The box around the doubled centres.
    centers: Corners,
}

/// Moves the references to `to`, in their order, those of the left side first.
fn part(references: &[Reference], to: &mut [Reference], split: &Split) -> [Part; 2] {
    let mut ends = [0, split.n_left];
    let mut centers = [Corners::EMPTY; 2];
    for reference in references {
        // No branch on the side, which nobody can foretell.
        let side = usize::from(!split.is_left(reference));
        to[ends[side]] = *reference;
        ends[side] += 1;
        centers[side] = centers[side].union(reference.center_corners());
    }
    let [left, right] = centers;
    [
        Part {
            n: split.n_left,
            bounds: split.left,
            centers: left,
        },
        Part {
            n: references.len() - split.n_left,
            bounds: split.right,
            centers: right,
        },
    ]
}

/// The references as they stand, half on each side.
fn halves(references: &[Reference]) -> [Part; 2] {
    let (left, right) = references.split_at(references.len() / 2);
    [left, right].map(|half| {
        let sum = |of: fn(&Reference) -> Corners| {
            half.iter().map(of).fold(Corners::EMPTY, Corners::union)
        };
        Part {
            n: half.len(),
            bounds: sum(Reference::corners),
            centers: sum(Reference::center_corners),
        }
    })
}
