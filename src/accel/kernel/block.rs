//! The test of a ray against all primitives of a leaf at once.
//!
//! The same operations in the same order as the tests of `geometry`, so that
//! each lane gives the very `t` of [`Triangle`](crate::geometry::Triangle) or
//! [`Sphere`](crate::geometry::Sphere). Of triangles eight lanes only find
//! those that may be met, few as they are: what decides is [`Shear`]'s.

use glam::Vec3;

use crate::accel::arena::Leaf;
use crate::accel::layout::{SPHERE_ROWS, TRIANGLE_ROWS};
use crate::accel::search::Search;
use crate::accel::simd::{InstructionSet, Lanes, Mask, N_LANES, Vec3Lanes};
use crate::geometry::{Ray, Shear};

/// What a ray's tests against many leaves have in common.
pub(super) struct Blocks<I: InstructionSet> {
    set: I,
    origin: Vec3,
    direction: Vec3,
    /// The direction's squared length.
    a: f32,
    inverse_a: f32,
    shear: Shear,
    /// The origin with the axes of the shear.
    turned_origin: Vec3Lanes<I::Lanes>,
    slopes: [I::Lanes; 2],
}

impl<I: InstructionSet> Blocks<I> {
    #[inline(always)]
    pub(super) fn new(set: I, ray: &Ray) -> Self {
        Self::sheared_by(set, ray, Shear::along(ray.direction))
    }

    /// For a ray that runs along the last axis of this space.
    #[inline(always)]
    pub(super) fn sheared_by(set: I, ray: &Ray, shear: Shear) -> Self {
        let a = ray.direction.dot(ray.direction);
        let [slope_x, slope_y] = shear.slopes;
        Self {
            set,
            origin: ray.origin,
            direction: ray.direction,
            a,
            inverse_a: a.recip(),
            shear,
            turned_origin: Vec3Lanes::splat(set, shear.turn(ray.origin).into()),
            slopes: [set.splat(slope_x), set.splat(slope_y)],
        }
    }

    /// Tests triangles.
    #[inline(always)]
    pub(super) fn triangles<S: Search>(&self, leaf: Leaf, search: &mut S) {
        let zero = self.set.splat(0.0);
        // No `array::map` here: it is not always inlined.
        let (a, b, c) = (
            self.sheared(leaf, 0),
            self.sheared(leaf, 3),
            self.sheared(leaf, 6),
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
        // Rounding may make an area zero, but never turns its sign.
        let mut inside = zero.le(u.min(v).min(w)).bits() & in_use(leaf);
        if inside == 0 {
            return;
        }
        let (a, b, c) = (a.to_arrays(), b.to_arrays(), c.to_arrays());
        while inside != 0 {
            let lane = inside.trailing_zeros() as usize % N_LANES;
            inside &= inside - 1;
            let corners = [&a, &b, &c].map(|[x, y, z]| Vec3::new(x[lane], y[lane], z[lane]));
            match self.shear.crossing(corners) {
                Some(t) if t > 0.0 && t < search.limit() => {
                    search.found(t, leaf.primitive(TRIANGLE_ROWS, lane));
                }
                _ => {}
            }
        }
    }

    /// Points of three rows in the space of [`Shear`].
    #[inline(always)]
    fn sheared(&self, leaf: Leaf, first: usize) -> Vec3Lanes<I::Lanes> {
        let [x, y, z] = self.shear.axes;
        let x = self.row(leaf, first + x) - self.turned_origin.x;
        let y = self.row(leaf, first + y) - self.turned_origin.y;
        let z = self.row(leaf, first + z) - self.turned_origin.z;
        Vec3Lanes {
            x: x - self.slopes[0] * z,
            y: y - self.slopes[1] * z,
            z,
        }
    }

    /// Tests spheres.
    #[inline(always)]
    pub(super) fn spheres<S: Search>(&self, leaf: Leaf, search: &mut S) {
        let zero = self.set.splat(0.0);
        let (center, r2) = (self.vectors(leaf, 0), self.row(leaf, 3));
        let d = Vec3Lanes::splat(self.set, self.direction);
        let c = center - Vec3Lanes::splat(self.set, self.origin);
        let (a, inverse_a) = (self.set.splat(self.a), self.set.splat(self.inverse_a));
        let b = c.dot(d);
        let nearest = c - d * (b * inverse_a);
        let discriminant = r2 - nearest.dot(nearest);
        let met = zero.le(discriminant);
        if met.bits() & in_use(leaf) == 0 {
            return;
        }
        // A discriminant below 0 gives NaN, in lanes that are out already.
        let q = b + (a * discriminant).sqrt().flip_sign_by(b);
        let (t0, t1) = ((c.dot(c) - r2) / q, q * inverse_a);
        let (near, far) = (t0.min(t1), t1.max(t0));
        let t = I::Lanes::select(zero.lt(near), near, far);
        let hits = met & zero.lt(t) & t.lt(self.set.splat(search.limit()));
        report(leaf, SPHERE_ROWS, t.to_array(), hits.bits(), search);
    }

    /// The vectors of three rows.
    #[inline(always)]
    fn vectors(&self, leaf: Leaf, first: usize) -> Vec3Lanes<I::Lanes> {
        Vec3Lanes {
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

/// Bits for the lanes that hold a primitive.
#[inline(always)]
fn in_use(leaf: Leaf) -> u8 {
    u8::MAX >> (N_LANES - leaf.len())
}

/// Tells the search of the hits at `t` in these lanes, if they are in use.
#[inline(always)]
fn report<S: Search>(leaf: Leaf, n_rows: usize, t: [f32; N_LANES], hits: u8, search: &mut S) {
    let mut hits = hits & in_use(leaf);
    while hits != 0 {
        let lane = hits.trailing_zeros() as usize % N_LANES;
        hits &= hits - 1;
        search.found(t[lane], leaf.primitive(n_rows, lane));
    }
}
