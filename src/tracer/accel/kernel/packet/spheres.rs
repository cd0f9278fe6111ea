//! Sphere test of a packet: a leaf's spheres one after the other against all rays. The arithmetic
//! of [`LeafIntersector`](crate::accel::kernel::leaf::LeafIntersector) with one ray per lane.

use super::rays::PacketRays;
use super::searches::Searches;
use super::soa::{PerRay, active_in_part};
use crate::accel::arena::Leaf;
use crate::accel::layout::SPHERE_ROWS;
use crate::accel::search::Queries;
use math::simd::{Arithmetic, InstructionSet, N_LANES, Vector, Wide};

impl<I: InstructionSet> PacketRays<'_, I> {
    /// Tests spheres and reports the hits.
    #[inline(always)]
    pub(super) fn spheres<Q: Queries>(
        &self,
        leaf: Leaf,
        active: u16,
        searches: &mut Searches<'_, I, Q>,
    ) {
        let set = self.set;
        let zero = set.splat_wide(0.0);
        for i in 0..leaf.len() {
            let lane = i % N_LANES;
            let center = Vector {
                x: set.splat_wide(leaf.row(0)[lane]),
                y: set.splat_wide(leaf.row(1)[lane]),
                z: set.splat_wide(leaf.row(2)[lane]),
            };
            let r2 = set.splat_wide(leaf.row(3)[lane]);
            for part in 0..I::Wide::N_PARTS {
                // Quadratic, as in `LeafIntersector`.
                let active = active_in_part::<I>(active, part);
                if active == 0 {
                    continue;
                }
                let d = self.part(&self.soa.directions, part);
                let c = center - self.part(&self.soa.origins, part);
                let a = d.dot(d);
                let inverse_a = set.splat_wide(1.0) / a;
                let b = c.dot(d);
                let nearest = c - d * (b * inverse_a);
                let discriminant = r2 - nearest.dot(nearest);
                let is_hit = zero.le(discriminant);
                // Skip the roots if every active ray misses.
                if I::Wide::bits(is_hit) & active == 0 {
                    continue;
                }
                // A negative discriminant gives NaN, in lanes that are masked already.
                let q = b + (a * discriminant).sqrt().flip_sign_by(b);
                let (t0, t1) = ((c.dot(c) - r2) / q, q * inverse_a);
                let (near, far) = (t0.min(t1), t1.max(t0));
                let t = I::Wide::select(zero.lt(near), near, far);
                let hits = I::Wide::bits(is_hit & zero.lt(t)) & active;
                searches.found_in_part(part, hits, t, leaf.primitive(SPHERE_ROWS, i));
            }
        }
    }

    /// Returns the vectors of a part.
    #[inline(always)]
    fn part(&self, [x, y, z]: &[PerRay<f32>; 3], part: usize) -> Vector<I::Wide> {
        Vector {
            x: self.set.load_wide(x, part),
            y: self.set.load_wide(y, part),
            z: self.set.load_wide(z, part),
        }
    }
}
