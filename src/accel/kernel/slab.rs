//! The test of a ray against the eight boxes of a node.

use crate::accel::layout::Node;
use crate::accel::simd::{InstructionSet, Lanes, N_LANES};
use crate::geometry::Ray;

/// Directions below this along an axis count as this: their reciprocals stay
/// finite, and no product is NaN. Where it matters the box is hit in any case,
/// by its margin.
const MIN_DIRECTION: f32 = 1e-18;

/// What a ray's tests against many boxes have in common.
///
/// The boxes grow by a margin that is larger than the rounding of any
/// primitive's own test, so that a box never hides a hit that brute force
/// finds: 1e-6 of the largest coordinate of the ray's origin and the boxes.
/// Growing costs nothing a box: it moves the origin, once for the lower planes
/// and once for the upper ones.
pub(super) struct Slabs<L> {
    axes: [Axis<L>; 3],
    zero: L,
}

/// One axis: its two planes of a box by where the ray meets them first.
#[derive(Clone, Copy)]
struct Axis<L> {
    /// Whether the ray goes down and meets the upper plane first.
    is_downward: bool,
    inverse_direction: L,
    origin_of_near: L,
    origin_of_far: L,
}

impl<L: Lanes> Slabs<L> {
    /// For tests against boxes whose coordinates are at most `largest`.
    #[inline(always)]
    pub(super) fn new<I: InstructionSet<Lanes = L>>(set: I, ray: &Ray, largest: f32) -> Self {
        let margin = 1e-6 * largest.max(ray.origin.abs().max_element());
        let (o, d) = (ray.origin, ray.direction);
        Self {
            axes: [
                Axis::new(set, o.x, d.x, margin),
                Axis::new(set, o.y, d.y, margin),
                Axis::new(set, o.z, d.z, margin),
            ],
            zero: set.splat(0.0),
        }
    }

    /// Where the ray enters each box, at least 0, and whether it does so at
    /// `limit` at the latest.
    #[inline(always)]
    pub(super) fn enter<I>(&self, set: I, node: &Node, limit: L) -> (L, L::Mask)
    where
        I: InstructionSet<Lanes = L>,
    {
        let [x, y, z] = &self.axes;
        let (near_x, far_x) = x.planes(set, &node.min[0], &node.max[0]);
        let (near_y, far_y) = y.planes(set, &node.min[1], &node.max[1]);
        let (near_z, far_z) = z.planes(set, &node.min[2], &node.max[2]);
        // Zero last: of -0 and 0 that gives 0, whose bits can be sorted.
        let enter = near_x.max(near_y.max(near_z)).max(self.zero);
        let exit = far_x.min(far_y).min(far_z.min(limit));
        (enter, enter.le(exit))
    }
}

impl<L: Lanes> Axis<L> {
    #[inline(always)]
    fn new<I>(set: I, origin: f32, direction: f32, margin: f32) -> Self
    where
        I: InstructionSet<Lanes = L>,
    {
        let is_downward = direction.is_sign_negative();
        let outward = if is_downward { -margin } else { margin };
        let steep = direction.abs().max(MIN_DIRECTION).copysign(direction);
        Self {
            is_downward,
            inverse_direction: set.splat(steep.recip()),
            origin_of_near: set.splat(origin + outward),
            origin_of_far: set.splat(origin - outward),
        }
    }

    /// Where the ray meets the nearer and the farther plane of each box.
    #[inline(always)]
    fn planes<I>(&self, set: I, min: &[f32; N_LANES], max: &[f32; N_LANES]) -> (L, L)
    where
        I: InstructionSet<Lanes = L>,
    {
        let (near, far) = if self.is_downward {
            (max, min)
        } else {
            (min, max)
        };
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
    use crate::accel::simd::{Mask, Simd, Work};

    /// Enters a node whose only child is the unit cube.
    struct EnterCube {
        ray: Ray,
        t_max: f32,
    }

    impl Work for EnterCube {
        type Output = Option<f32>;

        #[inline(always)]
        fn run<I: InstructionSet>(self, set: I) -> Option<f32> {
            let mut node = Node::EMPTY;
            for axis in 0..3 {
                (node.min[axis][0], node.max[axis][0]) = (0.0, 1.0);
            }
            let slabs = Slabs::new(set, &self.ray, 1.0);
            let (enter, hits) = slabs.enter(set, &node, set.splat(self.t_max));
            assert_eq!(
                hits.bits() & !1,
                0,
                "nothing enters a child that is not there"
            );
            (hits.bits() == 1).then_some(enter.to_array()[0])
        }
    }

    /// Where the ray enters the unit cube, on all instruction sets alike.
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
