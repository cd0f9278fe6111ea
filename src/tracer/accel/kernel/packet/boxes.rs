//! Box test of a packet: one box against all rays, one ray per lane.

use super::rays::PacketRays;
use super::soa::{PerRay, rays_per_part};
use crate::accel::layout::WideNode;
use math::simd::{Arithmetic, InstructionSet, Wide};

impl<I: InstructionSet> PacketRays<'_, I> {
    /// Returns the rays that enter the box in this lane of a node before they leave it or reach
    /// their limits, as bits.
    #[inline(always)]
    pub(super) fn entering(&self, node: &WideNode, lane: usize, limits: &PerRay<f32>) -> u16 {
        let mut entering = 0;
        for part in 0..I::Wide::N_PARTS {
            let limits = self.set.load_wide(limits, part);
            let rays = self.part_entering(node, lane, limits, part);
            entering |= rays << (rays_per_part::<I>() * part);
        }
        entering
    }

    #[inline(always)]
    fn part_entering(&self, node: &WideNode, lane: usize, limits: I::Wide, part: usize) -> u16 {
        let (near_x, far_x) = self.slab(node, lane, part, 0);
        let (near_y, far_y) = self.slab(node, lane, part, 1);
        let (near_z, far_z) = self.slab(node, lane, part, 2);
        let zero = self.set.splat_wide(0.0);
        let enter = near_x.max(near_y).max(near_z.max(zero));
        let exit = far_x.min(far_y).min(far_z.min(limits));
        I::Wide::bits(enter.le(exit))
    }

    /// Returns where the rays hit the near and the far plane of a box on this axis.
    #[inline(always)]
    fn slab(&self, node: &WideNode, lane: usize, part: usize, axis: usize) -> (I::Wide, I::Wide) {
        let (set, slab) = (self.set, &self.slabs[axis]);
        let near = set.splat_wide(node.row(self.near_rows[axis])[lane]);
        let far = set.splat_wide(node.row(self.far_rows[axis])[lane]);
        let inverse_direction = set.load_wide(&slab.inverse_direction, part);
        (
            (near - set.load_wide(&slab.origin_of_near, part)) * inverse_direction,
            (far - set.load_wide(&slab.origin_of_far, part)) * inverse_direction,
        )
    }
}
