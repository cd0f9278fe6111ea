//! The test of a ray against all primitives of a leaf at once.
//!
//! The same operations in the same order as the tests of `geometry`, so that
//! each lane gives the very `t` of [`Triangle`](crate::geometry::Triangle) or
//! [`Sphere`](crate::geometry::Sphere).

use crate::accel::layout::{MAX_LEAF_LEN, SPHERE_ROWS, TRIANGLE_ROWS, primitive_index};
use crate::accel::search::Search;
use crate::accel::simd::{InstructionSet, Lanes, Mask, N_LANES, Vec3Lanes};
use crate::geometry::Ray;

/// What a ray's tests against many leaves have in common.
pub(super) struct Blocks<I: InstructionSet> {
    set: I,
    origin: Vec3Lanes<I::Lanes>,
    direction: Vec3Lanes<I::Lanes>,
    /// The direction's squared length.
    a: I::Lanes,
    inverse_a: I::Lanes,
}

/// The rows of a leaf of `n` primitives.
struct Rows<'a, I> {
    set: I,
    n: usize,
    numbers: &'a [f32; MAX_LEAF_LEN],
}

impl<I: InstructionSet> Rows<'_, I> {
    #[inline(always)]
    fn row(&self, i: usize) -> I::Lanes {
        let row = self.numbers[self.n * i..].first_chunk::<N_LANES>();
        self.set.load(row.expect("leaves end with lanes to spare"))
    }

    /// The vectors of three rows.
    #[inline(always)]
    fn vectors(&self, first: usize) -> Vec3Lanes<I::Lanes> {
        Vec3Lanes {
            x: self.row(first),
            y: self.row(first + 1),
            z: self.row(first + 2),
        }
    }

    /// Bits for the lanes that hold a primitive.
    #[inline(always)]
    fn in_use(&self) -> u8 {
        u8::MAX >> (N_LANES - self.n)
    }

    /// Tells the search of the hits at `t` in these lanes.
    #[inline(always)]
    fn report<S: Search>(&self, n_rows: usize, t: I::Lanes, mut hits: u8, search: &mut S) {
        let t = t.to_array();
        while hits != 0 {
            let lane = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            let primitive = primitive_index(self.numbers[n_rows * self.n + lane]);
            search.found(t[lane], primitive);
        }
    }
}

impl<I: InstructionSet> Blocks<I> {
    #[inline(always)]
    pub(super) fn new(set: I, ray: &Ray) -> Self {
        let a = ray.direction.dot(ray.direction);
        Self {
            set,
            origin: Vec3Lanes::splat(set, ray.origin),
            direction: Vec3Lanes::splat(set, ray.direction),
            a: set.splat(a),
            inverse_a: set.splat(a.recip()),
        }
    }

    #[inline(always)]
    fn rows<'a>(&self, numbers: &'a [f32; MAX_LEAF_LEN], n: usize) -> Rows<'a, I> {
        let set = self.set;
        Rows { set, n, numbers }
    }

    /// Tests `n` triangles.
    #[inline(always)]
    pub(super) fn triangles<S: Search>(
        &self,
        numbers: &[f32; MAX_LEAF_LEN],
        n: usize,
        search: &mut S,
    ) {
        let rows = self.rows(numbers, n);
        let zero = self.set.splat(0.0);
        let (v0, e1, e2) = (rows.vectors(0), rows.vectors(3), rows.vectors(6));
        let p = self.direction.cross(e2);
        let determinant = e1.dot(p);
        let s = self.origin - v0;
        let u = s.dot(p).flip_sign_by(determinant);
        let q = s.cross(e1);
        let v = self.direction.dot(q).flip_sign_by(determinant);
        let inside = zero.le(u) & zero.le(v) & (u + v).le(determinant.abs());
        if inside.bits() & rows.in_use() == 0 {
            return;
        }
        let t = e2.dot(q) / determinant;
        let hits = inside & zero.lt(t) & t.lt(self.set.splat(search.limit()));
        rows.report(TRIANGLE_ROWS, t, hits.bits() & rows.in_use(), search);
    }

    /// Tests `n` spheres.
    #[inline(always)]
    pub(super) fn spheres<S: Search>(
        &self,
        numbers: &[f32; MAX_LEAF_LEN],
        n: usize,
        search: &mut S,
    ) {
        let rows = self.rows(numbers, n);
        let zero = self.set.splat(0.0);
        let (center, r2) = (rows.vectors(0), rows.row(3));
        let (c, d) = (center - self.origin, self.direction);
        let b = c.dot(d);
        let nearest = c - d * (b * self.inverse_a);
        let discriminant = r2 - nearest.dot(nearest);
        let met = zero.le(discriminant);
        if met.bits() & rows.in_use() == 0 {
            return;
        }
        // A discriminant below 0 gives NaN, in lanes that are out already.
        let q = b + (self.a * discriminant).sqrt().flip_sign_by(b);
        let (t0, t1) = ((c.dot(c) - r2) / q, q * self.inverse_a);
        let (near, far) = (t0.min(t1), t1.max(t0));
        let t = I::Lanes::select(zero.lt(near), near, far);
        let hits = met & zero.lt(t) & t.lt(self.set.splat(search.limit()));
        rows.report(SPHERE_ROWS, t, hits.bits() & rows.in_use(), search);
    }
}
