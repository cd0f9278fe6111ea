//! The collapsed tree → the cache lines of the arena.

use arrayvec::ArrayVec;
use bytemuck::Zeroable;
use rayon::prelude::*;

use super::TooLarge;
use super::collapse::{BinaryTree, Roots};
use super::nodes::TreePosition;
use super::order;
use super::reference::Reference;
use crate::accel::Quality;
use crate::accel::layout::{
    CAPSULE_BIT, CAPSULE_ROWS, CacheLine, ID_BIT, LEAF_WINDOW_LINES, LeafKind, MAX_LEAF,
    NODE_LINES, NodeRef, WideNode,
};
use math::simd::{InstructionSet, N_LANES, Simd, SimdKernel};
use world::geometry::{Aabb, Project, Shape};
use world::scene::Primitive;

/// Number of cache lines from which subtrees are written in parallel.
pub(super) const PARALLEL: usize = 1 << 14;

/// Writes the cache lines of the tree: the root first, and padding at the end, so that a kernel may
/// load a whole leaf window anywhere. Reuses `lines`, whose contents are arbitrary, or allocates if
/// they do not suffice.
pub(super) fn lines(
    simd: Simd,
    tree: &BinaryTree,
    primitives: &[Primitive],
    quality: Quality,
    mut lines: Vec<CacheLine>,
) -> Result<Vec<CacheLine>, TooLarge> {
    let n_lines = tree.n_lines(tree.root);
    // The root is always a node: a tree that is one leaf becomes its only child.
    let (roots, n_lines) = if tree.leaf(tree.root).is_some() {
        (Roots::alone(tree.root), NODE_LINES + n_lines)
    } else {
        (Roots::below(tree, tree.root), n_lines)
    };
    if n_lines > NodeRef::MAX_LINES {
        let bytes = (n_lines * size_of::<CacheLine>()) as u64;
        return Err(TooLarge { bytes });
    }
    // Reuse the memory, or allocate it.
    let n_padded = n_lines + LEAF_WINDOW_LINES;
    if n_padded > lines.capacity() {
        drop(lines);
        lines = Vec::new();
    }
    lines.truncate(n_lines);
    extend(&mut lines, n_padded);
    let writer = Writer {
        simd,
        tree,
        primitives,
        quality,
    };
    writer.write_node(&roots, &mut lines[..n_lines], 0);
    Ok(lines)
}

/// Appends zeros until there are `n` lines, in parallel: new memory is mapped page by page.
pub(super) fn extend(lines: &mut Vec<CacheLine>, n: usize) {
    let n_new = n.saturating_sub(lines.len());
    lines.par_extend(rayon::iter::repeat_n(CacheLine::zeroed(), n_new));
}

/// Writes nodes and leaves.
struct Writer<'a> {
    simd: Simd,
    tree: &'a BinaryTree,
    primitives: &'a [Primitive],
    quality: Quality,
}

impl Writer<'_> {
    /// Writes a node and the subtree below it into `lines`, the first of which is line `first_line`
    /// of the arena.
    fn write_node(&self, roots: &Roots, lines: &mut [CacheLine], first_line: usize) {
        let tree = self.tree;
        // Make the node, without references to its children.
        let (mut node, children) = self.simd.run(MakeNode {
            writer: self,
            subtrees: roots.positions(),
        });
        // Lay out the lines: the node, its leaves, then its subtrees.
        let n_lines = lines.len();
        let (own, mut rest) = lines.split_at_mut(NODE_LINES);
        let mut line = first_line + NODE_LINES;
        let mut take = |subtree: TreePosition| {
            let n_lines = tree.n_lines(subtree);
            let first_line = line;
            line += n_lines;
            let lines = rest.split_off_mut(..n_lines);
            (lines.expect("the lines were counted"), first_line)
        };
        // Write the leaves.
        for (lane, &child) in children.iter().enumerate() {
            if let Some(leaf) = tree.leaf(child) {
                let (lines, line) = take(child);
                node.children[lane] = write_references(leaf, self.primitives, lines, line).0;
            }
        }
        // Reserve lines for the subtrees and refer to them.
        let mut subtrees = [const { None }; 8];
        for (lane, &child) in children.iter().enumerate() {
            if tree.leaf(child).is_none() {
                let (lines, line) = take(child);
                node.children[lane] = NodeRef::node(line as u32).0;
                subtrees[lane] = Some((child, lines, line));
            }
        }
        // Write the node, then its subtrees, large ones in parallel.
        own.copy_from_slice(bytemuck::cast_slice(&[node]));
        let write = |(subtree, lines, line)| {
            self.write_node(&Roots::below(tree, subtree), lines, line);
        };
        if n_lines < PARALLEL {
            subtrees.into_iter().flatten().for_each(write);
        } else {
            subtrees.into_par_iter().flatten().for_each(write);
        }
    }

    /// Returns the rank of a subtree: unordered traversals visit the highest one of a node first.
    #[inline(always)]
    fn rank(&self, subtree: TreePosition, bounds: &Aabb) -> f32 {
        // A large box is the most likely to be hit.
        let area = bounds.surface_area();
        if self.quality != Quality::High {
            return area;
        }
        // Likely to end the search, for little cost (Ize and Hansen, "RTSAH Traversal Order for
        // Occlusion Rays", 2011). A box without area has a cost of NaN.
        let cost = self.tree.cost(subtree) / area;
        area / cost.max(f32::MIN_POSITIVE)
    }
}

