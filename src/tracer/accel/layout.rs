//! The memory layout of the hierarchy: an arena of cache lines.
//!
//! A node is four cache lines: the boxes of up to eight children as six rows of eight numbers, and
//! a [`NodeRef`] per child. The leaves of a node follow it, then the nodes below it, in depth-first
//! order.
//!
//! A leaf of `n` primitives is a block of rows of `n` numbers: for triangles the coordinates of the
//! three vertices, for spheres the coordinates of the center and the squared radius; then the
//! indices of the primitives, ascending. A leaf of capsules has the indices first, then the
//! coordinates of both ends and the radii. A load of eight lanes reads a row and the numbers after
//! it, so the lanes from `n` on are meaningless. None of them is subnormal, which would slow down
//! arithmetic: hence [`ID_BIT`].

use arrayvec::ArrayVec;
use bytemuck::{Pod, Zeroable};

use math::simd::N_LANES;
use world::geometry::Shape;
use world::scene::Primitive;

/// A cache line.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct CacheLine([f32; 16]);

/// Cache lines of a [`WideNode`].
pub(super) const NODE_LINES: usize = size_of::<WideNode>() / size_of::<CacheLine>();
/// Cache lines that may be read from the start of each leaf on; the largest leaf has five.
pub(super) const LEAF_WINDOW_LINES: usize = 9;
/// Numbers in that window.
pub(super) const LEAF_WINDOW: usize = LEAF_WINDOW_LINES * 16;
/// Greatest depth of a node; the root has depth 0.
pub(super) const MAX_DEPTH: usize = 64;
/// Greatest number of primitives in a leaf.
pub(super) const MAX_LEAF: usize = N_LANES;
/// Rows of a triangle leaf before the indices.
pub(super) const TRIANGLE_ROWS: usize = 9;
/// Rows of a sphere leaf before the indices.
pub(super) const SPHERE_ROWS: usize = 4;
/// Rows of a capsule leaf after the indices.
pub(super) const CAPSULE_ROWS: usize = 8;
/// Set in the indices of leaves of capsules: a reference has no room for a fourth kind.
pub const CAPSULE_BIT: u32 = 1 << 29;
/// Set in the indices of leaves, which makes them normal as floating-point numbers.
pub const ID_BIT: u32 = 1 << 30;

/// A node: the boxes of up to eight children. Missing children have empty boxes.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct WideNode {
    /// Least coordinates of the children's boxes, one row per axis.
    pub(super) min: [[f32; N_LANES]; 3],
    /// Greatest coordinates of the children's boxes, one row per axis.
    pub(super) max: [[f32; N_LANES]; 3],
    /// The children, as the bits of [`NodeRef`]s.
    pub(super) children: [u32; N_LANES],
    /// The children sorted from far to near, for each octant of ray directions: the three bits from
    /// `3 * octant` on of entry `i` are the lane of child number `i` in that order.
    pub(super) order: [u32; N_LANES],
}

impl WideNode {
    /// A node without children: no ray enters its boxes.
    pub(super) const EMPTY: Self = Self {
        min: [[f32::INFINITY; N_LANES]; 3],
        max: [[f32::NEG_INFINITY; N_LANES]; 3],
        children: [0; N_LANES],
        order: [0; N_LANES],
    };

    /// Returns the row of coordinates that starts at number `start`: `min` has rows 0, 8 and 16,
    /// `max` has rows 24, 32 and 40.
    #[inline(always)]
    pub(super) fn row(&self, start: usize) -> &[f32; N_LANES] {
        let numbers: &[f32; 64] = bytemuck::cast_ref(self);
        // The mask changes nothing and avoids a bounds check.
        let row = numbers[start & 56..].first_chunk();
        row.expect("eight numbers follow the last multiple of eight")
    }

    /// Returns the number of children.
    pub(super) fn n_children(&self) -> usize {
        self.min[0].iter().take_while(|min| min.is_finite()).count()
    }
}

/// The kind of primitives in a leaf.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LeafKind {
    /// Triangles, all tested at once.
    Triangles = 1,
    /// Spheres, all tested at once.
    Spheres = 2,
    /// Any other shapes, tested one by one.
    Others = 3,
    /// Capsules, all tested at once.
    Capsules = 4,
}

impl LeafKind {
    /// Returns the kind of leaf for a primitive.
    pub(super) fn new(primitive: &Primitive) -> Self {
        match primitive.world_shape() {
            Some(Shape::Triangle(_)) => Self::Triangles,
            Some(Shape::Sphere(_)) => Self::Spheres,
            Some(Shape::Capsule(_)) => Self::Capsules,
            _ => Self::Others,
        }
    }

