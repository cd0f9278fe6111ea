//! Boxes in the layout that the build computes with.

use math::simd::{InstructionSet, Lanes};
use world::geometry::Aabb;

/// A box as `[-min, _, max, _]`: a union is one maximum over all lanes. Two lanes are unused.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct LaneBounds(pub(super) [f32; 8]);

impl LaneBounds {
    /// The empty box.
    pub(super) const EMPTY: Self = Self([f32::NEG_INFINITY; 8]);

    /// Returns the box between two corners.
    pub(super) fn new(min: [f32; 3], max: [f32; 3]) -> Self {
        let ([a, b, c], [x, y, z]) = (min, max);
        Self([-a, -b, -c, 0.0, x, y, z, 0.0])
    }

    /// Returns the box in these lanes.
    #[inline(always)]
    pub(super) fn from_lanes<L: Lanes>(lanes: L) -> Self {
        Self(lanes.to_array())
    }

    /// Returns the box as lanes.
    #[inline(always)]
    pub(super) fn lanes<I: InstructionSet>(&self, set: I) -> I::Lanes {
        set.load(&self.0)
    }

    /// Returns the smallest box around both.
    #[inline]
    pub(super) fn union(mut self, other: Self) -> Self {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a = if *a > b { *a } else { b };
        }
        self
    }

    /// Returns the points that both boxes contain; may be empty.
    #[inline]
    pub(super) fn intersection(mut self, other: Self) -> Self {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a = a.min(b);
        }
        self
    }

    /// Returns true if the box contains no point.
    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        (0..3).any(|axis| self.extent(axis) < 0.0)
    }

    /// Returns half of the surface area; meaningless for an empty box.
    #[inline(always)]
    pub(super) fn half_area(&self) -> f32 {
        let [x, y, z] = [self.extent(0), self.extent(1), self.extent(2)];
        x * y + y * z + z * x
    }

    /// Returns the least coordinate on an axis.
    #[inline(always)]
    pub(super) fn min(&self, axis: usize) -> f32 {
        -self.0[axis]
    }

    /// Returns the greatest coordinate on an axis.
    #[inline(always)]
    pub(super) fn max(&self, axis: usize) -> f32 {
        self.0[4 + axis]
    }

    /// Returns the length along an axis; negative for an empty box.
    #[inline(always)]
    pub(super) fn extent(&self, axis: usize) -> f32 {
        self.0[4 + axis] + self.0[axis]
    }

    /// Returns the box in the usual form.
    #[inline(always)]
    pub(super) fn to_aabb(self) -> Aabb {
        let [a, b, c, _, x, y, z, _] = self.0;
        Aabb {
            min: [-a, -b, -c].into(),
            max: [x, y, z].into(),
        }
    }
}
