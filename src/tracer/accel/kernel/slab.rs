//! Slab test: rays against boxes.

use crate::accel::layout::WideNode;
use math::simd::{Arithmetic, InstructionSet, Vector};
use world::geometry::{Aabb, Ray, dominant_axis};

/// Least magnitude of a direction's component: smaller ones are replaced by it, so that reciprocals
/// are finite and no product is NaN. Where the replacement matters, the ray hits the box anyway,
/// because of its margin.
const MIN_DIRECTION: f32 = 1e-18;

/// Margin of boxes relative to the largest coordinate: see [`SlabSetup`].
const MARGIN: f32 = 7e-6;

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

/// Set-up of the test, for one ray or one per lane.
///
/// The test enlarges the boxes by a margin that exceeds the rounding error of every primitive's
/// test, so that no box hides a hit that brute force finds: 7e-6 of the largest coordinate `l` of
/// the ray's origin and the boxes.
///
/// With a relative rounding error of `e = 2^-24` per operation, [`Shear`](world::geometry::Shear)
/// displaces a triangle's vertex by up to `14 e l` on an axis: differences to the origin (`2`, and
/// again `2` times a slope), the slope (`4`), their product (`2`) and the last difference (`4`).
/// The error of the hit along the ray is `6 e l`: the difference (`2`), the scale (`2`) and their
/// product (`2`). Where 32 bits decide, the areas add `36`: they are weights of depths that differ
/// by up to `2 l`. The sum of the weighted depths (`6`), the sum of the areas (`4`) and their
/// quotient (`2`) add `12`. The error of the planes here is `6 e l` for three roundings and `e l`
/// for the displaced origin. The total is `75 e l`, or 4.47e-6 of `l`. If a triangle is split, the
/// areas count twice, since the hit and the computed point may lie in neighboring parts: the total
/// is `111 e l`, or 6.62e-6.
///
/// **The far plane of the direction's dominant axis has no margin**, so that a ray that leaves a
/// surface does not enter the boxes behind it, such as flat ones of the same surface. Differences
/// keep their sign when they are rounded: no depth of a triangle that ends before the origin on that
/// axis is positive, nor is their mean. If only a part of it ends there, the computed hit is close
/// to the next part, as above. Other primitives keep to their boxes, too: see `box_of`. Along this
/// axis, which shear leaves as it is, a hit exceeds the depths by at most the `12 e l` of the mean,
/// and the error of the plane is `7 e l`: together 1.14e-6 of `l`. The ray moves most along this
/// axis, so the near planes of the others make up for it with a margin that is larger by a fifth.
///
/// The margin costs nothing per box: it displaces the origin, once for the near planes and once for
/// the far ones.
pub struct SlabSetup<R> {
    /// The reciprocal of the direction, or of the least one that is not 0.
    pub inverse_direction: Vector<R>,
    /// The origin of the ray for near planes.
    pub origin_of_near: Vector<R>,
    /// The origin of the ray for far planes.
    pub origin_of_far: Vector<R>,
}

impl<R: Arithmetic> SlabSetup<R> {
    /// Prepares rays for tests against boxes whose coordinates are at most `largest`.
    #[inline(always)]
    pub fn new(origin: Vector<R>, direction: Vector<R>, largest: R) -> Self {
        let Vector { x, y, z } = origin;
        let farthest = x.abs().max(y.abs()).max(z.abs());
        let margin = x.splat(MARGIN) * largest.max(farthest);
        // Displace the origin outward by the margin.
        let Vector { x, y, z } = direction;
        let outward = Vector {
            x: margin.flip_sign_by(x),
            y: margin.flip_sign_by(y),
            z: margin.flip_sign_by(z),
        };
        let (is_y, is_z) = dominant_axis(direction);
        let zero = x.splat(0.0);
        let fifth = x.splat(0.2);
        let aside = Vector {
            x: R::select(is_z | is_y, outward.x, zero),
            y: R::select(is_z, outward.y, R::select(is_y, zero, outward.y)),
            z: R::select(is_z, zero, outward.z),
        };
        Self {
            inverse_direction: Vector {
                x: reciprocal(x),
                y: reciprocal(y),
                z: reciprocal(z),
            },
            origin_of_near: origin + (outward + aside * fifth),
            origin_of_far: origin - aside,
        }
    }

    /// Returns where rays enter boxes with these near and far planes, at least 0, and where they
    /// leave them or reach their `limit`. A ray enters a box only if it leaves it later.
    #[inline(always)]
    pub fn span(&self, near: Vector<R>, far: Vector<R>, limit: R) -> (R, R) {
        let near = (near - self.origin_of_near).times(self.inverse_direction);
        let far = (far - self.origin_of_far).times(self.inverse_direction);
        let enter = near.x.max(near.y).max(near.z.max(limit.splat(0.0)));
        let exit = far.x.min(far.y).min(far.z.min(limit));
        (enter, exit)
    }
}

