//! The test of eight pairs of a ray and a triangle at once.

use crate::geometry::shear::{MAX_AREA, MAX_SPREAD, MIN_AREA};
use crate::simd::{InstructionSet, Mask, Real, Vector};

/// What [`Shear::intersect`](crate::geometry::Shear::intersect) finds in each lane, to
/// the bit.
pub(super) struct TriangleHits<L> {
    /// The lanes whose lines hit the triangles.
    pub(super) hits: u8,
    /// The lanes that are left to
    /// [`Shear::intersect_exactly`](crate::geometry::Shear::intersect_exactly).
    pub(super) unsure: u8,
    /// The parameters of the hits.
    pub(super) t: L,
}

/// Tests those lanes of `active`. The vertices are in the spaces of the rays'
/// [`Shear`](crate::geometry::Shear)s, which have these scales.
#[inline(always)]
pub(super) fn intersect<I: InstructionSet>(
    set: I,
    [a, b, c]: &[Vector<I::Lanes>; 3],
    scale: I::Lanes,
    active: u8,
) -> TriangleHits<I::Lanes> {
    let zero = set.splat(0.0);
    let (u0, u1) = (b.x * c.y, b.y * c.x);
    let (v0, v1) = (c.x * a.y, c.y * a.x);
    let (w0, w1) = (a.x * b.y, a.y * b.x);
    let (u, v, w) = (u0 - u1, v0 - v1, w0 - w1);
    let (least, greatest) = (u.min(v).min(w), u.max(v).max(w));
    let candidates = !(least.lt(zero) & zero.lt(greatest)).bits() & active;
    if candidates == 0 {
        return TriangleHits {
            hits: 0,
            unsure: 0,
            t: zero,
        };
    }
    let spread_u = u0.abs() + u1.abs();
    let spread_v = v0.abs() + v1.abs();
    let spread_w = w0.abs() + w1.abs();
    let (area, spread) = (u + v + w, spread_u + spread_v + spread_w);
    let size = area.abs();
    let has_sign = zero.lt(least).bits() | greatest.lt(zero).bits();
    let is_accurate = spread.lt(size * set.splat(MAX_SPREAD))
        & set.splat(MIN_AREA).lt(size)
        & size.lt(set.splat(MAX_AREA));
    let sure = has_sign & is_accurate.bits();
    TriangleHits {
        hits: candidates & sure,
        unsure: candidates & !sure,
        t: (u * a.z + v * b.z + w * c.z) / area * scale,
    }
}
