//! The test of a ray against the eight boxes of a node.

use crate::accel::layout::WideNode;
use crate::geometry::Ray;
use crate::simd::{InstructionSet, Real};

/// Least magnitude of a direction's component: smaller ones are replaced by it,
/// so that reciprocals are finite and no product is NaN. Where the replacement
/// matters, the ray hits the box anyway, because of its margin.
pub(super) const MIN_DIRECTION: f32 = 1e-18;

/// The margin of boxes, relative to the largest coordinate: see [`Slabs`].
pub(super) const MARGIN: f32 = 5e-6;

/// What the tests of a ray against all boxes share.
///
/// The test enlarges the boxes by a margin that exceeds the rounding error of
/// every primitive's own test, so that no box hides a hit that brute force
/// finds: 5e-6 of the largest coordinate `l` of the ray's origin and the boxes.
///
/// With a relative rounding error of `e = 2^-24` per operation,
/// [`Shear`](crate::geometry::Shear) displaces a triangle's vertex by up to
/// `14 e l` on an axis: differences to the origin (`2`, and again `2` times a
/// slope), the slope (`4`), their product (`2`) and the last difference (`4`).
/// The error of the hit along the ray is `6 e l`: the difference (`2`), the
/// scale (`2`) and their product (`2`). Where the shear decides with 32 bits, the
/// areas add `34`: they are weights of depths that differ by up to `2 l`. The sum
/// of the weighted depths (`6`), that of the areas (`4`) and their quotient (`2`)
/// add `12`. The error of the planes here is `6 e l` for three roundings and
/// `e l` for the displaced origin. That sums up to `73 e l`, or 4.35e-6 of `l`.
///
/// The margin costs nothing per box: it displaces the origin, once for the near
/// planes and once for the far ones.
pub(super) struct Slabs<I: InstructionSet> {
    axes: [SlabAxis<I>; 3],
    /// The shift that selects the order of a node's children for this ray.
    order_shift: I::Lanes,
    /// A ray enters no box before this parameter.
    zero: I::Lanes,
}

/// One axis of the test.
struct SlabAxis<I: InstructionSet> {
    inverse_direction: I::Lanes,
    origin_of_near: I::Lanes,
    origin_of_far: I::Lanes,
    /// The first numbers of the node's rows that hold the near and the far
    /// planes.
    near_row: usize,
    far_row: usize,
}

impl<I: InstructionSet> Slabs<I> {
    /// For tests against boxes whose coordinates are at most `largest`.
    #[inline(always)]
    pub(super) fn new(set: I, ray: &Ray, largest: f32) -> Self {
        let margin = MARGIN * largest.max(ray.origin.abs().max_element());
        let axis = |i: usize| SlabAxis::new(set, i, ray.origin[i], ray.direction[i], margin);
        let down = |i: usize| u32::from(ray.direction[i].is_sign_negative()) << i;
        Self {
            axes: [axis(0), axis(1), axis(2)],
            order_shift: set.splat_bits(3 * (down(0) | down(1) | down(2))),
            zero: set.splat(0.0),
        }
    }

    /// The shift that selects the order of a node's children for this ray.
    #[inline(always)]
    pub(super) fn order_shift(&self) -> I::Lanes {
        self.order_shift
    }

    /// Where the ray enters each box, at least 0, and where it leaves the box or
    /// reaches its `limit`. It misses a box that it leaves before it enters it.
    #[inline(always)]
    pub(super) fn span(&self, set: I, node: &WideNode, limit: I::Lanes) -> (I::Lanes, I::Lanes) {
        let [x, y, z] = &self.axes;
        let (near_x, far_x) = x.planes(set, node);
        let (near_y, far_y) = y.planes(set, node);
        let (near_z, far_z) = z.planes(set, node);
        let enter = near_x.max(near_y.max(near_z)).max(self.zero);
        let exit = far_x.min(far_y).min(far_z.min(limit));
        (enter, exit)
    }
}

impl<I: InstructionSet> SlabAxis<I> {
    #[inline(always)]
    fn new(set: I, axis: usize, origin: f32, direction: f32, margin: f32) -> Self {
        // No branch on the sign: it is unpredictable.
        let is_downward = usize::from(direction.is_sign_negative());
        let outward = margin.copysign(direction);
        let steep = direction.abs().max(MIN_DIRECTION).copysign(direction);
        Self {
            inverse_direction: set.splat(steep.recip()),
            origin_of_near: set.splat(origin + outward),
            origin_of_far: set.splat(origin - outward),
            near_row: 8 * (axis + 3 * is_downward),
            far_row: 8 * (axis + 3 * (1 - is_downward)),
        }
    }

    /// Where the ray hits the near and the far plane of each box.
    #[inline(always)]
    fn planes(&self, set: I, node: &WideNode) -> (I::Lanes, I::Lanes) {
        let (near, far) = (node.row(self.near_row), node.row(self.far_row));
        (
            (set.load(near) - self.origin_of_near) * self.inverse_direction,
            (set.load(far) - self.origin_of_far) * self.inverse_direction,
        )
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::simd::{Lanes, Mask, Real, Simd, SimdKernel};

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
            let slabs = Slabs::new(set, &self.ray, 1.0);
            let (enter, exit) = slabs.span(set, &node, set.splat(self.t_max));
            let hits = enter.le(exit);
            assert_eq!(hits.bits() & !1, 0, "no ray enters a missing child");
            (hits.bits() == 1).then_some(enter.to_array()[0])
        }
    }

    /// Where the ray enters the unit cube, by every instruction set.
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
