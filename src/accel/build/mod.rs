//! Primitives → the arena of a hierarchy.
//!
//! Two steps: a binary tree over `reference`s to primitives, one per leaf
//! (`binary`), with the choices that lead to the optimal tree of eight-wide nodes
//! and leaves (`forests`); the cache lines of that tree (`collapse`, `emit`).
//!
//! `split_candidate` chooses how a node of the binary tree is split, by the
//! surface area heuristic: by the centers of whole references (`object_split`)
//! or, with quality `high`, by a plane that splits triangles (`spatial_split`).
//! `partition` moves the references. With quality `balanced` the worst triangles
//! are split beforehand (`presplit`).
//!
//! The build runs in parallel on disjoint slices of memory, with all threads from
//! the first split on; each thread builds its subtrees in lanes (`simd`). No decision
//! depends on the number of threads or on the instruction set.

mod bounds;
mod clip;
mod reference;
mod object_bins;
mod object_split;
mod spatial_split;
mod partition;
mod split_candidate;
mod workers;
mod presplit;
mod forests;
mod nodes;
mod binary;
mod collapse;
mod order;
mod emit;

use std::fmt;

use bytemuck::Zeroable;
use rayon::prelude::*;

use super::arena::Arena;
use super::layout::{CacheLine, NodeRef};
use crate::config::Quality;
use crate::scene::Primitive;
use crate::simd::Simd;
use binary::{BuildContext, Subtree};
use collapse::BinaryTree;
use nodes::{BinaryNode, TreePosition};
use partition::Subset;
use reference::Reference;
use split_candidate::SplitContext;

/// Greatest number of primitives. 32 bits have to suffice to count the cache
/// lines of the arena, at worst ten per primitive, before it is known whether
/// they are few enough for a [`NodeRef`].
pub(super) const MAX_PRIMITIVES: usize = 1 << 28;

/// Upper bound of the cache lines of the arena per reference. Typical are less
/// than one, and 1.5 for shapes that are tested one by one.
const LINES_PER_REFERENCE: f64 = 2.0;

/// References that spatial splits may add per triangle.
const SPATIAL_SPLITS_PER_TRIANGLE: f64 = 0.5;

/// Greatest number of references per primitive.
fn references_per_primitive(quality: Quality) -> f64 {
    match quality {
        Quality::Fast => 1.0,
        Quality::Balanced => 1.0 + presplit::SPLITS_PER_TRIANGLE,
        Quality::High => 1.0 + SPATIAL_SPLITS_PER_TRIANGLE,
    }
}

/// Upper bound of the build's bytes per primitive: its index, its share of the
/// binary tree, and the larger of what the two steps need besides: memory for the
/// partition while the binary tree is built, the arena afterwards.
pub(super) fn bytes_per_primitive(quality: Quality) -> usize {
    let tree = (size_of::<BinaryNode>() + size_of::<Reference>()) as f64;
    let scratch = size_of::<Reference>() as f64;
    let arena = LINES_PER_REFERENCE * size_of::<CacheLine>() as f64;
    let per_reference = tree + scratch.max(arena);
    size_of::<u32>() + (references_per_primitive(quality) * per_reference).ceil() as usize
}

/// Upper bound of the cache lines of the arena per primitive.
pub(super) fn lines_per_primitive(quality: Quality) -> usize {
    (references_per_primitive(quality) * LINES_PER_REFERENCE).ceil() as usize
}

/// Builds the hierarchy over the primitives with these indices; without any, or if
/// the build was stopped, the arena is empty. Calls `report` with each finished share of the build, from
/// any thread; the shares add up to 1.
pub(super) fn arena(
    simd: Simd,
    primitives: &[Primitive],
    indices: Vec<u32>,
    quality: Quality,
    report: impl Fn(f64) + Sync,
) -> Result<Arena, TooLarge> {
    if indices.is_empty() {
        return Ok(Arena::default());
    }
    let Some(tree) = binary_tree(simd, primitives, indices, quality, report) else {
        return Ok(Arena::default());
    };
    let lines = emit::lines(simd, &tree, primitives)?;
    Ok(Arena::new(lines, tree.bounds(tree.root)))
}

