//! Slab test: one ray against the eight boxes of a node.

use crate::accel::layout::WideNode;
use math::simd::{InstructionSet, Real};
use scene::geometry::{Aabb, Ray};

/// Least magnitude of a direction's component: smaller ones are replaced by it, so that reciprocals
/// are finite and no product is NaN. Where the replacement matters, the ray hits the box anyway,
/// because of its margin.
pub(super) const MIN_DIRECTION: f32 = 1e-18;

/// Margin of boxes relative to the largest coordinate: see [`Slabs`].
pub(super) const MARGIN: f32 = 5e-6;

/// Offsets of the node's rows that hold the near planes of each axis, by the octant of the
/// direction.
const ROWS: [[u32; 3]; 8] = {
    let mut rows = [[0; 3]; 8];
    let mut i = 0;
    while i < 24 {
        let (octant, axis) = (i / 3, i % 3);
        let is_downward = octant >> axis & 1;
        rows[octant][axis] = 8 * (axis + 3 * is_downward) as u32;
        i += 1;
    }
    rows
};

/// Set-up of a ray, shared by its tests against all boxes.
///
/// The test enlarges the boxes by a margin that exceeds the rounding error of every primitive's
/// test, so that no box hides a hit that brute force finds: 5e-6 of the largest coordinate `l` of
/// the ray's origin and the boxes.
///
/// With a relative rounding error of `e = 2^-24` per operation, [`Shear`](scene::geometry::Shear)
/// displaces a triangle's vertex by up to `14 e l` on an axis: differences to the origin (`2`, and
/// again `2` times a slope), the slope (`4`), their product (`2`) and the last difference (`4`).
/// The error of the hit along the ray is `6 e l`: the difference (`2`), the scale (`2`) and their
/// product (`2`). Where 32 bits decide, the areas add `36`: they are weights of depths that differ
/// by up to `2 l`. The sum of the weighted depths (`6`), the sum of the areas (`4`) and their
/// quotient (`2`) add `12`. The error of the planes here is `6 e l` for three roundings and `e l`
/// for the displaced origin. The total is `75 e l`, or 4.47e-6 of `l`.
///
/// The margin costs nothing per box: it displaces the origin, once for the near planes and once for
/// the far ones.
pub(in crate::accel) struct Slabs {
    inverse_direction: [f32; 3],
    origin_of_near: [f32; 3],
    origin_of_far: [f32; 3],
    /// Offsets of the node's rows that hold the near and the far planes of each axis.
    near_rows: [u32; 3],
    far_rows: [u32; 3],
    /// The shift that selects the order of a node's children for this ray.
    order_shift: u32,
}

impl Slabs {
    /// Prepares a ray for tests against boxes whose coordinates are at most `largest`.
    #[inline(always)]
    pub(in crate::accel) fn new(ray: &Ray, largest: f32) -> Self {
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        let [x, y, z] = origin.map(f32::abs);
        let margin = MARGIN * largest.max(x).max(y).max(z);
        let (mut inverse, mut near, mut far) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        let mut octant = 0;
        for axis in 0..3 {
            let (origin, direction) = (origin[axis], direction[axis]);
            // Find the octant. No branch on the sign: it is unpredictable.
            octant |= (direction.to_bits() >> 31) << axis;
            // Displace the origin outward by the margin; take the reciprocal of a direction that is
            // never 0.
            let outward = margin.copysign(direction);
            let steep = direction.abs().max(MIN_DIRECTION).copysign(direction);
            inverse[axis] = steep.recip();
            near[axis] = origin + outward;
            far[axis] = origin - outward;
        }
        Self::of_octant(octant as usize, inverse, near, far)
    }

    /// Prepares a ray that points to this octant: bit `i` is set if it points down axis `i`.
    #[inline(always)]
    pub(super) fn of_octant(
        octant: usize,
        inverse_direction: [f32; 3],
        origin_of_near: [f32; 3],
        origin_of_far: [f32; 3],
    ) -> Self {
        let octant = octant % 8;
        Self {
            inverse_direction,
            origin_of_near,
            origin_of_far,
            near_rows: ROWS[octant],
            far_rows: ROWS[7 - octant],
            order_shift: 3 * octant as u32,
        }
    }

    /// Returns the shift that selects the order of a node's children for this ray.
    #[inline(always)]
    pub(super) fn order_shift(&self) -> u32 {
        self.order_shift
    }

