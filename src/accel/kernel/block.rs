//! The test of a ray against all primitives of a leaf at once.
//!
//! The same operations in the same order as the tests of `geometry`, so that
//! each lane gives the very `t` of [`Triangle`](crate::geometry::Triangle) or
//! [`Sphere`](crate::geometry::Sphere).

use glam::Vec3;

use crate::accel::layout::{MAX_LEAF_LEN, SPHERE_ROWS, TRIANGLE_ROWS, primitive_index};
use crate::accel::search::Search;
use crate::accel::simd::{InstructionSet, Lanes, Mask, N_LANES, Vec3Lanes};
use crate::geometry::{Ray, Shear};

/// What a ray's tests against many leaves have in common.
pub(super) struct Blocks<I> {
    set: I,
    origin: Vec3,
    direction: Vec3,
    shear: Shear,
    /// The origin with the axes of the shear.
    turned_origin: Vec3,
    /// The direction's squared length.
    a: f32,
    inverse_a: f32,
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
        let shear = Shear::along(ray.direction);
        Self {
            set,
            origin: ray.origin,
            direction: ray.direction,
            turned_origin: shear.turn(ray.origin),
            shear,
            a,
            inverse_a: a.recip(),
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
        // No `array::map` here: it is not always inlined.
        let (a, b, c) = (
            self.sheared(&rows, 0),
            self.sheared(&rows, 3),
            self.sheared(&rows, 6),
        );
        let u = b.x * c.y - b.y * c.x;
        let v = c.x * a.y - c.y * a.x;
        let w = a.x * b.y - a.y * b.x;
        let area = u + v + w;
        let (u, v, w) = (
            u.flip_sign_by(area),
            v.flip_sign_by(area),
            w.flip_sign_by(area),
        );
        let inside = zero.le(u.min(v).min(w));
        if inside.bits() & rows.in_use() == 0 {
            return;
        }
        let inverse = self.set.splat(1.0) / area.abs();
        let scale = self.set.splat(self.shear.scale);
        let t = (u * inverse) * (a.z * scale)
            + (v * inverse) * (b.z * scale)
            + (w * inverse) * (c.z * scale);
        let hits = inside & zero.lt(t) & t.lt(self.set.splat(search.limit()));
        rows.report(TRIANGLE_ROWS, t, hits.bits() & rows.in_use(), search);
    }

    /// Points of three rows in the space of [`Shear`], but for the last
    /// coordinate's scale.
    #[inline(always)]
    fn sheared(&self, rows: &Rows<I>, first: usize) -> Vec3Lanes<I::Lanes> {
        let [x, y, z] = self.shear.axes;
        let x = rows.row(first + x) - self.set.splat(self.turned_origin.x);
        let y = rows.row(first + y) - self.set.splat(self.turned_origin.y);
        let z = rows.row(first + z) - self.set.splat(self.turned_origin.z);
        let [slope_x, slope_y] = self.shear.slopes;
        Vec3Lanes {
            x: x - self.set.splat(slope_x) * z,
            y: y - self.set.splat(slope_y) * z,
            z,
        }
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
        let origin = Vec3Lanes::splat(self.set, self.origin);
        let (c, d) = (center - origin, Vec3Lanes::splat(self.set, self.direction));
        let (a, inverse_a) = (self.set.splat(self.a), self.set.splat(self.inverse_a));
        let b = c.dot(d);
        let nearest = c - d * (b * inverse_a);
        let discriminant = r2 - nearest.dot(nearest);
        let met = zero.le(discriminant);
        if met.bits() & rows.in_use() == 0 {
            return;
        }
        // A discriminant below 0 gives NaN, in lanes that are out already.
        let q = b + (a * discriminant).sqrt().flip_sign_by(b);
        let (t0, t1) = ((c.dot(c) - r2) / q, q * inverse_a);
        let (near, far) = (t0.min(t1), t1.max(t0));
        let t = I::Lanes::select(zero.lt(near), near, far);
        let hits = met & zero.lt(t) & t.lt(self.set.splat(search.limit()));
        rows.report(SPHERE_ROWS, t, hits.bits() & rows.in_use(), search);
    }
}
