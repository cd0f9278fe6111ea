//! Primitives → the arena of a hierarchy.
//!
//! First a binary tree down to single primitives, by the surface area
//! heuristic over bins (`binary`, `bins`, over `reference`s); then the best
//! tree of eight-wide nodes and leaves that can be cut from it (`collapse`);
//! then its lines (`emit`). All of it in parallel, on disjoint slices of
//! memory, and no decision depends on the threads.

mod reference;
mod bins;
mod binary;
mod collapse;
mod order;
mod emit;

use rayon::prelude::*;

use super::arena::Arena;
use super::layout::{LEAF_WINDOW_LINES, Line, NODE_LINES, Word};
use crate::scene::Primitive;
use binary::BinaryNode;
use reference::{Corners, Reference};

pub(super) use binary::MAX_DEPTH;

/// Lines of the arena for each primitive at most: one of a leaf, and there are
/// fewer nodes than leaves, since each has two children at least. (In practice
/// a primitive takes less than one line.)
const MAX_LINES_PER_PRIMITIVE: usize = 1 + NODE_LINES;

/// Most primitives whose arena is sure to be no larger than words can tell.
pub(super) const MAX_PRIMITIVES: usize =
    (Word::MAX_LINES - NODE_LINES - LEAF_WINDOW_LINES) / MAX_LINES_PER_PRIMITIVE;

/// Bytes for each primitive at most: its index, its part of the binary tree,
/// and the larger of what the two phases need beside. While the binary tree
/// grows that is two sets of references; then the arena.
pub(super) const MAX_BYTES_PER_PRIMITIVE: usize = {
    let tree = 2 * size_of::<BinaryNode>();
    let references = 2 * size_of::<Reference>();
    let arena = MAX_LINES_PER_PRIMITIVE * size_of::<Line>();
    let more = if references > arena {
        references
    } else {
        arena
    };
    size_of::<u32>() + tree + more
};

/// Builds the hierarchy over the primitives with these indices. No lines for no
/// primitives.
pub(super) fn arena(primitives: &[Primitive], indices: Vec<u32>) -> Arena {
    if indices.is_empty() {
        return Arena::default();
    }
    let mut nodes = vec![BinaryNode::default(); 2 * indices.len() - 1];
    grow(primitives, indices, &mut nodes);
    let whole = collapse::choose(&mut nodes);
    let lines = emit::lines(&nodes, &whole, primitives);
    Arena::new(lines, nodes[0].bounds)
}

/// Grows the binary tree over these primitives.
fn grow(primitives: &[Primitive], indices: Vec<u32>, nodes: &mut [BinaryNode]) {
    let mut references: Vec<Reference> = indices
        .into_par_iter()
        .with_min_len(8192)
        .map(|index| Reference::new(&primitives[index as usize], index))
        .collect();
    let (bounds, centers) = references
        .par_iter()
        .with_min_len(8192)
        .map(|reference| (reference.corners(), reference.center_corners()))
        .reduce(
            || (Corners::EMPTY, Corners::EMPTY),
            |a, b| (a.0.union(b.0), a.1.union(b.1)),
        );
    let mut spare = references.clone();
    binary::grow(&mut references, &mut spare, nodes, bounds, centers, 0);
}
