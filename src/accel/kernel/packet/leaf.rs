//! The test of a leaf's primitives, one after the other, against all rays: the
//! arithmetic of [`LeafIntersector`](crate::accel::kernel::leaf::LeafIntersector)
//! with rays in the lanes.

use super::rays::{Half, PacketRays};
use super::soa::N_HALVES;
use crate::accel::arena::Leaf;
use crate::accel::layout::{SPHERE_ROWS, TRIANGLE_ROWS};
use crate::geometry::{AreaTest, Areas, Shear};
use crate::simd::{InstructionSet, Lanes, Mask, N_LANES, Real, Vector};

impl<I: InstructionSet> PacketRays<'_, I> {
    /// Tests triangles. Calls `found` for each hit, with the ray, the parameter and
    /// the primitive.
    #[inline(always)]
    pub(super) fn triangles(
        &self,
        leaf: Leaf,
        active: u16,
        mut found: impl FnMut(usize, f32, u32),
    ) {
        let zero = self.set.splat(0.0);
        let axes = self.shear_axes.map(|axis| axis % 3);
        for i in 0..leaf.len() {
            for (n, active) in active.to_le_bytes().into_iter().enumerate() {
                if active == 0 {
                    continue;
                }
                let n = n % N_HALVES;
                let vertices = [
                    self.sheared(n, axes, leaf, 0, i),
                    self.sheared(n, axes, leaf, 3, i),
                    self.sheared(n, axes, leaf, 6, i),
                ];
                let areas = Areas::new(&vertices);
                // Coherent rays make this branch predictable.
                if !areas.is_missed().bits() & active == 0 {
                    continue;
                }
                let scale = self.set.load(&self.halves[n].scale);
                let AreaTest { hits, is_unsure, t } = areas.test(scale);
                let primitive = leaf.primitive(TRIANGLE_ROWS, i);
                let mut hits = (hits & zero.lt(t)).bits() & active;
                let t = t.to_array();
                while hits != 0 {
                    let lane = hits.trailing_zeros() as usize % N_LANES;
                    hits &= hits - 1;
                    found(N_LANES * n + lane, t[lane], primitive);
                }
                let mut unsure = is_unsure.bits() & active;
                while unsure != 0 {
                    let ray = N_LANES * n + unsure.trailing_zeros() as usize % N_LANES;
                    unsure &= unsure - 1;
                    match self.intersect_exactly(ray, leaf, i) {
                        Some(t) if t > 0.0 => found(ray, t, primitive),
                        _ => {}
                    }
                }
            }
        }
    }

    /// The parameter of a ray's hit on a triangle, where rounding may decide.
    #[cold]
    #[inline(never)]
    fn intersect_exactly(&self, ray: usize, leaf: Leaf, i: usize) -> Option<f32> {
        let shear = self.shear(&self.halves[ray / N_LANES % N_HALVES], ray % N_LANES);
        let ray = self.soa.ray(ray);
        shear.intersect_exactly(leaf.triangle(i).map(|vertex| shear.point(&ray, vertex)))
    }

    /// The shear of a ray.
    #[inline(always)]
    fn shear(&self, half: &Half<I>, lane: usize) -> Shear {
        let [x, y] = &half.slopes;
        Shear {
            axes: self.shear_axes,
            slopes: [x[lane], y[lane]],
            scale: half.scale[lane],
        }
    }

    /// The point with the coordinates at index `i` of three rows, in the shears of
    /// the rays of a half.
    #[inline(always)]
    fn sheared(
        &self,
        half: usize,
        [x, y, z]: [usize; 3],
        leaf: Leaf,
        first: usize,
        i: usize,
    ) -> Vector<I::Lanes> {
        let set = self.set;
        let origin = &self.soa.origins[half];
        let [slope_x, slope_y] = &self.halves[half].slopes;
        let i = i % N_LANES;
        // No closure for the three lines: it would not be inlined.
        let in_x = set.splat(leaf.row(first + x)[i]) - set.load(&origin[x]);
        let in_y = set.splat(leaf.row(first + y)[i]) - set.load(&origin[y]);
        let in_z = set.splat(leaf.row(first + z)[i]) - set.load(&origin[z]);
        Vector {
            x: in_x - set.load(slope_x) * in_z,
            y: in_y - set.load(slope_y) * in_z,
            z: in_z,
        }
    }

    /// Tests spheres; calls `found` as [`triangles`](Self::triangles) does.
    #[inline(always)]
    pub(super) fn spheres(&self, leaf: Leaf, active: u16, mut found: impl FnMut(usize, f32, u32)) {
        let set = self.set;
        let zero = set.splat(0.0);
        for i in 0..leaf.len() {
            let lane = i % N_LANES;
            let center = Vector {
                x: set.splat(leaf.row(0)[lane]),
                y: set.splat(leaf.row(1)[lane]),
                z: set.splat(leaf.row(2)[lane]),
            };
            let r2 = set.splat(leaf.row(3)[lane]);
            for (n, active) in active.to_le_bytes().into_iter().enumerate() {
                if active == 0 {
                    continue;
                }
                let n = n % N_HALVES;
                let d = set.load_vector(&self.soa.directions[n]);
                let c = center - set.load_vector(&self.soa.origins[n]);
                let a = d.dot(d);
                let inverse_a = set.splat(1.0) / a;
                let b = c.dot(d);
                let nearest = c - d * (b * inverse_a);
                let discriminant = r2 - nearest.dot(nearest);
                let is_hit = zero.le(discriminant);
                if is_hit.bits() & active == 0 {
                    continue;
                }
                // A negative discriminant gives NaN, in lanes that are masked
                // already.
                let q = b + (a * discriminant).sqrt().flip_sign_by(b);
                let (t0, t1) = ((c.dot(c) - r2) / q, q * inverse_a);
                let (near, far) = (t0.min(t1), t1.max(t0));
                let t = I::Lanes::select(zero.lt(near), near, far);
                let mut hits = (is_hit & zero.lt(t)).bits() & active;
                let t = t.to_array();
                while hits != 0 {
                    let lane = hits.trailing_zeros() as usize % N_LANES;
                    hits &= hits - 1;
                    found(N_LANES * n + lane, t[lane], leaf.primitive(SPHERE_ROWS, i));
                }
            }
        }
    }
}