/// Makes a node with the boxes of these subtrees and their order, but without references to them.
struct MakeNode<'a> {
    writer: &'a Writer<'a>,
    subtrees: &'a [TreePosition],
}

impl SimdKernel for MakeNode<'_> {
    /// The node, and the subtrees in the order of its lanes.
    type Output = (WideNode, ArrayVec<TreePosition, N_LANES>);

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) -> Self::Output {
        let writer = self.writer;
        let Writer {
            tree, primitives, ..
        } = writer;
        // Prefetch the primitives, which are read when the leaves are written.
        for &subtree in self.subtrees {
            for reference in tree.leaf(subtree).unwrap_or_default() {
                // Most are in two cache lines.
                let primitive = &raw const primitives[reference.primitive() as usize];
                set.prefetch(primitive);
                set.prefetch(primitive.wrapping_add(1).cast::<u8>().wrapping_sub(1));
            }
        }
        let mut children = ArrayVec::<(f32, Aabb, TreePosition), N_LANES>::new();
        for &subtree in self.subtrees {
            let bounds = tree.bounds(subtree);
            children.push((writer.rank(subtree, &bounds), bounds, subtree));
        }
        // An unordered traversal visits the last child first.
        children.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Write the boxes, then the orders of visits.
        let mut node = WideNode::EMPTY;
        for (lane, (_, bounds, _)) in children.iter().enumerate() {
            for axis in 0..3 {
                node.min[axis][lane] = bounds.min[axis];
                node.max[axis][lane] = bounds.max[axis];
            }
        }
        node.order = order::by_octant(set, &node);
        let children = children.into_iter().map(|(_, _, child)| child);
        (node, children.collect())
    }
}

/// Writes a leaf with these references into `lines`, the first of which is line `line` of the
/// arena.
fn write_references(
    references: &[Reference],
    primitives: &[Primitive],
    lines: &mut [CacheLine],
    line: usize,
) -> NodeRef {
    let mut indices = [0; MAX_LEAF];
    for (index, reference) in indices.iter_mut().zip(references) {
        *index = reference.primitive();
    }
    // Sort the primitives; drop duplicates, parts of a primitive that was split.
    indices[..references.len()].sort_unstable();
    let n = dedup(&mut indices[..references.len()]);
    let kind = references[0].kind();
    write_leaf(kind, &indices[..n], primitives, lines);
    NodeRef::leaf(kind, n, line as u32)
}

/// Writes a leaf with the primitives of these indices, which ascend, into its lines.
pub(super) fn write_leaf(
    kind: LeafKind,
    indices: &[u32],
    primitives: &[Primitive],
    lines: &mut [CacheLine],
) {
    let n = indices.len();
    let numbers: &mut [f32] = bytemuck::cast_slice_mut(lines);
    let mut end = n;
    // Write the coordinates as rows, one primitive per column.
    for (lane, &index) in indices.iter().enumerate() {
        let n_before = if kind == LeafKind::Capsules { 1 } else { 0 };
        let mut write = |rows: &[f32]| {
            end = (rows.len() + 1) * n;
            for (row, &number) in rows.iter().enumerate() {
                numbers[(n_before + row) * n + lane] = number;
            }
        };
        match (kind, primitives[index as usize].world_shape()) {
            (LeafKind::Triangles, Some(Shape::Triangle(triangle))) => {
                write(bytemuck::cast_slice(&triangle.vertices));
            }
            (LeafKind::Spheres, Some(Shape::Sphere(sphere))) => {
                let [x, y, z] = sphere.center.into();
                write(&[x, y, z, sphere.radius * sphere.radius]);
            }
            (LeafKind::Capsules, Some(Shape::Capsule(capsule))) => {
                write(&capsule.parameters()[..CAPSULE_ROWS]);
            }
            _ => {}
        }
    }
    // Write the row of indices, and clear the rest.
    let mark = match kind {
        LeafKind::Capsules => ID_BIT | CAPSULE_BIT,
        _ => ID_BIT,
    };
    for (id, index) in numbers[kind.n_rows() * n..].iter_mut().zip(indices) {
        *id = f32::from_bits(index | mark);
    }
    numbers[end..].fill(0.0);
}

/// Removes duplicates from ascending numbers. Returns how many are left. (A leaf may get several
/// parts of a primitive that was split.)
fn dedup(numbers: &mut [u32]) -> usize {
    let mut n = 0;
    for i in 0..numbers.len() {
        if n == 0 || numbers[n - 1] != numbers[i] {
            numbers[n] = numbers[i];
            n += 1;
        }
    }
    n
}
