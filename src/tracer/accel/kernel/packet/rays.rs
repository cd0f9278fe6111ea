//! The rays of a packet, prepared for traversal, one per lane.

use super::soa::{N_HALVES, PerRay, RaySoa, at};
use crate::accel::kernel::leaf::LeafIntersector;
use crate::accel::kernel::slab::{SlabSetup, rows};
use math::simd::{Arithmetic, InstructionSet, Lanes, N_LANES, Vector};
use world::geometry::{Shear, shear_constants};

/// The rays of a packet, prepared for tests.
pub(super) struct PacketRays<'c, I: InstructionSet> {
    pub(super) set: I,
    pub(super) soa: &'c RaySoa,
    // The rays' `SlabSetup`.
    pub(super) inverse_direction: [PerRay<f32>; 3],
    pub(super) origin_of_near: [PerRay<f32>; 3],
    pub(super) origin_of_far: [PerRay<f32>; 3],
    /// The octant of the directions: bit `i` is set if the rays point down axis `i`.
    pub(super) octant: u32,
    /// Offsets of the node's rows that hold the near and the far planes of each axis.
    pub(super) near_rows: [u32; 3],
    pub(super) far_rows: [u32; 3],
    /// Axes of the rays' [`Shear`]s, and the origins with permuted axes.
    pub(super) shear_axes: [usize; 3],
    pub(super) permuted_origins: [&'c PerRay<f32>; 3],
    /// Constants of the [`Shear`]s.
    pub(super) shear_constants: [PerRay<f32>; 3],
}

/// Memory for three numbers of each ray.
const EMPTY: [PerRay<f32>; 3] = [[[0.0; N_LANES]; N_HALVES]; 3];

impl<'c, I: InstructionSet> PacketRays<'c, I> {
    /// Prepares the rays for tests against boxes whose coordinates are at most `largest`.
    #[inline(always)]
    pub(super) fn new(set: I, soa: &'c RaySoa, largest: f32) -> Self {
        let direction = soa.ray(0).direction;
        let shear_axes = Shear::along(direction).axes;
        let octant = direction.is_negative_bitmask();
        let [near_rows, far_rows] = rows(octant);
        let mut rays = Self {
            set,
            soa,
            inverse_direction: EMPTY,
            origin_of_near: EMPTY,
            origin_of_far: EMPTY,
            octant,
            near_rows,
            far_rows,
            shear_axes,
            permuted_origins: shear_axes.map(|axis| &soa.origins[axis % 3]),
            shear_constants: EMPTY,
        };
        rays.prepare(0, largest);
        rays.prepare(1, largest);
        rays
    }

    /// Prepares the rays of a half for tests against boxes whose coordinates are at most `largest`.
    /// Two divisions of eight lanes take less time than one of sixteen.
    #[inline(always)]
    fn prepare(&mut self, half: usize, largest: f32) {
        let (set, soa) = (self.set, self.soa);
        let [x, y, z] = self.shear_axes;
        // Slabs for boxes.
        let origin = self.half(&soa.origins, half);
        let slabs = SlabSetup::new(origin, self.half(&soa.directions, half), set.splat(largest));
        store(slabs.inverse_direction, &mut self.inverse_direction, half);
        store(slabs.origin_of_near, &mut self.origin_of_near, half);
        store(slabs.origin_of_far, &mut self.origin_of_far, half);
        // Shear for triangles; all rays share the dominant axis.
        let permuted = Vector {
            x: set.load(&soa.directions[x % 3][half]),
            y: set.load(&soa.directions[y % 3][half]),
            z: set.load(&soa.directions[z % 3][half]),
        };
        store(shear_constants(permuted), &mut self.shear_constants, half);
    }

    /// Returns the vectors of a half.
    #[inline(always)]
    pub(super) fn half(&self, [x, y, z]: &[PerRay<f32>; 3], half: usize) -> Vector<I::Lanes> {
        self.set.load_vector(&[x[half], y[half], z[half]])
    }

    /// Returns the vectors of a part.
    #[inline(always)]
    pub(super) fn part(&self, [x, y, z]: &[PerRay<f32>; 3], part: usize) -> Vector<I::Wide> {
        Vector {
            x: self.set.load_wide(x, part),
            y: self.set.load_wide(y, part),
            z: self.set.load_wide(z, part),
        }
    }

    /// Returns the set-up of the slab test of a part.
    #[inline(always)]
    pub(super) fn slabs(&self, part: usize) -> SlabSetup<I::Wide> {
        SlabSetup {
            inverse_direction: self.part(&self.inverse_direction, part),
            origin_of_near: self.part(&self.origin_of_near, part),
            origin_of_far: self.part(&self.origin_of_far, part),
        }
    }

    /// Returns the leaf intersector of the ray in this lane, which has primitives in the lanes.
    #[inline(always)]
    pub(super) fn intersector(&self, lane: usize) -> LeafIntersector {
        LeafIntersector::with_shear(&self.soa.ray(lane), self.shear(lane))
    }

    /// Returns the shear of a ray.
    #[inline(always)]
    pub(super) fn shear(&self, ray: usize) -> Shear {
        Shear {
            axes: self.shear_axes,
            constants: at(&self.shear_constants, ray),
        }
    }
}

/// Stores the vectors of a half.
#[inline(always)]
fn store<L: Lanes>(vectors: Vector<L>, [x, y, z]: &mut [PerRay<f32>; 3], half: usize) {
    x[half] = vectors.x.to_array();
    y[half] = vectors.y.to_array();
    z[half] = vectors.z.to_array();
}

/// Returns the greatest of the rays' numbers.
#[inline(always)]
pub(super) fn greatest<I: InstructionSet>(set: I, [a, b]: &PerRay<f32>) -> f32 {
    let lanes = set.load(a).max(set.load(b));
    let [a, b, c, d, ..] = lanes.max(lanes.swap_halves()).to_array();
    Arithmetic::max(Arithmetic::max(a, b), Arithmetic::max(c, d))
}

/// Returns the least of the rays' numbers.
#[inline(always)]
pub(super) fn least<I: InstructionSet>(set: I, [a, b]: &PerRay<f32>) -> f32 {
    let lanes = set.load(a).min(set.load(b));
    let [a, b, c, d, ..] = lanes.min(lanes.swap_halves()).to_array();
    Arithmetic::min(Arithmetic::min(a, b), Arithmetic::min(c, d))
}
