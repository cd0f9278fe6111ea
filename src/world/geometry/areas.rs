//! The decision whether a ray hits a triangle, and where.

use math::simd::{Arithmetic, Vector};

/// Ratio of products to the area below which 32 bits suffice.
const MAX_SPREAD: f32 = 8.0;

/// Area above which 32 bits suffice: no product of an area and a depth underflows where that would
/// matter.
const MIN_AREA: f32 = 1.0 / MAX_AREA;

/// Area below which 32 bits suffice: no product of an area and a depth up to 1e20 overflows.
const MAX_AREA: f32 = (1_u64 << 60) as f32;

/// Twice the signed areas of the triangles of a ray and each edge of a triangle, whose vertices are
/// in the space of the ray's [`Shear`](super::Shear).
///
/// Rounding is monotonic: `fl(p) < fl(q)` implies `p < q`. So the difference of two rounded
/// products has the sign of the exact difference, or is zero. The areas are such differences; where
/// none is zero, their signs decide.
///
/// With `e = 2^-24`, the error of an area `p - q` is at most `e (|p| + |q| + |p - q|)`, that is, at
/// most `2 e (|p - q| + |q|)`. Let the areas' magnitudes sum to 1, and the magnitudes of the
/// products `q` to less than 8: then their errors add up to at most `18 e`. The depth is the mean
/// of the vertices' depths weighted by the areas, so its error is at most `18 e` times the
/// triangle's extent in depth, plus a few more roundings. All other cases are left to
/// [`intersect_exactly`](super::Shear::intersect_exactly).
pub struct Areas<R> {
    areas: [R; 3],
    /// The sum of the magnitudes of the products `q`.
    spread: R,
    least: R,
    greatest: R,
    depths: [R; 3],
}

/// The result of the 32-bit test.
pub struct AreaTest<R: Arithmetic> {
    /// True if the ray's line hits the triangle.
    pub hits: R::Mask,
    /// True if rounding errors may change the result.
    pub is_unsure: R::Mask,
    /// The parameter of the hit.
    pub t: R,
}

impl<R: Arithmetic> Areas<R> {
    /// Computes the areas of a triangle with these vertices.
    #[inline(always)]
    pub fn new([a, b, c]: &[Vector<R>; 3]) -> Self {
        let (u0, u1) = (b.x * c.y, b.y * c.x);
        let (v0, v1) = (c.x * a.y, c.y * a.x);
        let (w0, w1) = (a.x * b.y, a.y * b.x);
        let (u, v, w) = (u0 - u1, v0 - v1, w0 - w1);
        Self {
            areas: [u, v, w],
            spread: u1.abs() + v1.abs() + w1.abs(),
            least: u.min(v).min(w),
            greatest: u.max(v).max(w),
            depths: [a.z, b.z, c.z],
        }
    }

    /// Returns true if the ray's line certainly misses the triangle: the areas differ in sign.
    #[inline(always)]
    pub fn is_missed(&self) -> R::Mask {
        let product = self.least * self.greatest;
        product.lt(product.splat(0.0))
    }

    /// Tests the ray, given the scale of its shear.
    #[inline(always)]
    pub fn test(&self, scale: R) -> AreaTest<R> {
        let ([u, v, w], [a, b, c]) = (self.areas, self.depths);
        let area = u + v + w;
        let size = area.abs();
        // All areas have the same sign, and are large enough for 32 bits to decide.
        let has_sign =
            scale.splat(MIN_AREA).lt(self.least) | self.greatest.lt(scale.splat(-MIN_AREA));
        let is_accurate =
            self.spread.lt(size * scale.splat(MAX_SPREAD)) & size.lt(scale.splat(MAX_AREA));
        let hits = has_sign & is_accurate;
        AreaTest {
            hits,
            is_unsure: !(self.is_missed() | hits),
            t: (u * a + v * b + w * c) / area * scale,
        }
    }
}