    /// Returns the kind with this number.
    #[inline(always)]
    pub(super) fn from_number(number: u32) -> Option<Self> {
        match number {
            1 => Some(Self::Triangles),
            2 => Some(Self::Spheres),
            3 => Some(Self::Others),
            4 => Some(Self::Capsules),
            _ => None,
        }
    }

    /// Returns the kind of a leaf, given its reference and its first number.
    #[inline(always)]
    pub(super) fn from_leaf(node_ref: NodeRef, first: f32) -> Self {
        match node_ref.0 & 3 {
            1 => Self::Triangles,
            2 => Self::Spheres,
            _ if first.to_bits() & CAPSULE_BIT != 0 => Self::Capsules,
            _ => Self::Others,
        }
    }

    /// Returns true if all primitives of the leaf are tested at once.
    #[inline(always)]
    pub(super) fn is_tested_at_once(self) -> bool {
        self != Self::Others
    }

    /// Returns the number of rows before the indices.
    #[inline(always)]
    pub(super) fn n_rows(self) -> usize {
        match self {
            Self::Triangles => TRIANGLE_ROWS,
            Self::Spheres => SPHERE_ROWS,
            Self::Capsules | Self::Others => 0,
        }
    }

    /// Returns the number of cache lines of a leaf of `n` primitives.
    pub(super) fn n_lines(self, n: usize) -> usize {
        let len = match self {
            Self::Triangles => (TRIANGLE_ROWS + 1) * n,
            // Eight lanes load the last row: they must not read past the leaf.
            Self::Spheres => ((SPHERE_ROWS + 1) * n).max((SPHERE_ROWS - 1) * n + N_LANES),
            Self::Capsules => (CAPSULE_ROWS + 1) * n + N_LANES - n,
            Self::Others => n,
        };
        len.div_ceil(16)
    }
}

/// A reference to a node, or to a leaf with its kind and size. From the top: 27 bits for the index
/// of its first cache line, 3 bits for the size of a leaf minus one, 2 bits for its kind (0 for a
/// node, 3 for capsules too). So twice the reference to a node is the number of bytes before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct NodeRef(pub(super) u32);

impl NodeRef {
    /// The root.
    pub(super) const ROOT: Self = Self(0);
    /// Number of cache lines that a reference can address: 8 GiB.
    pub(super) const MAX_LINES: usize = 1 << 27;

    /// The sentinel for a finished traversal: a leaf at the address of the root. The address is
    /// valid because the kernel prefetches it; a prefetch of unmapped memory is slow.
    pub(super) const END: Self = Self(LeafKind::Others as u32);

    /// Returns a reference to the node at this line.
    pub(super) fn node(line: u32) -> Self {
        Self(line << 5)
    }

    /// Returns a reference to the leaf of `n` primitives at this line.
    pub(super) fn leaf(kind: LeafKind, n: usize, line: u32) -> Self {
        let kind = (kind as u32).min(LeafKind::Others as u32);
        Self(line << 5 | (n as u32 - 1) << 2 | kind)
    }

    /// Returns true if this refers to a leaf.
    #[inline(always)]
    pub(super) fn is_leaf(self) -> bool {
        self.0 & 3 != 0
    }

    /// Returns the number of primitives in the leaf, from 1 to 8.
    #[inline(always)]
    pub(super) fn leaf_size(self) -> usize {
        (self.0 >> 2 & 7) as usize + 1
    }

    /// Returns the index of the first cache line.
    #[inline(always)]
    pub(super) fn line(self) -> usize {
        (self.0 >> 5) as usize
    }
}

/// Returns the kind of the leaf of a reference, with bounds checks.
pub(super) fn leaf_kind(lines: &[CacheLine], node_ref: NodeRef) -> LeafKind {
    let CacheLine([first, ..]) = lines[node_ref.line()];
    LeafKind::from_leaf(node_ref, first)
}

/// Returns the kind and the indices of the primitives of a leaf that starts with these numbers.
pub(super) fn contents(leaf: NodeRef, numbers: &[f32]) -> (LeafKind, ArrayVec<u32, MAX_LEAF>) {
    let kind = LeafKind::from_leaf(leaf, numbers[0]);
    let n = leaf.leaf_size();
    let ids = &numbers[kind.n_rows() * n..][..n];
    let index = |id: &f32| id.to_bits() & !(ID_BIT | CAPSULE_BIT);
    (kind, ids.iter().map(index).collect())
}

/// Returns the node of a reference, with bounds checks.
pub(super) fn node(lines: &[CacheLine], node_ref: NodeRef) -> &WideNode {
    let lines = lines[node_ref.line()..].first_chunk::<NODE_LINES>();
    bytemuck::cast_ref(lines.expect("nodes lie within the lines"))
}
