//! The collapsed tree → the cache lines of the arena.

use rayon::prelude::*;

use super::TooLarge;
use super::binary::{BinaryNode, BinaryNodeKind};
use super::collapse::{Forests, Roots, is_leaf};
use super::order;
use crate::accel::layout::{
    CacheLine, ID_BIT, LEAF_WINDOW_LINES, LeafKind, MAX_LEAF, NODE_LINES, NodeRef, WideNode,
};
use crate::geometry::Shape;
use crate::scene::Primitive;

/// Number of cache lines from which subtrees are written in parallel.
const PARALLEL: usize = 1 << 14;

/// The cache lines of the tree: the root first, and padding at the end, so that
/// a kernel may load a whole leaf window anywhere.
pub(super) fn lines(
    nodes: &[BinaryNode],
    whole: &Forests,
    primitives: &[Primitive],
) -> Result<Vec<CacheLine>, TooLarge> {
    let (mut roots, n_lines) = if is_leaf(&nodes[0]) {
        (Roots::alone(), NODE_LINES + whole.n_lines())
    } else {
        (Roots::below(nodes), whole.n_lines())
    };
    if n_lines > NodeRef::MAX_LINES {
        let bytes = (n_lines * size_of::<CacheLine>()) as u64;
        return Err(TooLarge { bytes });
    }
    let mut lines = bytemuck::zeroed_vec(n_lines + LEAF_WINDOW_LINES);
    write_node(nodes, primitives, &mut roots, &mut lines[..n_lines], 0);
    Ok(lines)
}

/// Writes a node and the subtree below it into `lines`, the first of which is
/// number `first_line` of the arena.
fn write_node(
    nodes: &[BinaryNode],
    primitives: &[Primitive],
    roots: &mut Roots,
    lines: &mut [CacheLine],
    first_line: u32,
) {
    let children = roots.indices();
    // By ascending size: an unordered traversal visits the last child first, and
    // a large one is the most likely to be hit.
    let area = |child: &usize| nodes[*child].bounds.surface_area();
    children.sort_by(|a, b| area(a).total_cmp(&area(b)));
    let n_lines = lines.len();
    let (own, mut rest) = lines.split_at_mut(NODE_LINES);
    let mut node = with_boxes(nodes, children);
    let mut line = first_line + NODE_LINES as u32;
    for (lane, &child) in children.iter().enumerate() {
        if is_leaf(&nodes[child]) {
            let lines = take(&mut rest, &nodes[child]);
            node.children[lane] = write_leaf(&nodes[child..], primitives, lines, line).0;
            line += nodes[child].n_lines;
        }
    }
    let mut subtrees = [const { None }; 8];
    for (lane, &child) in children.iter().enumerate() {
        if !is_leaf(&nodes[child]) {
            node.children[lane] = NodeRef::node(line).0;
            subtrees[lane] = Some((&nodes[child..], take(&mut rest, &nodes[child]), line));
            line += nodes[child].n_lines;
        }
    }
    let write = |(nodes, lines, line)| {
        write_node(nodes, primitives, &mut Roots::below(nodes), lines, line);
    };
    if n_lines < PARALLEL {
        subtrees.into_iter().flatten().for_each(write);
    } else {
        subtrees.into_par_iter().flatten().for_each(write);
    }
    own.copy_from_slice(bytemuck::cast_slice(&[node]));
}

/// A node with the boxes and the order of these children, but no references.
fn with_boxes(nodes: &[BinaryNode], children: &[usize]) -> WideNode {
    let mut node = WideNode::EMPTY;
    for (lane, &child) in children.iter().enumerate() {
        let bounds = &nodes[child].bounds;
        for axis in 0..3 {
            node.min[axis][lane] = bounds.min[axis];
            node.max[axis][lane] = bounds.max[axis];
        }
    }
    node.order = order::by_octant(&node);
    node
}

/// Splits the subtree's lines off the front of `rest`.
fn take<'a>(rest: &mut &'a mut [CacheLine], subtree: &BinaryNode) -> &'a mut [CacheLine] {
    rest.split_off_mut(..subtree.n_lines as usize)
        .expect("the lines were counted")
}

/// Writes a leaf with all primitives of a subtree.
fn write_leaf(
    nodes: &[BinaryNode],
    primitives: &[Primitive],
    lines: &mut [CacheLine],
    line: u32,
) -> NodeRef {
    let mut indices = [0; MAX_LEAF];
    let mut n = 0;
    let kind = gather(nodes, &mut indices, &mut n);
    indices[..n].sort_unstable();
    let n = dedup(&mut indices[..n]);
    let indices = &indices[..n];
    let numbers: &mut [f32] = bytemuck::cast_slice_mut(lines);
    let mut n_rows = 0;
    for (lane, &index) in indices.iter().enumerate() {
        let mut write = |rows: &[f32]| {
            n_rows = rows.len();
            for (row, &number) in rows.iter().enumerate() {
                numbers[row * n + lane] = number;
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
            _ => {}
        }
    }
    for (lane, &index) in indices.iter().enumerate() {
        numbers[n_rows * n + lane] = f32::from_bits(index | ID_BIT);
    }
    NodeRef::leaf(kind, n, line)
}

/// Removes duplicates from ascending numbers; returns how many are left. (A leaf
/// may get several parts of a primitive that was split.)
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

/// Collects the primitives of a subtree, all of the same kind, which it
/// returns.
fn gather(nodes: &[BinaryNode], indices: &mut [u32; MAX_LEAF], n: &mut usize) -> LeafKind {
    match nodes[0].kind() {
        BinaryNodeKind::Leaf { primitive, kind } => {
            indices[*n] = primitive;
            *n += 1;
            kind
        }
        BinaryNodeKind::Inner { second } => {
            gather(&nodes[1..], indices, n);
            gather(&nodes[second..], indices, n)
        }
    }
}
