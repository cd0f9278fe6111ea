//! Eight rays of a batch, prepared for traversal at once, one ray per lane.

use bytemuck::Zeroable;
use glam::Vec3;

use super::leaf::LeafIntersector;
use super::slab::{MARGIN, MIN_DIRECTION, Slabs};
use math::simd::{InstructionSet, Lanes, Mask, N_LANES, Real, Vector, set_lane};
use scene::geometry::{Ray, RayStream, Shear, squared_length};

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
    /// Slopes and scale of the [`Shear`], and the origin with permuted axes.
    slopes: [LaneArray; 2],
    scale: LaneArray,
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
    ///
    /// Computes the same bits as [`Slabs::new`] and [`LeafIntersector::new`].
    #[inline(always)]
    pub(super) fn prepare<I: InstructionSet>(
        &mut self,
        set: I,
        rays: &RayStream,
        indices: &[u32],
        largest: f32,
    ) {
        self.read(rays, indices);
        // Slabs: reciprocal direction, and the origin displaced by the margin.
        let [x, y, z] = &self.origin;
        let (x, y, z) = (set.load(x), set.load(y), set.load(z));
        let [dx, dy, dz] = &self.direction;
        let (dx, dy, dz) = (set.load(dx), set.load(dy), set.load(dz));
        let (ax, ay, az) = (dx.abs(), dy.abs(), dz.abs());
        let farthest = x.abs().max(y.abs()).max(z.abs());
        let margin = set.splat(MARGIN) * set.splat(largest).max(farthest);
        self.axis(set, 0, (x, dx, ax), margin);
        self.axis(set, 1, (y, dy, ay), margin);
        self.axis(set, 2, (z, dz, az), margin);
        // Shear: permute the axes as `Shear::along` does, the dominant one last.
        let (is_y, is_z) = (ax.lt(ay), ax.max(ay).lt(az));
        (self.is_y, self.is_z) = (is_y.bits(), is_z.bits());
        let dominant =
            |if_x, if_y, if_z| I::Lanes::select(is_z, if_z, I::Lanes::select(is_y, if_y, if_x));
        let scale = set.splat(1.0) / dominant(dx, dy, dz);
        self.scale = scale.to_array();
        self.slopes[0] = (dominant(dy, dz, dx) * scale).to_array();
        self.slopes[1] = (dominant(dz, dx, dy) * scale).to_array();
        self.permuted_origin[0] = dominant(y, z, x).to_array();
        self.permuted_origin[1] = dominant(z, x, y).to_array();
        self.permuted_origin[2] = dominant(x, y, z).to_array();
        // Spheres: the squared length of the direction.
        let [a, inverse_a] = squared_length(set.load_vector(&self.direction));
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

    /// Prepares one axis of the slab test, as [`Slabs::new`] does.
    #[inline(always)]
    fn axis<I: InstructionSet>(
        &mut self,
        set: I,
        axis: usize,
        (origin, direction, size): (I::Lanes, I::Lanes, I::Lanes),
        margin: I::Lanes,
    ) {
        let outward = margin.flip_sign_by(direction);
        let steep = size.max(set.splat(MIN_DIRECTION)).flip_sign_by(direction);
        self.inverse_direction[axis] = (set.splat(1.0) / steep).to_array();
        self.origin_of_near[axis] = (origin + outward).to_array();
        self.origin_of_far[axis] = (origin - outward).to_array();
        self.is_downward[axis] = direction.signs();
    }

    /// Returns the slabs of the ray in this lane.
    #[inline(always)]
    pub(super) fn slabs(&self, lane: usize) -> Slabs {
        let lane = lane % N_LANES;
        let [x, y, z] = self.is_downward.map(|axis| usize::from(axis >> lane & 1));
        Slabs::of_octant(
            x | y << 1 | z << 2,
            at(&self.inverse_direction, lane),
            at(&self.origin_of_near, lane),
            at(&self.origin_of_far, lane),
        )
    }

    /// Returns the leaf intersector of the ray in this lane.
    #[inline(always)]
    pub(super) fn intersector(&self, lane: usize) -> LeafIntersector {
        let lane = lane % N_LANES;
        let (is_y, is_z) = (self.is_y >> lane & 1, self.is_z >> lane & 1);
        let shear = Shear {
            axes: Shear::AXES[usize::from((is_y | is_z) << is_z)],
            slopes: [self.slopes[0][lane], self.slopes[1][lane]],
            scale: self.scale[lane],
        };
        LeafIntersector {
            ray: Ray {
                origin: Vec3::from(at(&self.origin, lane)),
                direction: Vec3::from(at(&self.direction, lane)),
            },
            squared_length: [self.squared_length[0][lane], self.squared_length[1][lane]],
            shear,
            permuted_origin: at(&self.permuted_origin, lane),
        }
    }
}

/// Returns the vector of the ray in this lane.
#[inline(always)]
fn at([x, y, z]: &[LaneArray; 3], lane: usize) -> [f32; 3] {
    [x[lane], y[lane], z[lane]]
}
