//! Boxes in the layout that the build computes with.

use std::array::from_fn;

use crate::geometry::Aabb;

/// A box as `[-min, 0, max, 0]`: a union is one maximum over all lanes.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct LaneBounds(pub(super) [f32; 8]);

impl LaneBounds {
    /// The empty box.
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

    /// The points that both boxes contain; may be empty.
    pub(super) fn intersection(self, other: Self) -> Self {
        Self(from_fn(|i| self.0[i].min(other.0[i])))
    }

    /// Whether it contains no point.
    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        (0..3).any(|axis| self.extent(axis) < 0.0)
    }

    /// Half of the surface area; has no meaning for an empty box.
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

    /// The length along an axis; less than 0 for an empty box.
    #[inline]
    pub(super) fn extent(&self, axis: usize) -> f32 {
        self.0[4 + axis] + self.0[axis]
    }

    /// The box in the crate's usual form.
    pub(super) fn to_aabb(self) -> Aabb {
        let [a, b, c, _, x, y, z, _] = self.0;
        Aabb {
            min: [-a, -b, -c].into(),
            max: [x, y, z].into(),
        }
    }
}