    /// Returns where the ray enters each box, at least 0, and where it leaves the box or reaches
    /// its `limit`. It misses a box that it leaves before entering.
    #[inline(always)]
    pub(super) fn span<I: InstructionSet>(
        &self,
        set: I,
        node: &WideNode,
        limit: I::Lanes,
    ) -> (I::Lanes, I::Lanes) {
        let (near_x, far_x) = self.planes(set, node, 0);
        let (near_y, far_y) = self.planes(set, node, 1);
        let (near_z, far_z) = self.planes(set, node, 2);
        let enter = near_x.max(near_y).max(near_z.max(set.splat(0.0)));
        let exit = far_x.min(far_y).min(far_z.min(limit));
        (enter, exit)
    }

    /// Returns where the ray enters a box, at least 0, and where it leaves it: the
    /// [`span`](Self::span) of a single box, to the bit.
    pub(in crate::accel) fn span_of(&self, bounds: &Aabb) -> (f32, f32) {
        let (mut enter, mut exit) = (0.0_f32, f32::INFINITY);
        for axis in 0..3 {
            let (min, max) = (bounds.min[axis], bounds.max[axis]);
            // Rows from 24 on hold maxima.
            let (near, far) = match self.near_rows[axis] {
                0..24 => (min, max),
                _ => (max, min),
            };
            let inverse_direction = self.inverse_direction[axis];
            enter = enter.max((near - self.origin_of_near[axis]) * inverse_direction);
            exit = exit.min((far - self.origin_of_far[axis]) * inverse_direction);
        }
        (enter, exit)
    }

    /// Returns where the ray hits the near and the far plane of each box.
    #[inline(always)]
    fn planes<I: InstructionSet>(
        &self,
        set: I,
        node: &WideNode,
        axis: usize,
    ) -> (I::Lanes, I::Lanes) {
        let near = set.load(node.row(self.near_rows[axis] as usize));
        let far = set.load(node.row(self.far_rows[axis] as usize));
        let inverse_direction = set.splat(self.inverse_direction[axis]);
        (
            (near - set.splat(self.origin_of_near[axis])) * inverse_direction,
            (far - set.splat(self.origin_of_far[axis])) * inverse_direction,
        )
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use math::simd::{Lanes, Mask, Real, Simd, SimdKernel};

    /// Tests a ray against a node whose only child is the unit cube.
    struct EnterCube {
        ray: Ray,
        t_max: f32,
    }

    impl SimdKernel for EnterCube {
        type Output = Option<f32>;

        #[inline(always)]
        fn run<I: InstructionSet>(self, set: I) -> Option<f32> {
            let mut node = WideNode::EMPTY;
            for axis in 0..3 {
                (node.min[axis][0], node.max[axis][0]) = (0.0, 1.0);
            }
            let slabs = Slabs::new(&self.ray, 1.0);
            let (enter, exit) = slabs.span(set, &node, set.splat(self.t_max));
            let hits = enter.le(exit);
            assert_eq!(hits.bits() & !1, 0, "no ray enters a missing child");
            (hits.bits() == 1).then_some(enter.to_array()[0])
        }
    }

    /// Returns where the ray enters the unit cube, the same for every instruction set.
    fn enter(origin: [f32; 3], direction: [f32; 3], t_max: f32) -> Option<f32> {
        let ray = Ray {
            origin: origin.into(),
            direction: Vec3::from(direction).normalize(),
        };
        let all = Simd::available()
            .into_iter()
            .map(|simd| simd.run(EnterCube { ray, t_max }));
        let all: Vec<_> = all.collect();
        assert!(all.iter().all(|t| *t == all[0]), "{all:?}");
        all[0]
    }

    #[test]
    fn rays_enter_hit_boxes_and_miss_others() {
        let t = enter([0.5, 0.5, -2.0], [0.0, 0.0, 1.0], 9.0).unwrap();
        assert!((t - 2.0).abs() < 1e-4);
        assert_eq!(enter([0.5, 0.5, 0.5], [0.0, -1.0, 0.0], 9.0), Some(0.0));
        assert_eq!(enter([0.5, 0.5, -2.0], [0.0, 0.0, 1.0], 1.5), None);
        assert_eq!(enter([0.5, 0.5, -2.0], [0.0, 0.0, -1.0], 9.0), None);
        assert_eq!(enter([1.5, 0.5, -2.0], [0.0, 0.0, 1.0], 9.0), None);
    }

    #[test]
    fn rays_in_a_face_enter_the_box() {
        for x in [0.0, 1.0] {
            assert!(enter([x, 0.5, -2.0], [0.0, 0.0, 1.0], 9.0).is_some());
            assert!(enter([x, 0.5, -2.0], [-0.0, 0.0, 1.0], 9.0).is_some());
        }
    }
}
