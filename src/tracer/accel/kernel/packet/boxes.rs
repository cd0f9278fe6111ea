//! Box test of a packet: one box against all rays, one ray per lane.

use super::rays::PacketRays;
use super::soa::{PerRay, rays_per_part};
use crate::accel::layout::WideNode;
use math::simd::{Arithmetic, InstructionSet, Vector, Wide};

impl<I: InstructionSet> PacketRays<'_, I> {
    /// Returns the rays that enter the box in this lane of a node before they leave it or reach
    /// their limits, as bits.
    #[inline(always)]
    pub(super) fn entering(&self, node: &WideNode, lane: usize, limits: &PerRay<f32>) -> u16 {
        let near = self.box_planes(node, lane, self.near_rows);
        let far = self.box_planes(node, lane, self.far_rows);
        let mut entering = 0;
        for part in 0..I::Wide::N_PARTS {
            let limits = self.set.load_wide(limits, part);
            let (enter, exit) = self.slabs(part).span(near, far, limits);
            entering |= I::Wide::bits(enter.lt(exit)) << (rays_per_part::<I>() * part);
        }
        entering
    }

    /// Returns the planes of a box in these rows.
    #[inline(always)]
    fn box_planes(&self, node: &WideNode, lane: usize, [x, y, z]: [u32; 3]) -> Vector<I::Wide> {
        Vector {
            x: self.set.splat_wide(node.row(x as usize)[lane]),
            y: self.set.splat_wide(node.row(y as usize)[lane]),
            z: self.set.splat_wide(node.row(z as usize)[lane]),
        }
    }
}
