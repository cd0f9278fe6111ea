//! References to primitives: the items that the build sorts and splits.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use rayon::prelude::*;

use super::bounds::LaneBounds;
use super::clip;
use crate::accel::layout::{ID_BIT, LeafKind};
use math::simd::{InstructionSet, Lanes};
use world::geometry::{Aabb, Shape};
use world::scene::Primitive;

/// A primitive and a box around it, or around the part of it that the reference stands for. Half a
/// cache line, in the layout of [`LaneBounds`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C, align(32))]
pub(super) struct Reference {
    negated_min: [f32; 3],
    /// The primitive's index and [`ID_BIT`].
    id: u32,
    max: [f32; 3],
    /// A [`LeafKind`] and [`ID_BIT`].
    kind: u32,
}

impl Reference {
    /// Returns the reference to the whole primitive with this index.
    pub(super) fn new(primitive: &Primitive, index: u32) -> Self {
        let bounds = box_of(primitive);
        Self {
            negated_min: (-bounds.min).into(),
            id: index | ID_BIT,
            max: bounds.max.into(),
            kind: LeafKind::new(primitive) as u32 | ID_BIT,
        }
    }

    /// Returns the primitive's index.
    #[inline(always)]
    pub(super) fn primitive(&self) -> u32 {
        self.id & !ID_BIT
    }

    /// Returns the kind of leaf that holds the primitive.
    #[inline(always)]
    pub(super) fn kind(&self) -> LeafKind {
        LeafKind::from_number(self.kind & !ID_BIT).unwrap_or(LeafKind::Others)
    }

    /// Returns true if the primitive is a triangle.
    #[inline(always)]
    pub(super) fn is_triangle(&self) -> bool {
        self.kind() == LeafKind::Triangles
    }

    /// Returns the box around the referenced part.
    #[inline(always)]
    pub(super) fn bounds(&self) -> LaneBounds {
        LaneBounds(bytemuck::cast(*self))
    }

    /// Returns half of the surface area of the box.
    #[inline(always)]
    pub(super) fn half_area(&self) -> f32 {
        self.bounds().half_area()
    }

    /// Returns the box as lanes.
    #[inline(always)]
    pub(super) fn lanes<I: InstructionSet>(&self, set: I) -> I::Lanes {
        set.load(bytemuck::cast_ref(self))
    }

    /// Returns twice the center of the box on an axis.
    #[inline(always)]
    pub(super) fn center(&self, axis: usize) -> f32 {
        self.max[axis] - self.negated_min[axis]
    }

    /// Splits the reference to a triangle at `position` on an axis. Returns the parts below and
    /// above the plane, `None` for an empty one, or any other reference unchanged as the first
    /// part.
    pub(super) fn split(
        &self,
        primitives: &[Primitive],
        axis: usize,
        position: f32,
    ) -> [Option<Self>; 2] {
        let shape = primitives[self.primitive() as usize].world_shape();
        let Some(Shape::Triangle(triangle)) = shape else {
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

/// Returns the box that a ray has to enter before the primitive is tested.
///
/// A ray does not enter a box that ends before its origin on the dominant axis of its direction, so
/// the test must not find a hit ahead of the origin there. The tests of triangles, of cuboids along
/// the axes and of instances do not, whatever their rounding. The boxes of others have a margin above
/// the rounding error of their tests. It depends on their own coordinates only: the ray starts so
/// close that its origin is hardly larger. Rectangles are tested with 64 bits, and without error
/// along an axis to which they are perpendicular.
pub(super) fn box_of(primitive: &Primitive) -> Aabb {
    let bounds = primitive.bounds();
    let margin = |share: f32| Vec3::splat(share * bounds.largest());
    let margin = match primitive.world_shape() {
        Some(Shape::Triangle(_) | Shape::Cuboid(_)) => return bounds,
        Some(Shape::Rectangle(_)) => {
            let is_flat = bounds.min.cmpeq(bounds.max);
            Vec3::select(is_flat, Vec3::ZERO, margin(f32::EPSILON))
        }
        _ => margin(8e-6),
    };
    Aabb {
        min: bounds.min - margin,
        max: bounds.max + margin,
    }
}

/// Returns the box that contains only twice the center of a box: `max + min` in the lanes of the
/// upper corner, the negation in the lanes of the lower one.
#[inline(always)]
pub(super) fn center<L: Lanes>(bounds: L) -> L {
    bounds - bounds.swap_halves()
}

/// Maps chunks of references and reduces the results, in parallel if there are at least `parallel`
/// references. The reduction must be independent of the order, as maxima and sums of integers are.
#[inline]
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
