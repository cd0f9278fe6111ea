//! How the hierarchy lies in memory: an arena of cache lines.
//!
//! A node is four lines: the boxes of up to eight children as six rows of
//! eight numbers, and a [`Word`] for each child. After the node come its
//! leaves, then the nodes below it, depth first.
//!
//! A leaf of `n` primitives is a block of rows of `n` numbers: for triangles
//! the coordinates of the three corners, for spheres
//! those of the centre and the squared radius; then the primitives' indices,
//! ascending. Eight lanes load a row in one go and what follows it with it, so
//! that lanes from `n` on hold numbers of no meaning. None of them is
//! subnormal, which would slow down arithmetic: hence [`ID_BIT`].

use bytemuck::{Pod, Zeroable};

use super::simd::N_LANES;
use crate::geometry::Shape;
use crate::scene::Primitive;

/// A cache line.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct Line([f32; 16]);

/// Lines of a [`Node`].
pub(super) const NODE_LINES: usize = size_of::<Node>() / size_of::<Line>();
/// Lines that are there from the start of each leaf; the largest has five.
pub(super) const LEAF_WINDOW_LINES: usize = 9;
/// Numbers in those lines.
pub(super) const LEAF_WINDOW: usize = LEAF_WINDOW_LINES * 16;
/// Most primitives in a leaf.
pub(super) const MAX_LEAF: usize = N_LANES;
/// Rows of a triangle leaf before the indices.
pub(super) const TRIANGLE_ROWS: usize = 9;
/// Rows of a sphere leaf before the indices.
pub(super) const SPHERE_ROWS: usize = 4;
/// Set in the indices of leaves: read as a number they are then normal.
pub(super) const ID_BIT: u32 = 1 << 30;

/// Up to eight boxes; those that are not there are empty.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Least coordinates of the children, a row for each axis.
    pub(super) min: [[f32; N_LANES]; 3],
    /// Greatest coordinates of the children, a row for each axis.
    pub(super) max: [[f32; N_LANES]; 3],
    /// What the children are, as [`Word`]s.
    pub(super) children: [u32; N_LANES],
    /// In bits `3 * octant..` of entry `i`: the child that comes at place `i`
    /// for rays into that octant, the farthest first.
    pub(super) order: [u32; N_LANES],
}

impl Node {
    /// No child at all: boxes that no ray enters.
    pub(super) const EMPTY: Self = Self {
        min: [[f32::INFINITY; N_LANES]; 3],
        max: [[f32::NEG_INFINITY; N_LANES]; 3],
        children: [0; N_LANES],
        order: [0; N_LANES],
    };

    /// The row of the boxes' coordinates that begins at number `start`: from 0
    /// to 16 those of `min`, from 24 to 40 those of `max`.
    #[inline(always)]
    pub(super) fn row(&self, start: usize) -> &[f32; N_LANES] {
        let numbers: &[f32; 64] = bytemuck::cast_ref(self);
        // The mask changes nothing, and spares a check.
        let row = numbers[start & 56..].first_chunk();
        row.expect("eight numbers follow the last multiple of eight")
    }

    /// The number of children.
    pub(super) fn n_children(&self) -> usize {
        self.min[0].iter().take_while(|min| min.is_finite()).count()
    }
}

/// What kind of primitives a leaf holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LeafKind {
    /// Triangles, tested together.
    Triangles = 1,
    /// Spheres, tested together.
    Spheres = 2,
    /// Anything, tested one by one.
    Others = 3,
}

impl LeafKind {
    /// The kind of leaf for a primitive.
    pub(super) fn of(primitive: &Primitive) -> Self {
        match primitive.world_shape() {
            Some(Shape::Triangle(_)) => Self::Triangles,
            Some(Shape::Sphere(_)) => Self::Spheres,
            _ => Self::Others,
        }
    }

    /// The kind with this number.
    #[inline(always)]
    pub(super) fn from_number(number: u32) -> Option<Self> {
        match number {
            1 => Some(Self::Triangles),
            2 => Some(Self::Spheres),
            3 => Some(Self::Others),
            _ => None,
        }
    }

    /// Rows before the indices; `None` where nothing is tested together.
    pub(super) fn n_rows(self) -> Option<usize> {
        match self {
            Self::Triangles => Some(TRIANGLE_ROWS),
            Self::Spheres => Some(SPHERE_ROWS),
            Self::Others => None,
        }
    }

    /// Lines of a leaf of `n` primitives.
    pub(super) fn n_lines(self, n: usize) -> usize {
        let len = match self {
            Self::Triangles => (TRIANGLE_ROWS + 1) * n,
            // The last row is loaded whole, and nothing behind the leaf.
            Self::Spheres => ((SPHERE_ROWS + 1) * n).max((SPHERE_ROWS - 1) * n + N_LANES),
            Self::Others => n,
        };
        len.div_ceil(16)
    }
}

/// A child: a node, or a leaf with its kind and size. From the top 2 bits of
/// kind (0 for a node), 3 bits of size less one, 27 bits of line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Word(pub(super) u32);

impl Word {
    /// The node that the search starts with.
    pub(super) const ROOT: Self = Self(0);
    /// Lines that a leaf may start in, 8 GiB of them.
    pub(super) const MAX_LINES: usize = 1 << 27;

    /// What a ray has come to that has been everywhere: a leaf where the root
    /// is. It may be prefetched, which is slow for memory that is not there.
    pub(super) const END: Self = Self((LeafKind::Others as u32) << 30);

    /// The node at this line.
    pub(super) fn node(line: u32) -> Self {
        Self(line)
    }

    /// The leaf of `n` primitives at this line.
    pub(super) fn leaf(kind: LeafKind, n: usize, line: u32) -> Self {
        Self((kind as u32) << 30 | (n as u32 - 1) << 27 | line)
    }

    /// Whether this is no node.
    #[inline(always)]
    pub(super) fn is_leaf(self) -> bool {
        self.0 >> 30 != 0
    }

    /// What the leaf holds.
    #[inline(always)]
    pub(super) fn leaf_kind(self) -> LeafKind {
        match self.0 >> 30 {
            1 => LeafKind::Triangles,
            2 => LeafKind::Spheres,
            _ => LeafKind::Others,
        }
    }

    /// The number of primitives in the leaf, from 1 to 8.
    #[inline(always)]
    pub(super) fn leaf_size(self) -> usize {
        (self.0 >> 27 & 7) as usize + 1
    }

    /// Where it begins.
    #[inline(always)]
    pub(super) fn line(self) -> usize {
        (self.0 & (Self::MAX_LINES as u32 - 1)) as usize
    }
}

/// The node that a word names.
pub(super) fn node(lines: &[Line], word: Word) -> &Node {
    let lines = lines[word.line()..].first_chunk::<NODE_LINES>();
    bytemuck::cast_ref(lines.expect("nodes are whole"))
}
