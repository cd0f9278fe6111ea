//! Sphere test of a packet: a leaf's spheres one after the other against all rays, one ray per lane.

use super::rays::PacketRays;
use super::searches::Searches;
use super::soa::active_in_part;
use crate::accel::arena::Leaf;
use crate::accel::layout::SPHERE_ROWS;
use crate::accel::search::Queries;
use math::simd::{Arithmetic, InstructionSet, N_LANES, Vector, Wide};
use world::geometry::{SphereEquation, squared_length};

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
                let active = active_in_part::<I>(active, part);
                if active == 0 {
                    continue;
                }
                let to_center = center - self.part(&self.soa.origins, part);
                let direction = self.part(&self.soa.directions, part);
                let a = squared_length(direction);
                let equation = SphereEquation::new(to_center, r2, direction, a);
                // Skip the roots if every active ray misses.
                let is_hit = equation.hits();
                if I::Wide::bits(is_hit) & active == 0 {
                    continue;
                }
                let t = equation.first();
                let hits = I::Wide::bits(is_hit & zero.lt(t)) & active;
                searches.found_in_part(part, hits, t, leaf.primitive(SPHERE_ROWS, i));
            }
        }
    }
}
