//! A primitive's box during the build, in half a cache line.

use std::array::from_fn;

use bytemuck::{Pod, Zeroable};

use super::clip;
use crate::accel::layout::LeafKind;
use crate::geometry::{Aabb, Shape};
use crate::scene::Primitive;

/// A box that holds a primitive, or the part of it that lies in there.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C, align(32))]
pub(super) struct Reference {
    negated_min: [f32; 3],
    pub(super) index: u32,
    max: [f32; 3],
    /// A [`LeafKind`].
    pub(super) kind: u32,
}

impl Reference {
    /// Of the whole primitive with this index.
    pub(super) fn new(primitive: &Primitive, index: u32) -> Self {
        let bounds = primitive.bounds();
        Self {
            negated_min: (-bounds.min).into(),
            index,
            max: bounds.max.into(),
            kind: LeafKind::of(primitive) as u32,
        }
    }

    /// Whether it is of a triangle.
    #[inline]
    pub(super) fn is_triangle(&self) -> bool {
        self.kind == LeafKind::Triangles as u32
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

    /// What of a triangle's reference lies below and above `position` on an
    /// axis; `None` for nothing. Anything else stays as it is.
    pub(super) fn cut(
        &self,
        primitives: &[Primitive],
        axis: usize,
        position: f32,
    ) -> [Option<Self>; 2] {
        let Some(Shape::Triangle(triangle)) = primitives[self.index as usize].world_shape() else {
            return [Some(*self), None];
        };
        clip::parts(triangle, axis, position).map(|part| {
            let part = part.intersection(self.corners());
            let Corners([a, b, c, _, x, y, z, _]) = part;
            (!part.is_empty()).then_some(Self {
                negated_min: [a, b, c],
                max: [x, y, z],
                ..*self
            })
        })
    }
}

/// A box as `[-min, 0, max, 0]`: to grow is one maximum over all lanes.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Corners([f32; 8]);

impl Corners {
    /// No point at all.
    pub(super) const EMPTY: Self = Self([f32::NEG_INFINITY; 8]);

    /// The box between two corners.
    pub(super) fn new(min: [f32; 3], max: [f32; 3]) -> Self {
        let ([a, b, c], [x, y, z]) = (min, max);
        Self([-a, -b, -c, 0.0, x, y, z, 0.0])
    }

    /// The smallest box around both.
    #[inline]
    pub(super) fn union(self, other: Self) -> Self {
        let max = |i: usize| {
            let (a, b) = (self.0[i], other.0[i]);
            if a > b { a } else { b }
        };
        Self(from_fn(max))
    }

    /// The box that both have in common.
    pub(super) fn intersection(self, other: Self) -> Self {
        Self(from_fn(|i| self.0[i].min(other.0[i])))
    }

    /// Whether no point is in it.
    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        (0..3).any(|axis| self.extent(axis) < 0.0)
    }

    /// Half of the faces' area; of no meaning for the empty box.
    #[inline]
    pub(super) fn half_area(&self) -> f32 {
        let [x, y, z] = from_fn(|axis| self.extent(axis));
        x * y + y * z + z * x
    }

    /// The least coordinate on an axis.
    #[inline]
    pub(super) fn min(&self, axis: usize) -> f32 {
        -self.0[axis]
    }

    /// The greatest coordinate on an axis.
    #[inline]
    pub(super) fn max(&self, axis: usize) -> f32 {
        self.0[4 + axis]
    }

    /// The length along an axis; less than 0 for the empty box.
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
