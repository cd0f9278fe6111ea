//! Plane test of a packet: planes one after the other against all rays.

use super::rays::PacketRays;
use super::searches::Searches;
use super::soa::{N_HALVES, RaySoa};
use crate::accel::search::Queries;
use math::simd::{Arithmetic, InstructionSet, Lanes, N_LANES, Wide};
use world::geometry::Plane;

impl<I: InstructionSet> PacketRays<'_, I> {
    /// Tests planes, each given with its index, and reports the hits.
    #[inline(always)]
    pub(super) fn planes<Q: Queries>(
        &self,
        planes: &[(u32, Plane)],
        searches: &mut Searches<'_, I, Q>,
    ) {
        let RaySoa {
            origins,
            directions,
        } = self.soa;
        let zero = self.set.splat_wide(0.0);
        for (primitive, plane) in planes {
            let mut t = [[0.0; N_LANES]; N_HALVES];
            for (half, t) in t.iter_mut().enumerate() {
                let (origin, direction) = (self.half(origins, half), self.half(directions, half));
                *t = plane.hits_of_lanes(origin, direction).to_array();
            }
            for part in 0..I::Wide::N_PARTS {
                let t = self.set.load_wide(&t, part);
                let hits = I::Wide::bits(zero.lt(t));
                searches.found_in_part(part, hits, t, *primitive);
            }
        }
    }
}
