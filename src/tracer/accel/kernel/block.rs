//! Eight rays of a batch, prepared for traversal at once, one ray per lane.

use bytemuck::Zeroable;

use super::leaf::LeafIntersector;
use super::slab::{SlabSetup, Slabs};
use math::simd::{InstructionSet, Lanes, Mask, N_LANES, Vector, lane_of, set_lane, to_arrays};
use world::geometry::{
    Ray, RayStream, Shear, dominant_axis, permuted_by, shear_constants, squared_length,
};

/// One number for each of eight rays.
pub(super) type LaneArray = [f32; N_LANES];

/// Eight prepared rays.
#[derive(Zeroable)]
pub(super) struct RayBlock {
    origin: [LaneArray; 3],
    direction: [LaneArray; 3],
    inverse_direction: [LaneArray; 3],
    origin_of_near: [LaneArray; 3],
    origin_of_far: [LaneArray; 3],
    /// Constants of the [`Shear`], and the origin with permuted axes.
    shear_constants: [LaneArray; 3],
    permuted_origin: [LaneArray; 3],
    /// Squared length of the direction, and its reciprocal.
    squared_length: [LaneArray; 2],
    /// Bit masks of the rays that point down each axis.
    is_downward: [u8; 3],
    /// Bit masks of the rays whose dominant axis is y, and z.
    is_y: u8,
    is_z: u8,
}

impl RayBlock {
    /// Reads the rays with the first eight of these indices.
    #[inline(always)]
    fn read(&mut self, rays: &RayStream, indices: &[u32]) {
        for (lane, &index) in indices.iter().enumerate().take(N_LANES) {
            let Ray { origin, direction } = rays.get(index as usize);
            set_lane(&mut self.origin, lane, origin);
            set_lane(&mut self.direction, lane, direction);
        }
    }

    /// Prepares the rays with the first eight of these indices for boxes whose coordinates are at
    /// most `largest`.
    #[inline(always)]
    pub(super) fn prepare<I: InstructionSet>(
        &mut self,
        set: I,
        rays: &RayStream,
        indices: &[u32],
        largest: f32,
    ) {
        self.read(rays, indices);
        let [origin, direction] = self.rays(set);
        // Slabs for boxes.
        let slabs = SlabSetup::new(origin, direction, set.splat(largest));
        self.inverse_direction = to_arrays(slabs.inverse_direction);
        self.origin_of_near = to_arrays(slabs.origin_of_near);
        self.origin_of_far = to_arrays(slabs.origin_of_far);
        let Vector { x, y, z } = direction;
        self.is_downward = [x.signs(), y.signs(), z.signs()];
        // Shear for triangles.
        let dominant = dominant_axis(direction);
        self.shear_constants = to_arrays(shear_constants(permuted_by(direction, dominant)));
        self.permuted_origin = to_arrays(permuted_by(origin, dominant));
        (self.is_y, self.is_z) = (dominant.0.bits(), dominant.1.bits());
        // Spheres: the squared length of the direction.
        let (a, inverse_a) = squared_length(direction);
        self.squared_length = [a.to_array(), inverse_a.to_array()];
    }

    /// Returns the origins and the directions.
    #[inline(always)]
    pub(super) fn rays<I: InstructionSet>(&self, set: I) -> [Vector<I::Lanes>; 2] {
        [
            set.load_vector(&self.origin),
            set.load_vector(&self.direction),
        ]
    }

    /// Returns the slabs of the ray in this lane.
    #[inline(always)]
    pub(super) fn slabs(&self, lane: usize) -> Slabs {
        let lane = lane % N_LANES;
        let [x, y, z] = &self.is_downward;
        let octant = x >> lane & 1 | (y >> lane & 1) << 1 | (z >> lane & 1) << 2;
        let setup = SlabSetup {
            inverse_direction: lane_of(&self.inverse_direction, lane).into(),
            origin_of_near: lane_of(&self.origin_of_near, lane).into(),
            origin_of_far: lane_of(&self.origin_of_far, lane).into(),
        };
        Slabs::from_octant(octant.into(), setup)
    }

    /// Returns the leaf intersector of the ray in this lane.
    #[inline(always)]
    pub(super) fn intersector(&self, lane: usize) -> LeafIntersector {
        let lane = lane % N_LANES;
        let [is_y, is_z] = [self.is_y, self.is_z].map(|lanes| lanes >> lane & 1 != 0);
        let shear = Shear {
            axes: Shear::axes(is_y, is_z),
            constants: lane_of(&self.shear_constants, lane),
        };
        LeafIntersector {
            ray: Ray {
                origin: lane_of(&self.origin, lane),
                direction: lane_of(&self.direction, lane),
            },
            squared_length: (self.squared_length[0][lane], self.squared_length[1][lane]),
            shear,
            permuted_origin: lane_of(&self.permuted_origin, lane),
        }
    }
}
