//! Primitives → the arena of a hierarchy.
//!
//! Two steps: a binary tree over `reference`s to primitives, one per leaf (`binary`), with the
//! choices that lead to the optimal tree of eight-wide nodes and leaves (`forests`); then the cache
//! lines of that tree (`collapse`, `emit`).
//!
//! `split_candidate` chooses how to split a node of the binary tree, by the surface area heuristic:
//! by the centers of whole references (`object_split`) or, with quality `high`, by a plane that
//! splits triangles (`spatial_split`). `partition` moves the references. With quality `balanced`
//! the worst triangles are split beforehand (`presplit`).
//!
//! The build runs in parallel on disjoint slices of memory, with all threads from the first split
//! on; each thread builds its subtrees in lanes (`simd`). No decision depends on the number of
//! threads or on the instruction set.

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
mod prepare;
mod forests;
mod nodes;
mod few;
mod binary;
mod collapse;
mod order;
mod emit;
mod refit;

use std::fmt;

use super::arena::Arena;
use super::layout::{CacheLine, NodeRef};
use crate::accel::Quality;
use binary::{BuildContext, Subtree};
use collapse::BinaryTree;
use math::simd::Simd;
use nodes::{BinaryNode, TreePosition};
use partition::Subset;
use prepare::references_per_primitive;
use reference::Reference;
pub(super) use refit::{has_triangles, refitted};
use split_candidate::SplitContext;
use world::scene::Primitive;

/// Greatest number of primitives. 32 bits have to suffice to count the cache lines of the arena, at
/// worst ten per primitive, before it is known if a [`NodeRef`] can address them.
pub(super) const MAX_PRIMITIVES: usize = 1 << 28;

/// Cache lines of the arena per reference, measured; 1.5 for shapes that are tested one by one.
const LINES_PER_REFERENCE: f64 = 0.75;

/// Cache lines that the build reserves per reference.
const RESERVED_LINES_PER_REFERENCE: usize = 1;

/// Returns the expected bytes per primitive of the arena, which serves as memory for the partition
/// until it is written, and of the binary tree, which is free after the build.
pub(super) fn bytes_per_primitive(quality: Quality) -> [usize; 2] {
    let tree = references_per_primitive(quality)
        * (size_of::<BinaryNode>() + size_of::<Reference>()) as f64;
    let arena = lines_per_primitive(quality) * size_of::<CacheLine>() as f64;
    [arena, tree].map(|n_bytes| n_bytes.ceil() as usize)
}

/// Returns the expected cache lines of the arena per primitive.
pub(super) fn lines_per_primitive(quality: Quality) -> f64 {
    references_per_primitive(quality) * LINES_PER_REFERENCE
}

/// Builds the hierarchy over all primitives except the `unbounded`, whose indices ascend. The arena
/// is empty if all primitives are unbounded or the build was stopped. Calls `report` with each
/// finished share of the build, from any thread; the shares add up to 1.
pub(super) fn arena(
    simd: Simd,
    primitives: &[Primitive],
    unbounded: &[u32],
    quality: Quality,
    report: impl Fn(f64) + Sync,
) -> Result<Arena, TooLarge> {
    // Make references to the primitives, splitting the worst triangles.
    let (references, whole) = prepare::references(simd, primitives, unbounded, quality);
    if references.is_empty() {
        return Ok(Arena::default());
    }
    // Build the binary tree.
    let split = SplitContext { primitives, simd };
    // The arena's memory serves the partition first.
    let mut lines = Vec::with_capacity(RESERVED_LINES_PER_REFERENCE * references.len());
    emit::extend(&mut lines, references.len().div_ceil(2));
    let Some(tree) = binary_tree(split, references, whole, &mut lines, report) else {
        return Ok(Arena::default());
    };
    // Write the collapsed tree as cache lines.
    let lines = emit::lines(simd, &tree, primitives, quality, lines)?;
    let bounds = tree.bounds(tree.root);
    let (arena, ()) = rayon::join(|| Arena::new(lines, bounds), || drop(tree));
    Ok(arena)
}

/// Error: a hierarchy has more cache lines than a node reference can address.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TooLarge {
    /// Bytes that the hierarchy would take.
    pub bytes: u64,
}

/// Prints "the hierarchy would take 9.1 GiB, and 8 GiB is the most".
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

/// Builds the binary tree over these references. Returns `None` if the build was stopped. `scratch`
/// has at least half as many lines as there are references; its contents change.
fn binary_tree(
    split: SplitContext,
    mut references: Vec<Reference>,
    whole: Subset,
    scratch: &mut [CacheLine],
    report: impl Fn(f64) + Sync,
) -> Option<BinaryTree> {
    let capacity = references.len();
    let mut nodes = bytemuck::zeroed_vec(capacity - 1);
    let context = BuildContext {
        split,
        report: |n_done: usize| report(n_done as f64 / capacity as f64),
    };
    let root = Subtree {
        subset: whole,
        depth: 0,
        references: &mut references,
        scratch: &mut bytemuck::cast_slice_mut(scratch)[..capacity],
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

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use math::sampling::uniform;
    use world::geometry::{Shape, Sphere, Triangle};
    use world::scene::{MaterialId, ObjectId};

    /// Returns spheres and triangles, some of them much longer than the others.
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
        // Enough to move them in parallel.
        (0..40_000).map(primitive).collect()
    }

    #[test]
    fn every_instruction_set_builds_the_same_tree() {
        let primitives = primitives();
        for quality in [Quality::Fast, Quality::Balanced, Quality::High] {
            let build = |simd| arena(simd, &primitives, &[], quality, |_| {}).unwrap();
            let sets = Simd::available();
            for simd in &sets[1..] {
                assert!(build(*simd) == build(sets[0]), "{simd}, {quality:?}");
            }
        }
    }
}
