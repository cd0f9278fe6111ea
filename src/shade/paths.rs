//! The paths of a wave.

use crate::geometry::Ray;
use crate::simd::{Lanes, N_LANES, Vector, lane_of, to_arrays};

/// Rays of one kind and the paths that they continue, as a structure of arrays. All
/// paths have the same number of bounces.
#[derive(Debug, Default)]
pub struct PathWave {
    /// The rays.
    pub rays: Vec<Ray>,
    /// The pixel of each ray.
    pub pixels: Vec<u32>,
    /// The index of each path's color.
    pub slots: Vec<u32>,
    /// The share of the next point's radiance that reaches the camera.
    pub weights: Vec<f32>,
    /// The number of bounces so far.
    pub depth: u32,
}

impl PathWave {
    /// Removes all rays; their paths will have had this number of bounces.
    pub fn restart(&mut self, depth: u32) {
        self.rays.clear();
        self.pixels.clear();
        self.slots.clear();
        self.weights.clear();
        self.depth = depth;
    }

    /// Adds a path that starts with each of the first `n` rays; slots ascend from
    /// `first_slot`.
    #[inline(always)]
    pub(crate) fn start<L: Lanes>(
        &mut self,
        [origin, direction]: [Vector<L>; 2],
        pixels: &[u32; N_LANES],
        first_slot: u32,
        n: usize,
    ) {
        push_rays(&mut self.rays, origin, direction, u8::MAX >> (N_LANES - n));
        self.pixels.extend_from_slice(&pixels[..n]);
        self.slots.extend(first_slot..first_slot + n as u32);
        self.weights.resize(self.rays.len(), 1.0);
    }

    /// The slots and the weights of these rays.
    #[inline(always)]
    pub(super) fn of_rays(&self, rays: &[u32; N_LANES]) -> ([u32; N_LANES], [f32; N_LANES]) {
        let (mut slots, mut weights) = ([0; N_LANES], [0.0; N_LANES]);
        for lane in 0..N_LANES {
            slots[lane] = self.slots[rays[lane] as usize];
            weights[lane] = self.weights[rays[lane] as usize];
        }
        (slots, weights)
    }
}

/// Adds the rays of these lanes.
#[inline(always)]
pub(super) fn push_rays<L: Lanes>(
    rays: &mut Vec<Ray>,
    origin: Vector<L>,
    direction: Vector<L>,
    mut lanes: u8,
) {
    let (origin, direction) = (to_arrays(origin), to_arrays(direction));
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize % N_LANES;
        lanes &= lanes - 1;
        rays.push(Ray {
            origin: lane_of(&origin, lane),
            direction: lane_of(&direction, lane),
        });
    }
}
