//! Beam test: all rays of a packet at once against the eight boxes of a node.

use super::rays::{PacketRays, greatest, least};
use crate::accel::layout::WideNode;
use crate::accel::search::Search;
use math::simd::{Arithmetic, InstructionSet, Lanes, Mask, N_LANES};

/// Bounds of all rays of a packet: on each axis the extremes of the origins and of the reciprocal
/// directions, which have the same sign.
///
/// No ray of the packet enters a box that the beam misses, in floating-point arithmetic. Proof:
/// consider an axis that the rays point up, where `inverse > 0`, and `(plane - origin) * inverse`
/// for one ray. Correct rounding is monotonic: `a <= b` implies `fl(a) <= fl(b)`. So the difference
/// is at least the difference for the greatest origin, and so is its product with the ray's
/// `inverse`; the product of a number with `inverse` lies between its products with the least and
/// the greatest `inverse`, whatever its sign. So the lesser of these two products, for the greatest
/// origin, is a lower bound for the ray. Likewise the greater of the two, for the least origin, is
/// an upper bound. Where the rays point down, the product decreases with the difference, and the
/// origins are exchanged. Maxima, minima and the largest limit are monotonic, too. So if a ray has
/// `enter < exit`, then `enter(beam) <= enter < exit <= exit(beam)`.
pub(super) struct Beam<I: InstructionSet> {
    axes: [BeamAxis<I>; 3],
    /// The shift that selects the order of a node's children for these rays.
    order_shift: u32,
}

/// One axis of the beam test.
struct BeamAxis<I: InstructionSet> {
    inverse_min: I::Lanes,
    inverse_max: I::Lanes,
    origin_of_near: I::Lanes,
    origin_of_far: I::Lanes,
    near_row: usize,
    far_row: usize,
}

impl<I: InstructionSet> Beam<I> {
    #[inline(always)]
    pub(super) fn around(rays: &PacketRays<I>) -> Self {
        Self {
            axes: [
                BeamAxis::around(rays, 0),
                BeamAxis::around(rays, 1),
                BeamAxis::around(rays, 2),
            ],
            order_shift: 3 * rays.octant,
        }
    }

    /// Returns the boxes that the beam enters before it leaves them or reaches the largest limit,
    /// as bits, and where it enters each. Both in reverse order of the visits.
    #[inline(always)]
    pub(super) fn entered<S: Search>(
        &self,
        set: I,
        node: &WideNode,
        farthest: f32,
    ) -> (u8, [f32; N_LANES]) {
        let [x, y, z] = &self.axes;
        // Bound where any ray enters and leaves each box.
        let (near_x, far_x) = x.planes(set, node);
        let (near_y, far_y) = y.planes(set, node);
        let (near_z, far_z) = z.planes(set, node);
        let enter = near_x.max(near_y.max(near_z)).max(set.splat(0.0));
        let exit = far_x.min(far_y).min(far_z.min(set.splat(farthest)));
        if !S::NEAREST_FIRST {
            return (enter.lt(exit).bits(), enter.to_array());
        }
        let shift = set.splat_bits(self.order_shift);
        // Put the boxes into reverse order of the visits.
        let enter = enter.permute(&node.order, shift);
        let exit = exit.permute(&node.order, shift);
        (enter.lt(exit).bits(), enter.to_array())
    }

    /// Returns the lane of the child at this position of the reverse order of the visits.
    #[inline(always)]
    pub(super) fn lane<S: Search>(&self, node: &WideNode, position: usize) -> usize {
        if S::NEAREST_FIRST {
            (node.order[position] >> self.order_shift) as usize % N_LANES
        } else {
            position
        }
    }
}

