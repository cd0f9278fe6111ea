//! A primitive's box during the build, in half a cache line.

use std::array::from_fn;

use crate::accel::layout::LeafKind;
use crate::geometry::Aabb;
use crate::scene::Primitive;

/// A primitive and its box.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Reference {
    negated_min: [f32; 3],
    pub(super) index: u32,
    max: [f32; 3],
    kind: u32,
}

impl Reference {
    /// Of the primitive with this index.
    pub(super) fn new(primitive: &Primitive, index: u32) -> Self {
        let bounds = primitive.bounds();
        Self {
            negated_min: (-bounds.min).into(),
            index,
            max: bounds.max.into(),
            kind: LeafKind::of(primitive) as u32,
        }
    }

    /// The kind of leaf that it fits in.
    pub(super) fn kind(&self) -> LeafKind {
        const TRIANGLES: u32 = LeafKind::Triangles as u32;
        const SPHERES: u32 = LeafKind::Spheres as u32;
        match self.kind {
            TRIANGLES => LeafKind::Triangles,
            SPHERES => LeafKind::Spheres,
            _ => LeafKind::Others,
        }
    }

    /// Its box.
    #[inline]
    pub(super) fn corners(&self) -> Corners {
        let [a, b, c] = self.negated_min;
        let [x, y, z] = self.max;
        Corners([a, b, c, 0.0, x, y, z, 0.0])
    }

    /// Twice its box's centre.
    #[inline]
    pub(super) fn center(&self) -> [f32; 3] {
        from_fn(|axis| self.max[axis] - self.negated_min[axis])
    }

    /// Twice its box's centre as a box.
    #[inline]
    pub(super) fn center_corners(&self) -> Corners {
        let [x, y, z] = self.center();
        Corners([-x, -y, -z, 0.0, x, y, z, 0.0])
    }
}

/// A box as `[-min, 0, max, 0]`: to grow is one maximum over all lanes.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Corners([f32; 8]);

impl Corners {
    /// No point at all.
    pub(super) const EMPTY: Self = Self([f32::NEG_INFINITY; 8]);

    /// The smallest box around both.
    #[inline]
    pub(super) fn union(self, other: Self) -> Self {
        let max = |i: usize| {
            let (a, b) = (self.0[i], other.0[i]);
            if a > b { a } else { b }
        };
        Self(from_fn(max))
    }

    /// Half of the faces' area; of no meaning for the empty box.
    #[inline]
    pub(super) fn half_area(&self) -> f32 {
        let [x, y, z] = from_fn(|axis| self.extent(axis));
        x * y + y * z + z * x
    }

    /// The least coordinate on an axis.
    pub(super) fn min(&self, axis: usize) -> f32 {
        -self.0[axis]
    }

    /// The length along an axis.
    #[inline]
    pub(super) fn extent(&self, axis: usize) -> f32 {
        self.0[4 + axis] + self.0[axis]
    }

    /// The box as others know it.
    pub(super) fn to_aabb(self) -> Aabb {
        let [a, b, c, _, x, y, z, _] = self.0;
        Aabb {
            min: [-a, -b, -c].into(),
            max: [x, y, z].into(),
        }
    }
}
