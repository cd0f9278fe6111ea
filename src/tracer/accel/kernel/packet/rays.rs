//! The rays of a packet, prepared for traversal, one per lane.

use super::soa::{N_HALVES, PerRay, RaySoa};
use crate::accel::kernel::leaf::LeafIntersector;
use crate::accel::kernel::slab::{MARGIN, MIN_DIRECTION};
use math::simd::{InstructionSet, Lanes, N_LANES, Real};
use scene::geometry::Shear;

/// The rays of a packet, prepared for tests.
pub(super) struct PacketRays<'c, I: InstructionSet> {
    pub(super) set: I,
    pub(super) soa: &'c RaySoa,
    pub(super) slabs: [RaySlab; 3],
    /// Slopes and scales of the rays' [`Shear`]s.
    pub(super) slopes: [PerRay<f32>; 2],
    pub(super) scale: PerRay<f32>,
    /// True for each axis that the rays point down.
    pub(super) is_downward: [bool; 3],
    /// Offsets of the node's rows that hold the near and the far planes of each axis.
    pub(super) near_rows: [usize; 3],
    pub(super) far_rows: [usize; 3],
    /// Axes of the rays' [`Shear`]s, and the origins with permuted axes.
    pub(super) shear_axes: [usize; 3],
    pub(super) permuted_origins: [&'c PerRay<f32>; 3],
}

/// One axis of the rays' slab test: see [`Slabs`](crate::accel::kernel::slab::Slabs).
pub(super) struct RaySlab {
    pub(super) inverse_direction: PerRay<f32>,
    pub(super) origin_of_near: PerRay<f32>,
    pub(super) origin_of_far: PerRay<f32>,
}

impl RaySlab {
    /// Memory for one axis.
    const EMPTY: Self = Self {
        inverse_direction: [[0.0; N_LANES]; N_HALVES],
        origin_of_near: [[0.0; N_LANES]; N_HALVES],
        origin_of_far: [[0.0; N_LANES]; N_HALVES],
    };
}

impl<'c, I: InstructionSet> PacketRays<'c, I> {
    /// Prepares the rays for tests against boxes whose coordinates are at most `largest`.
    #[inline(always)]
    pub(super) fn new(set: I, soa: &'c RaySoa, largest: f32) -> Self {
        let direction = soa.ray(0).direction;
        let shear_axes = Shear::along(direction).axes;
        let [x, y, z] = direction.to_array().map(f32::is_sign_negative);
        let row = |axis: usize, is_max: bool| N_LANES * (axis + 3 * usize::from(is_max));
        let mut rays = Self {
            set,
            soa,
            slabs: [const { RaySlab::EMPTY }; 3],
            slopes: [[[0.0; N_LANES]; N_HALVES]; 2],
            scale: [[0.0; N_LANES]; N_HALVES],
            is_downward: [x, y, z],
            near_rows: [row(0, x), row(1, y), row(2, z)],
            far_rows: [row(0, !x), row(1, !y), row(2, !z)],
            shear_axes,
            permuted_origins: shear_axes.map(|axis| &soa.origins[axis % 3]),
        };
        rays.prepare(0, largest);
        rays.prepare(1, largest);
        rays
    }

    /// Prepares the rays of a half for tests against boxes whose coordinates are at most `largest`.
    #[inline(always)]
    fn prepare(&mut self, half: usize, largest: f32) {
        let (set, soa) = (self.set, self.soa);
        // Slabs: reciprocal direction, and the origin displaced by the margin.
        let [x, y, z] = &soa.origins;
        let (x, y, z) = (set.load(&x[half]), set.load(&y[half]), set.load(&z[half]));
        let farthest = x.abs().max(y.abs()).max(z.abs());
        let margin = set.splat(MARGIN) * set.splat(largest).max(farthest);
        self.slabs[0].prepare(set, half, x, set.load(&soa.directions[0][half]), margin);
        self.slabs[1].prepare(set, half, y, set.load(&soa.directions[1][half]), margin);
        self.slabs[2].prepare(set, half, z, set.load(&soa.directions[2][half]), margin);
        // Shear: permute the axes as `Shear::along` does; all rays share the dominant one.
        let [x, y, z] = self.shear_axes.map(|axis| axis % 3);
        let scale = set.splat(1.0) / set.load(&soa.directions[z][half]);
        self.scale[half] = scale.to_array();
        self.slopes[0][half] = (set.load(&soa.directions[x][half]) * scale).to_array();
        self.slopes[1][half] = (set.load(&soa.directions[y][half]) * scale).to_array();
    }

    /// Returns the leaf intersector of the ray in this lane, which has primitives in the lanes.
    #[inline(always)]
    pub(super) fn intersector(&self, lane: usize) -> LeafIntersector {
        LeafIntersector::with_shear(&self.soa.ray(lane), self.shear(lane))
    }

    /// Returns the shear of a ray.
    #[inline(always)]
    pub(super) fn shear(&self, ray: usize) -> Shear {
        let (half, lane) = (ray / N_LANES % N_HALVES, ray % N_LANES);
        let [slope_x, slope_y] = &self.slopes;
        Shear {
            axes: self.shear_axes,
            slopes: [slope_x[half][lane], slope_y[half][lane]],
            scale: self.scale[half][lane],
        }
    }
}

impl RaySlab {
    #[inline(always)]
    fn prepare<I: InstructionSet>(
        &mut self,
        set: I,
        half: usize,
        origin: I::Lanes,
        direction: I::Lanes,
        margin: I::Lanes,
    ) {
        let outward = margin.flip_sign_by(direction);
        let steep = direction
            .abs()
            .max(set.splat(MIN_DIRECTION))
            .flip_sign_by(direction);
        self.inverse_direction[half] = (set.splat(1.0) / steep).to_array();
        self.origin_of_near[half] = (origin + outward).to_array();
        self.origin_of_far[half] = (origin - outward).to_array();
    }
}

/// Returns the greatest of the rays' numbers.
#[inline(always)]
pub(super) fn greatest<I: InstructionSet>(set: I, [a, b]: &PerRay<f32>) -> f32 {
    let lanes = set.load(a).max(set.load(b));
    let [a, b, c, d, ..] = lanes.max(lanes.swap_halves()).to_array();
    Real::max(Real::max(a, b), Real::max(c, d))
}

/// Returns the least of the rays' numbers.
#[inline(always)]
pub(super) fn least<I: InstructionSet>(set: I, [a, b]: &PerRay<f32>) -> f32 {
    let lanes = set.load(a).min(set.load(b));
    let [a, b, c, d, ..] = lanes.min(lanes.swap_halves()).to_array();
    Real::min(Real::min(a, b), Real::min(c, d))
}
