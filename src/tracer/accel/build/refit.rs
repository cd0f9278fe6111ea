//! Refitting a hierarchy to primitives that have moved.
//!
//! The nodes keep their children and the leaves their primitives; only boxes, their order and the
//! coordinates in leaves change (Lauterbach, Yoon, Tuft, Manocha: "RT-DEFORM: Interactive Ray
//! Tracing of Dynamic Scenes using BVHs", 2006). All hits are found; a ray visits more nodes the
//! farther the primitives have moved apart. A triangle that was split has its whole box in each of
//! its leaves.

use arrayvec::ArrayVec;
use rayon::prelude::*;

use super::emit::{PARALLEL, write_leaf};
use super::order;
use super::reference::box_of;
use crate::accel::arena::Arena;
use crate::accel::layout::{self, CacheLine, LeafKind, NODE_LINES, NodeRef, WideNode};
use math::simd::{InstructionSet, N_LANES, Simd, SimdKernel};
use world::geometry::{Aabb, Shape};
use world::scene::Primitive;

/// Returns the hierarchy of an arena refitted to the same number of primitives, or `None` if a leaf
/// would have primitives of other kinds.
pub(in crate::accel) fn refitted(
    simd: Simd,
    arena: &Arena,
    primitives: &[Primitive],
) -> Option<Arena> {
    let mut lines = arena.lines().to_vec();
    if lines.is_empty() {
        return Some(Arena::default());
    }
    let bounds = Refitter { simd, primitives }.node(&mut lines, 0)?;
    Some(Arena::new(lines, bounds))
}

/// Returns true if all leaves have triangles that equal the primitives, bit for bit.
pub(in crate::accel) fn has_triangles(arena: &Arena, primitives: &[Primitive]) -> bool {
    let lines = arena.lines();
    lines.is_empty() || are_in_leaves(lines, NodeRef::ROOT, primitives)
}

fn are_in_leaves(lines: &[CacheLine], node_ref: NodeRef, primitives: &[Primitive]) -> bool {
    let node = layout::node(lines, node_ref);
    node.children[..node.n_children()].iter().all(|&child| {
        let child = NodeRef(child);
        if !child.is_leaf() {
            return are_in_leaves(lines, child, primitives);
        }
        let leaf: &[f32] = bytemuck::cast_slice(&lines[child.line()..]);
        let (kind, indices) = layout::contents(child, leaf);
        let n = indices.len();
        kind == LeafKind::Triangles
            && indices.iter().enumerate().all(|(lane, &index)| {
                let shape = primitives[index as usize].world_shape();
                let Some(Shape::Triangle(triangle)) = shape else {
                    return false;
                };
                let rows: &[f32] = bytemuck::cast_slice(&triangle.vertices);
                let is_same = |(row, number): (usize, &f32)| {
                    leaf[row * n + lane].to_bits() == number.to_bits()
                };
                rows.iter().enumerate().all(is_same)
            })
    })
}

struct Refitter<'a> {
    simd: Simd,
    primitives: &'a [Primitive],
}

impl Refitter<'_> {
    /// Refits the node at the start of `lines`, the first of which is line `first_line` of the
    /// arena, and the subtree below it. Returns its box.
    fn node(&self, lines: &mut [CacheLine], first_line: usize) -> Option<Aabb> {
        let n_lines = lines.len();
        let mut node = *layout::node(lines, NodeRef::ROOT);
        let children: ArrayVec<NodeRef, N_LANES> = node.children[..node.n_children()]
            .iter()
            .map(|&child| NodeRef(child))
            .collect();
        let mut bounds = [Some(Aabb::EMPTY); N_LANES];
        let mut subtrees = [const { None }; N_LANES];
        let mut rest = lines;
        // Divide the lines: subtrees follow the leaves, in the order of the lanes.
        for (lane, (child, bounds)) in children.iter().zip(&mut bounds).enumerate().rev() {
            if !child.is_leaf() {
                let subtree = rest.split_off_mut(child.line() - first_line..)?;
                subtrees[lane] = Some((subtree, child.line(), bounds));
            }
        }
        // Refit the subtrees, large ones in parallel.
        let refit = |subtree: (&mut [CacheLine], usize, &mut Option<Aabb>)| {
            let (lines, first_line, bounds) = subtree;
            *bounds = self.node(lines, first_line);
        };
        if n_lines < PARALLEL {
            subtrees.into_iter().flatten().for_each(refit);
        } else {
            subtrees.into_par_iter().flatten().for_each(refit);
        }
        // Refit the leaves.
        for (child, bounds) in children.iter().zip(&mut bounds) {
            if child.is_leaf() {
                *bounds = self.leaf(*child, &mut rest[child.line() - first_line..]);
            }
        }
        // Write the boxes of the children and their order.
        let mut all = Aabb::EMPTY;
        for (lane, bounds) in bounds.into_iter().take(children.len()).enumerate() {
            let bounds = bounds?;
            all = all.union(bounds);
            for axis in 0..3 {
                node.min[axis][lane] = bounds.min[axis];
                node.max[axis][lane] = bounds.max[axis];
            }
        }
        node.order = self.simd.run(NodeOrder(&node));
        rest[..NODE_LINES].copy_from_slice(bytemuck::cast_slice(&[node]));
        Some(all)
    }

    /// Refits the leaf at the start of `lines`. Returns its box, or `None` if a primitive has
    /// another kind.
    fn leaf(&self, leaf: NodeRef, lines: &mut [CacheLine]) -> Option<Aabb> {
        let (kind, indices) = layout::contents(leaf, bytemuck::cast_slice(lines));
        let mut all = Aabb::EMPTY;
        for &index in &indices {
            let primitive = &self.primitives[index as usize];
            if LeafKind::new(primitive) != kind {
                return None;
            }
            all = all.union(box_of(primitive));
        }
        let n_lines = kind.n_lines(indices.len());
        write_leaf(kind, &indices, self.primitives, &mut lines[..n_lines]);
        Some(all)
    }
}

/// Computes the order of the children of a node.
struct NodeOrder<'a>(&'a WideNode);

impl SimdKernel for NodeOrder<'_> {
    type Output = [u32; N_LANES];

    #[inline(always)]
    fn run<I: InstructionSet>(self, set: I) -> Self::Output {
        order::by_octant(set, self.0)
    }
}