/// Returns the reciprocal of a direction's component, or of a larger one that is not 0.
#[inline(always)]
fn reciprocal<R: Arithmetic>(direction: R) -> R {
    let size = direction.abs().max(direction.splat(MIN_DIRECTION));
    direction.splat(1.0) / size.flip_sign_by(direction)
}

impl SlabSetup<f32> {
    /// Returns the same set-up in all lanes.
    #[inline(always)]
    fn splat<I: InstructionSet>(&self, set: I) -> SlabSetup<I::Lanes> {
        SlabSetup {
            inverse_direction: set.splat_vector(self.inverse_direction.into()),
            origin_of_near: set.splat_vector(self.origin_of_near.into()),
            origin_of_far: set.splat_vector(self.origin_of_far.into()),
        }
    }
}

/// A ray, prepared for tests against the boxes of nodes.
pub(in crate::accel) struct Slabs {
    setup: SlabSetup<f32>,
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
        let setup = SlabSetup::new(ray.origin.into(), ray.direction.into(), largest);
        Self::from_octant(ray.direction.is_negative_bitmask(), setup)
    }

    /// Prepares a ray that points to this octant: bit `i` is set if it points down axis `i`.
    #[inline(always)]
    pub(super) fn from_octant(octant: u32, setup: SlabSetup<f32>) -> Self {
        let [near_rows, far_rows] = rows(octant);
        Self {
            setup,
            near_rows,
            far_rows,
            order_shift: 3 * octant,
        }
    }

    /// Returns the shift that selects the order of a node's children for this ray.
    #[inline(always)]
    pub(super) fn order_shift(&self) -> u32 {
        self.order_shift
    }

    /// Returns the [`span`](SlabSetup::span) of each box.
    #[inline(always)]
    pub(super) fn span<I: InstructionSet>(
        &self,
        set: I,
        node: &WideNode,
        limit: I::Lanes,
    ) -> (I::Lanes, I::Lanes) {
        let near = planes(set, node, self.near_rows);
        let far = planes(set, node, self.far_rows);
        self.setup.splat(set).span(near, far, limit)
    }

    /// Returns where the ray enters a box, at least 0, and where it leaves it.
    pub(in crate::accel) fn span_of(&self, bounds: &Aabb) -> (f32, f32) {
        let (mut near, mut far) = (bounds.min, bounds.max);
        for axis in 0..3 {
            // Rows from 24 on hold maxima.
            if self.near_rows[axis] >= 24 {
                (near[axis], far[axis]) = (far[axis], near[axis]);
            }
        }
        self.setup.span(near.into(), far.into(), f32::INFINITY)
    }
}

/// Returns the offsets of a node's rows that hold the near and the far planes of each axis, for
/// rays to this octant.
#[inline(always)]
pub(super) fn rows(octant: u32) -> [[u32; 3]; 2] {
    let octant = octant as usize % 8;
    [ROWS[octant], ROWS[7 - octant]]
}

/// Loads these rows of planes.
#[inline(always)]
fn planes<I: InstructionSet>(set: I, node: &WideNode, [x, y, z]: [u32; 3]) -> Vector<I::Lanes> {
    Vector {
        x: set.load(node.row(x as usize)),
        y: set.load(node.row(y as usize)),
        z: set.load(node.row(z as usize)),
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use math::simd::{Lanes, Mask, Simd, SimdKernel};

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
            let hits = enter.lt(exit);
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
    fn rays_do_not_enter_a_box_that_ends_at_their_origin_on_the_dominant_axis() {
        for (z, is_entered) in [(1.0, false), (1_f32.next_down(), true)] {
            let entered = enter([0.5, 0.5, z], [0.1, 0.2, 1.0], 9.0).is_some();
            assert_eq!(entered, is_entered, "{z}");
        }
        // Shear moves vertices on the other axes.
        assert!(enter([0.5, 0.5, 1.0], [1.0, 0.2, 0.9], 9.0).is_some());
    }

    #[test]
    fn rays_in_a_face_enter_the_box() {
        for x in [0.0, 1.0] {
            assert!(enter([x, 0.5, -2.0], [0.0, 0.0, 1.0], 9.0).is_some());
            assert!(enter([x, 0.5, -2.0], [-0.0, 0.0, 1.0], 9.0).is_some());
        }
    }
}
