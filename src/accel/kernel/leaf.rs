//! The test of a ray against all primitives of a leaf at once.
//!
//! It performs the same operations in the same order as the tests in `geometry`:
//! each lane has the same `t` as [`Triangle`](crate::geometry::Triangle) or
//! [`Sphere`](crate::geometry::Sphere), to the bit.

use glam::Vec3;

use super::triangle;
use crate::accel::arena::Leaf;
use crate::accel::layout::{LeafKind, SPHERE_ROWS, TRIANGLE_ROWS};
use crate::accel::search::Search;
use crate::geometry::{Ray, Shear};
use crate::simd::{InstructionSet, Lanes, Mask, N_LANES, Real, Vector};

/// What the tests of a ray against all leaves share.
pub(super) struct LeafIntersector<I: InstructionSet> {
    set: I,
    origin: Vec3,
    direction: Vec3,
    /// The direction's squared length.
    a: f32,
    inverse_a: f32,
    shear: Shear,
    /// The origin, its axes permuted as in the shear.
    permuted_origin: Vector<I::Lanes>,
    slopes: [I::Lanes; 2],
}

impl<I: InstructionSet> LeafIntersector<I> {
    #[inline(always)]
    pub(super) fn new(set: I, ray: &Ray) -> Self {
        Self::with_shear(set, ray, Shear::along(ray.direction))
    }

    /// For a ray whose shear is known.
    #[inline(always)]
    pub(super) fn with_shear(set: I, ray: &Ray, shear: Shear) -> Self {
        let a = ray.direction.dot(ray.direction);
        let [slope_x, slope_y] = shear.slopes;
        Self {
            set,
            origin: ray.origin,
            direction: ray.direction,
            a,
            inverse_a: a.recip(),
            shear,
            permuted_origin: set.splat_vector(shear.permute(ray.origin).into()),
            slopes: [set.splat(slope_x), set.splat(slope_y)],
        }
    }

    /// Tests the primitives of a leaf; reports the hits to the search.
    #[inline(always)]
    pub(super) fn test<S: Search>(&self, leaf: Leaf, kind: LeafKind, search: &mut S) {
        match kind {
            LeafKind::Triangles => self.triangles(leaf, search),
            LeafKind::Spheres => self.spheres(leaf, search),
            LeafKind::Others => (0..leaf.len()).for_each(|i| search.test(leaf.primitive(0, i))),
        }
    }

    /// Tests triangles.
    #[inline(always)]
    fn triangles<S: Search>(&self, leaf: Leaf, search: &mut S) {
        // No `array::map` here: it is not always inlined.
        let vertices = [
            self.sheared(leaf, 0),
            self.sheared(leaf, 3),
            self.sheared(leaf, 6),
        ];
        let scale = self.set.splat(self.shear.scale);
        let found = triangle::intersect(self.set, &vertices, scale, used_lanes(leaf));
        if found.hits != 0 {
            let (zero, limit) = (self.set.splat(0.0), self.set.splat(search.limit()));
            let hits = found.hits & (zero.lt(found.t) & found.t.lt(limit)).bits();
            report(leaf, TRIANGLE_ROWS, found.t.to_array(), hits, search);
        }
        if found.unsure != 0 {
            self.unsure_triangles(leaf, found.unsure, search);
        }
    }

    /// Tests the triangles in these lanes, one by one.
    #[cold]
    #[inline(never)]
    fn unsure_triangles<S: Search>(&self, leaf: Leaf, mut lanes: u8, search: &mut S) {
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % N_LANES;
            lanes &= lanes - 1;
            let ray = Ray {
                origin: self.origin,
                direction: self.direction,
            };
            match self.shear.intersect_exactly(
                leaf.triangle(lane)
                    .map(|vertex| self.shear.point(&ray, vertex)),
            ) {
                Some(t) if t > 0.0 && t < search.limit() => {
                    search.found(t, leaf.primitive(TRIANGLE_ROWS, lane));
                }
                _ => {}
            }
        }
    }

    /// The points of three rows in the space of the [`Shear`].
    #[inline(always)]
    fn sheared(&self, leaf: Leaf, first: usize) -> Vector<I::Lanes> {
        let [x, y, z] = self.shear.axes;
        let x = self.row(leaf, first + x) - self.permuted_origin.x;
        let y = self.row(leaf, first + y) - self.permuted_origin.y;
        let z = self.row(leaf, first + z) - self.permuted_origin.z;
        Vector {
            x: x - self.slopes[0] * z,
            y: y - self.slopes[1] * z,
            z,
        }
    }

    /// Tests spheres.
    #[inline(always)]
    fn spheres<S: Search>(&self, leaf: Leaf, search: &mut S) {
        let zero = self.set.splat(0.0);
        let (center, r2) = (self.vectors(leaf, 0), self.row(leaf, 3));
        let d = self.set.splat_vector(self.direction);
        let c = center - self.set.splat_vector(self.origin);
        let (a, inverse_a) = (self.set.splat(self.a), self.set.splat(self.inverse_a));
        let b = c.dot(d);
        let nearest = c - d * (b * inverse_a);
        let discriminant = r2 - nearest.dot(nearest);
        let is_hit = zero.le(discriminant);
        if is_hit.bits() & used_lanes(leaf) == 0 {
            return;
        }
        // A negative discriminant gives NaN, in lanes that are masked already.
        let q = b + (a * discriminant).sqrt().flip_sign_by(b);
        let (t0, t1) = ((c.dot(c) - r2) / q, q * inverse_a);
        let (near, far) = (t0.min(t1), t1.max(t0));
        let t = I::Lanes::select(zero.lt(near), near, far);
        let hits = is_hit & zero.lt(t) & t.lt(self.set.splat(search.limit()));
        report(leaf, SPHERE_ROWS, t.to_array(), hits.bits(), search);
    }

    /// The vectors of three rows.
    #[inline(always)]
    fn vectors(&self, leaf: Leaf, first: usize) -> Vector<I::Lanes> {
        Vector {
            x: self.row(leaf, first),
            y: self.row(leaf, first + 1),
            z: self.row(leaf, first + 2),
        }
    }

    #[inline(always)]
    fn row(&self, leaf: Leaf, i: usize) -> I::Lanes {
        self.set.load(leaf.row(i))
    }
}

/// The lanes that hold a primitive, as bits.
#[inline(always)]
fn used_lanes(leaf: Leaf) -> u8 {
    u8::MAX >> (N_LANES - leaf.len())
}

/// Reports to the search the hits at `t` in these lanes, as far as they are used.
#[inline(always)]
fn report<S: Search>(leaf: Leaf, n_rows: usize, t: [f32; N_LANES], hits: u8, search: &mut S) {
    let mut hits = hits & used_lanes(leaf);
    while hits != 0 {
        let lane = hits.trailing_zeros() as usize % N_LANES;
        hits &= hits - 1;
        search.found(t[lane], leaf.primitive(n_rows, lane));
    }
}