impl<I: InstructionSet> BeamAxis<I> {
    #[inline(always)]
    fn around(rays: &PacketRays<I>, axis: usize) -> Self {
        let set = rays.set;
        let (of_near, of_far) = (&rays.origin_of_near[axis], &rays.origin_of_far[axis]);
        let (of_near, of_far) = if rays.octant >> axis & 1 != 0 {
            (least(set, of_near), greatest(set, of_far))
        } else {
            (greatest(set, of_near), least(set, of_far))
        };
        let inverse_direction = &rays.inverse_direction[axis];
        Self {
            inverse_min: set.splat(least(set, inverse_direction)),
            inverse_max: set.splat(greatest(set, inverse_direction)),
            origin_of_near: set.splat(of_near),
            origin_of_far: set.splat(of_far),
            near_row: rays.near_rows[axis] as usize,
            far_row: rays.far_rows[axis] as usize,
        }
    }

    /// Returns a lower bound for where the rays hit the near plane of each box, and an upper bound
    /// for the far plane.
    #[inline(always)]
    fn planes(&self, set: I, node: &WideNode) -> (I::Lanes, I::Lanes) {
        let near = set.load(node.row(self.near_row)) - self.origin_of_near;
        let far = set.load(node.row(self.far_row)) - self.origin_of_far;
        (
            (near * self.inverse_min).min(near * self.inverse_max),
            (far * self.inverse_min).max(far * self.inverse_max),
        )
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::accel::kernel::packet::soa::RaySoa;
    use crate::accel::search::NearestHit;
    use math::sampling::uniform;
    use math::simd::{Simd, SimdKernel};
    use world::geometry::Ray;

    /// Boxes of any size around the origin, and coherent rays.
    fn random(i: u64) -> (WideNode, [Ray; 16]) {
        let vector = |k| {
            let [x, y, z, _] = uniform([5, i, k]);
            2.0 * Vec3::new(x, y, z) - 1.0
        };
        let mut node = WideNode::EMPTY;
        for lane in 0..N_LANES {
            let (center, half) = (vector(lane as u64), 0.5 * vector(8 + lane as u64).abs());
            for axis in 0..3 {
                node.min[axis][lane] = center[axis] - half[axis];
                node.max[axis][lane] = center[axis] + half[axis];
                node.order[lane] = 0o1111_1111 * lane as u32;
            }
        }
        let ray = |k| Ray {
            origin: 2.0 * vector(16) + 0.1 * vector(20 + k),
            direction: (vector(17) + 0.05 * vector(40 + k)).normalize(),
        };
        (node, std::array::from_fn(|k| ray(k as u64)))
    }

    /// The boxes that the beam hits, and the boxes that a ray enters.
    struct Entered(WideNode, [Ray; 16]);

    impl SimdKernel for Entered {
        type Output = [u8; 2];

        #[inline(always)]
        fn run<I: InstructionSet>(self, set: I) -> [u8; 2] {
            let Self(node, rays) = self;
            let mut soa = RaySoa::EMPTY;
            soa.fill(&rays.into_iter().collect(), 0);
            let incoherent = !soa.coherent_with_first(set);
            soa.replace_by_first(incoherent);
            let rays = PacketRays::new(set, &soa, 2.0);
            let (hit, _) = Beam::around(&rays).entered::<NearestHit>(set, &node, f32::INFINITY);
            let limits = [[f32::INFINITY; N_LANES]; 2];
            let is_entered = |lane| rays.entering(&node, lane, &limits) != 0;
            let entered = (0..N_LANES).map(|lane| u8::from(is_entered(lane)) << lane);
            [hit, entered.sum()]
        }
    }

    #[test]
    fn a_beam_hits_each_box_that_a_ray_enters() {
        for simd in Simd::available() {
            let (mut n_hit, mut n_entered) = (0, 0);
            for i in 0..3000 {
                let (node, rays) = random(i);
                let [hit, entered] = simd.run(Entered(node, rays));
                assert_eq!(entered & !hit, 0, "{simd}, node {i}");
                n_hit += hit.count_ones();
                n_entered += entered.count_ones();
            }
            // And few other boxes.
            assert!(n_entered > 500, "{n_entered}");
            assert!(n_hit < 2 * n_entered, "{n_hit} of {n_entered}");
        }
    }
}
