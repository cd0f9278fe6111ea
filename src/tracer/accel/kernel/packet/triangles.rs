//! Triangle test of a packet: a leaf's triangles one after the other against all rays, one ray per
//! lane.

use super::rays::PacketRays;
use super::searches::Searches;
use super::soa::{N_RAYS, active_in_part, rays_per_part};
use crate::accel::arena::Leaf;
use crate::accel::layout::TRIANGLE_ROWS;
use crate::accel::search::Queries;
use math::simd::{Arithmetic, InstructionSet, N_LANES, Vector, Wide};
use world::geometry::{AreaTest, Areas, sheared};

impl<I: InstructionSet> PacketRays<'_, I> {
    /// Tests triangles and reports the hits.
    #[inline(always)]
    pub(super) fn triangles<Q: Queries>(
        &self,
        leaf: Leaf,
        active: u16,
        searches: &mut Searches<'_, I, Q>,
    ) {
        let zero = self.set.splat_wide(0.0);
        let [x, y, z] = self.shear_axes;
        let (x, y, z) = (leaf.coordinate(x), leaf.coordinate(y), leaf.coordinate(z));
        for i in 0..leaf.len() {
            let lane = i % N_LANES;
            for part in 0..I::Wide::N_PARTS {
                let active = active_in_part::<I>(active, part);
                if active == 0 {
                    continue;
                }
                // Shear the vertices, and compare the areas of the three sub-triangles.
                let areas = Areas::new(&[
                    self.sheared(part, [x[0][lane], y[0][lane], z[0][lane]]),
                    self.sheared(part, [x[1][lane], y[1][lane], z[1][lane]]),
                    self.sheared(part, [x[2][lane], y[2][lane], z[2][lane]]),
                ]);
                // Skip the depths if every active ray misses. Coherent rays make this branch
                // predictable.
                if !I::Wide::bits(areas.is_missed()) & active == 0 {
                    continue;
                }
                let scale = self.set.load_wide(&self.shear_constants[2], part);
                // Report the hits at the weighted depths.
                let AreaTest { hits, is_unsure, t } = areas.test(scale);
                let primitive = leaf.primitive(TRIANGLE_ROWS, i);
                let hits = I::Wide::bits(hits & zero.lt(t)) & active;
                searches.found_in_part(part, hits, t, primitive);
                // Repeat exactly the tests that rounding may have decided.
                let mut unsure = I::Wide::bits(is_unsure) & active;
                while unsure != 0 {
                    let lane = unsure.trailing_zeros() as usize % N_RAYS;
                    let ray = rays_per_part::<I>() * part + lane;
                    unsure &= unsure - 1;
                    match self.intersect_exactly(ray, leaf, i) {
                        Some(t) if t > 0.0 => searches.found(ray, t, primitive),
                        _ => {}
                    }
                }
            }
        }
    }

    /// Returns the parameter of a ray's hit on a triangle where rounding may decide.
    #[cold]
    #[inline(never)]
    fn intersect_exactly(&self, ray: usize, leaf: Leaf, i: usize) -> Option<f32> {
        let (shear, ray) = (self.shear(ray), self.soa.ray(ray));
        shear.intersect_exactly(shear.points(&ray, leaf.triangle(i)))
    }

    /// Returns a point, given in the order of the shears' axes, in the shear space of each ray of a
    /// part.
    #[inline(always)]
    fn sheared(&self, part: usize, [x, y, z]: [f32; 3]) -> Vector<I::Wide> {
        let set = self.set;
        let [origin_x, origin_y, origin_z] = &self.permuted_origins;
        let from_origin = Vector {
            x: set.splat_wide(x) - set.load_wide(origin_x, part),
            y: set.splat_wide(y) - set.load_wide(origin_y, part),
            z: set.splat_wide(z) - set.load_wide(origin_z, part),
        };
        sheared(from_origin, self.part(&self.shear_constants, part))
    }
}
