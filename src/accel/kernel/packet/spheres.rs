//! The test of a leaf's spheres, one after the other, against all rays: the
//! arithmetic of [`LeafIntersector`](crate::accel::kernel::leaf::LeafIntersector)
//! with rays in the lanes.

use super::rays::PacketRays;
use super::soa::{N_HALVES, PerRay};
use crate::accel::arena::Leaf;
use crate::accel::layout::SPHERE_ROWS;
use crate::simd::{InstructionSet, Lanes, Mask, N_LANES, Real, Vector};

impl<I: InstructionSet> PacketRays<'_, I> {
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
                let d = self.half(&self.soa.directions, n);
                let c = center - self.half(&self.soa.origins, n);
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

    /// The vectors of a half.
    #[inline(always)]
    pub(super) fn half(&self, [x, y, z]: &[PerRay<f32>; 3], half: usize) -> Vector<I::Lanes> {
        Vector {
            x: self.set.load(&x[half]),
            y: self.set.load(&y[half]),
            z: self.set.load(&z[half]),
        }
    }
}
