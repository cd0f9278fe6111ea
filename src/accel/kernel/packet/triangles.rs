//! The test of a leaf's triangles, one after the other, against all rays: the
//! arithmetic of [`LeafIntersector`](crate::accel::kernel::leaf::LeafIntersector)
//! with rays in the lanes.

use super::rays::PacketRays;
use super::soa::N_RAYS;
use crate::accel::arena::Leaf;
use crate::accel::layout::TRIANGLE_ROWS;
use crate::geometry::{AreaTest, Areas};
use crate::simd::{Arithmetic, InstructionSet, N_LANES, Vector, Wide};

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
        let zero = self.set.splat_wide(0.0);
        let n_in_part = N_RAYS / I::Wide::N_PARTS;
        for i in 0..leaf.len() {
            for part in 0..I::Wide::N_PARTS {
                let first = n_in_part * part;
                let active = active >> first & (u16::MAX >> (N_RAYS - n_in_part));
                if active == 0 {
                    continue;
                }
                let areas = Areas::new(&[
                    self.sheared(part, leaf, 0, i),
                    self.sheared(part, leaf, 3, i),
                    self.sheared(part, leaf, 6, i),
                ]);
                // Coherent rays make this branch predictable.
                if !I::Wide::bits(areas.is_missed()) & active == 0 {
                    continue;
                }
                let scale = self.set.load_wide(&self.scale, part);
                let AreaTest { hits, is_unsure, t } = areas.test(scale);
                let primitive = leaf.primitive(TRIANGLE_ROWS, i);
                let mut hits = I::Wide::bits(hits & zero.lt(t)) & active;
                let t = t.to_arrays();
                while hits != 0 {
                    let lane = hits.trailing_zeros() as usize % N_RAYS;
                    hits &= hits - 1;
                    found(first + lane, t.as_flattened()[lane], primitive);
                }
                let mut unsure = I::Wide::bits(is_unsure) & active;
                while unsure != 0 {
                    let ray = first + unsure.trailing_zeros() as usize % N_RAYS;
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
        let (shear, ray) = (self.shear(ray), self.soa.ray(ray));
        shear.intersect_exactly(leaf.triangle(i).map(|vertex| shear.point(&ray, vertex)))
    }

    /// The point with the coordinates at index `i` of three rows, in the shears of
    /// the rays of a part.
    #[inline(always)]
    fn sheared(&self, part: usize, leaf: Leaf, first: usize, i: usize) -> Vector<I::Wide> {
        let set = self.set;
        let [x, y, z] = self.shear_axes.map(|axis| axis % 3);
        let ([slope_x, slope_y], i) = (&self.slopes, i % N_LANES);
        // No closure for the three lines: it would not be inlined.
        let origins = &self.soa.origins;
        let in_x = set.splat_wide(leaf.row(first + x)[i]) - set.load_wide(&origins[x], part);
        let in_y = set.splat_wide(leaf.row(first + y)[i]) - set.load_wide(&origins[y], part);
        let in_z = set.splat_wide(leaf.row(first + z)[i]) - set.load_wide(&origins[z], part);
        Vector {
            x: in_x - set.load_wide(slope_x, part) * in_z,
            y: in_y - set.load_wide(slope_y, part) * in_z,
            z: in_z,
        }
    }
}