/// A hierarchy has more cache lines than a node reference can address.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TooLarge {
    /// The memory that it would take.
    pub bytes: u64,
}

/// "the hierarchy would take 9.1 GiB, and 8 GiB is the most".
impl fmt::Display for TooLarge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let gib = |bytes: u64| bytes as f64 / f64::from(1 << 30);
        let most = (NodeRef::MAX_LINES * size_of::<CacheLine>()) as u64;
        let (bytes, most) = (gib(self.bytes), gib(most));
        write!(
            f,
            "the hierarchy would take {bytes:.1} GiB, and {most} GiB is the most"
        )
    }
}

impl std::error::Error for TooLarge {}

/// Builds the binary tree over these primitives; `None` if it was stopped.
fn binary_tree(
    simd: Simd,
    primitives: &[Primitive],
    indices: Vec<u32>,
    quality: Quality,
    report: impl Fn(f64) + Sync,
) -> Option<BinaryTree> {
    let (mut references, whole) = prepare(simd, primitives, indices, quality);
    let capacity = references.len();
    let mut nodes = bytemuck::zeroed_vec(capacity - 1);
    let context = BuildContext {
        split: SplitContext {
            primitives,
            simd,
            root_half_area: whole.bounds.half_area(),
        },
        report: |n_done: usize| report(n_done as f64 / capacity as f64),
    };
    let root = Subtree {
        subset: whole,
        depth: 0,
        references: &mut references,
        scratch: &mut bytemuck::zeroed_vec(capacity),
        stays: true,
        nodes: &mut nodes,
    };
    root.build(&context)?;
    Some(BinaryTree {
        nodes,
        references,
        root: TreePosition {
            node: 0,
            reference: 0,
            is_leaf: whole.n == 1,
        },
    })
}

/// The references to these primitives, presplit or with memory for spatial
/// splits, and the subset of all of them.
fn prepare(
    simd: Simd,
    primitives: &[Primitive],
    indices: Vec<u32>,
    quality: Quality,
) -> (Vec<Reference>, Subset) {
    let mut references: Vec<Reference> = indices
        .into_par_iter()
        .with_min_len(8192)
        .map(|index| Reference::new(&primitives[index as usize], index))
        .collect();
    let mut whole = Subset::of(simd, &references);
    match quality {
        Quality::Fast => {}
        Quality::Balanced => {
            references = presplit::presplit(references, primitives, &whole.bounds);
            whole = Subset::of(simd, &references);
        }
        Quality::High => {
            let n_triangles = references.iter().filter(|r| r.is_triangle()).count();
            let n_splits = (SPATIAL_SPLITS_PER_TRIANGLE * n_triangles as f64) as usize;
            references.resize(references.len() + n_splits, Reference::zeroed());
        }
    }
    (references, whole)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geometry::{Shape, Sphere, Triangle};
    use crate::sampling::uniform;
    use crate::scene::{MaterialId, ObjectId};

    /// Spheres and triangles, some of them much longer than the others.
    fn primitives() -> Vec<Primitive> {
        let shape = |i: u64| {
            let point = |corner| {
                let [x, y, z, w] = uniform([3, i, corner]);
                (Vec3::new(x, y, z), w)
            };
            let (center, w) = point(0);
            if i.is_multiple_of(5) {
                let radius = 0.01 * w;
                return Shape::Sphere(Sphere { center, radius });
            }
            let size = if i.is_multiple_of(7) { 0.5 } else { 0.02 };
            let vertices = [1, 2, 3].map(|corner| center + size * point(corner).0);
            Shape::Triangle(Triangle { vertices })
        };
        let primitive = |i| Primitive::new(shape(i), None, ObjectId(0), MaterialId(0));
        (0..20_000).map(primitive).collect()
    }

    #[test]
    fn every_instruction_set_builds_the_same_tree() {
        let primitives = primitives();
        for quality in [Quality::Fast, Quality::Balanced, Quality::High] {
            let build = |simd| {
                let indices = (0..primitives.len() as u32).collect();
                arena(simd, &primitives, indices, quality, |_| {}).unwrap()
            };
            let sets = Simd::available();
            for simd in &sets[1..] {
                assert!(build(*simd) == build(sets[0]), "{simd}, {quality}");
            }
        }
    }
}
