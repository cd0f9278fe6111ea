//! References to primitives: what the build sorts and splits.

use std::array::from_fn;

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use super::bounds::LaneBounds;
use super::clip;
use crate::accel::layout::LeafKind;
use crate::geometry::Shape;
use crate::scene::Primitive;

/// A primitive and a box around it, or around the part of it that the reference
/// stands for. Half a cache line.
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
    /// The reference to the whole primitive with this index.
    pub(super) fn new(primitive: &Primitive, index: u32) -> Self {
        let bounds = primitive.bounds();
        Self {
            negated_min: (-bounds.min).into(),
            index,
            max: bounds.max.into(),
            kind: LeafKind::of(primitive) as u32,
        }
    }

    /// Whether the primitive is a triangle.
    #[inline]
    pub(super) fn is_triangle(&self) -> bool {
        self.kind == LeafKind::Triangles as u32
    }

    /// Its box.
    #[inline]
    pub(super) fn bounds(&self) -> LaneBounds {
        let [a, b, c] = self.negated_min;
        let [x, y, z] = self.max;
        LaneBounds([a, b, c, 0.0, x, y, z, 0.0])
    }

    /// Twice the center of its box.
    #[inline]
    pub(super) fn center(&self) -> [f32; 3] {
        from_fn(|axis| self.max[axis] - self.negated_min[axis])
    }

    /// The box that contains [`center`](Self::center) alone.
    #[inline]
    pub(super) fn center_bounds(&self) -> LaneBounds {
        let [x, y, z] = self.center();
        LaneBounds([-x, -y, -z, 0.0, x, y, z, 0.0])
    }

    /// Splits the reference to a triangle at `position` on an axis: the parts
    /// below and above the plane, `None` for an empty one. Returns any other
    /// reference as it is.
    pub(super) fn split(
        &self,
        primitives: &[Primitive],
        axis: usize,
        position: f32,
    ) -> [Option<Self>; 2] {
        let Some(Shape::Triangle(triangle)) = primitives[self.index as usize].world_shape() else {
            return [Some(*self), None];
        };
        clip::split(triangle, axis, position).map(|part| {
            let part = part.intersection(self.bounds());
            let LaneBounds([a, b, c, _, x, y, z, _]) = part;
            (!part.is_empty()).then_some(Self {
                negated_min: [a, b, c],
                max: [x, y, z],
                ..*self
            })
        })
    }
}

/// Maps chunks of references and reduces the results, in parallel from
/// `parallel` references on. The reduction has to be independent of its order:
/// maxima and sums of integers are.
pub(super) fn map_reduce<T: Send>(
    references: &[Reference],
    parallel: usize,
    map: impl Fn(&[Reference]) -> T + Send + Sync,
    reduce: impl Fn(T, T) -> T + Send + Sync,
) -> T {
    if references.len() < parallel {
        return map(references);
    }
    references
        .par_chunks(parallel / 4)
        .map(&map)
        .reduce(|| map(&[]), reduce)
}
