//! Intersection of a ray with all primitives of a leaf at once, one primitive per lane.
//!
//! The formulas are `geometry`'s: each lane has the same `t` as
//! [`Triangle`](world::geometry::Triangle), [`Sphere`](world::geometry::Sphere) or [`Capsule`], to
//! the bit.

use glam::Vec3;

use crate::accel::arena::Leaf;
use crate::accel::layout::{CAPSULE_ROWS, LeafKind, SPHERE_ROWS, TRIANGLE_ROWS};
use crate::accel::search::Search;
use math::simd::{Arithmetic, InstructionSet, Lanes, Mask, N_LANES, Vector};
use world::geometry::{
    AreaTest, Areas, Capsule, N_PARAMETERS, Ray, RayTest, Shear, SphereEquation, sheared,
    squared_length,
};

/// Set-up of a ray, shared by its tests against all leaves.
pub(super) struct LeafIntersector {
    pub(super) ray: Ray,
    /// Squared length of the direction, and its reciprocal.
    pub(super) squared_length: (f32, f32),
    pub(super) shear: Shear,
    /// The origin, its axes permuted as in the shear.
    pub(super) permuted_origin: Vec3,
}

impl LeafIntersector {
    #[inline(always)]
    pub(super) fn new(ray: &Ray) -> Self {
        Self::with_shear(ray, Shear::along(ray.direction))
    }

    /// Prepares a ray whose shear is known.
    #[inline(always)]
    pub(super) fn with_shear(ray: &Ray, shear: Shear) -> Self {
        Self {
            ray: *ray,
            squared_length: squared_length(ray.direction.into()),
            shear,
            permuted_origin: shear.permute(ray.origin),
        }
    }

    /// Tests the primitives of a leaf and reports the hits to `search`.
    #[inline(always)]
    pub(super) fn test<I: InstructionSet, S: Search>(&self, set: I, leaf: Leaf, search: &mut S) {
        match leaf.kind() {
            LeafKind::Triangles => self.triangles(set, leaf, search),
            LeafKind::Spheres => self.spheres(set, leaf, search),
            LeafKind::Capsules => self.capsules(set, leaf, search),
            LeafKind::Others => {
                for i in 0..leaf.len() {
                    search.test(&self.ray, leaf.primitive(0, i));
                }
            }
        }
    }

    /// Tests triangles.
    #[inline(always)]
    fn triangles<I: InstructionSet, S: Search>(&self, set: I, leaf: Leaf, search: &mut S) {
        // Shear the vertices into the space where the ray is the z axis.
        let constants = set.splat_vector(self.shear.constants);
        let [x, y, z] = self.shear.axes;
        let (x, y, z) = (leaf.coordinate(x), leaf.coordinate(y), leaf.coordinate(z));
        // No `array::map` here: it is not always inlined.
        let vertices = [
            self.sheared(set, constants, [x[0], y[0], z[0]]),
            self.sheared(set, constants, [x[1], y[1], z[1]]),
            self.sheared(set, constants, [x[2], y[2], z[2]]),
        ];
        // Compare the areas of the three sub-triangles; `t` is the weighted depth.
        let AreaTest { hits, is_unsure, t } = Areas::new(&vertices).test(constants.z);
        let (zero, limit) = (set.splat(0.0), set.splat(search.limit()));
        // Report hits in front of the limit. One branch for all: a mispredicted one costs as much
        // as the test.
        let hits = (hits & zero.lt(t) & t.lt(limit)).bits() & used_lanes(leaf);
        if hits != 0 {
            report(leaf, TRIANGLE_ROWS, t.to_array(), hits, search);
        }
        // Repeat in higher precision the tests that rounding may have decided.
        let unsure = is_unsure.bits() & used_lanes(leaf);
        if unsure != 0 {
            self.unsure_triangles(leaf, unsure, search);
        }
    }

    /// Tests the triangles in these lanes exactly, one by one.
    #[cold]
    #[inline(never)]
    fn unsure_triangles<S: Search>(&self, leaf: Leaf, mut lanes: u8, search: &mut S) {
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % N_LANES;
            lanes &= lanes - 1;
            let vertices = self.shear.points(&self.ray, leaf.triangle(lane));
            match self.shear.intersect_exactly(vertices) {
                Some(t) if t > 0.0 && t < search.limit() => {
                    search.found(t, leaf.primitive(TRIANGLE_ROWS, lane));
                }
                _ => {}
            }
        }
    }

    /// Returns the points with these coordinates in the space of the [`Shear`].
    #[inline(always)]
    fn sheared<I: InstructionSet>(
        &self,
        set: I,
        constants: Vector<I::Lanes>,
        [x, y, z]: [&[f32; N_LANES]; 3],
    ) -> Vector<I::Lanes> {
        let point = Vector {
            x: set.load(x),
            y: set.load(y),
            z: set.load(z),
        };
        sheared(point - set.splat_vector(self.permuted_origin), constants)
    }

    /// Tests spheres.
    #[inline(always)]
    fn spheres<I: InstructionSet, S: Search>(&self, set: I, leaf: Leaf, search: &mut S) {
        let zero = set.splat(0.0);
        let center = Vector {
            x: set.load(leaf.row(0)),
            y: set.load(leaf.row(1)),
            z: set.load(leaf.row(2)),
        };
        let to_center = center - set.splat_vector(self.ray.origin);
        let direction = set.splat_vector(self.ray.direction);
        let (a, inverse_a) = self.squared_length;
        let a = (set.splat(a), set.splat(inverse_a));
        let equation = SphereEquation::new(to_center, set.load(leaf.row(3)), direction, a);
        let t = equation.first();
        let hits = equation.hits() & zero.lt(t) & t.lt(set.splat(search.limit()));
        report(leaf, SPHERE_ROWS, t.to_array(), hits.bits(), search);
    }

    /// Tests capsules.
    #[inline(always)]
    fn capsules<I: InstructionSet, S: Search>(&self, set: I, leaf: Leaf, search: &mut S) {
        let zero = set.splat(0.0);
        let mut parameters = [zero; N_PARAMETERS];
        for (parameter, row) in parameters[..CAPSULE_ROWS].iter_mut().zip(1..) {
            *parameter = set.load(leaf.row(row));
        }
        let origin = set.splat_vector(self.ray.origin);
        let direction = set.splat_vector(self.ray.direction);
        let t = Capsule::hits(&parameters, origin, direction);
        let hits = zero.lt(t) & t.lt(set.splat(search.limit()));
        report(leaf, 0, t.to_array(), hits.bits(), search);
    }
}

/// Returns the lanes that hold a primitive, as bits.
#[inline(always)]
fn used_lanes(leaf: Leaf) -> u8 {
    u8::MAX >> (N_LANES - leaf.len())
}

/// Reports the hits at `t` in these lanes, as far as they hold a primitive.
#[inline(always)]
fn report<S: Search>(leaf: Leaf, n_rows: usize, t: [f32; N_LANES], hits: u8, search: &mut S) {
    let mut hits = hits & used_lanes(leaf);
    while hits != 0 {
        let lane = hits.trailing_zeros() as usize % N_LANES;
        hits &= hits - 1;
        search.found(t[lane], leaf.primitive(n_rows, lane));
    }
}
