//! The paths of a wave.

use crate::geometry::RayStream;
use crate::simd::{InstructionSet, N_LANES, Vector, grow, lanes_mut};

/// Rays of one kind and the paths that they continue, as a structure of arrays. All
/// paths have the same number of bounces.
#[derive(Debug, Default)]
pub struct PathWave {
    /// The rays.
    pub rays: RayStream,
    /// The pixel of each ray, with room for whole lanes.
    pixels: Vec<u32>,
    /// The index of each path's color, with room for whole lanes.
    slots: Vec<u32>,
    /// The share of the next point's radiance that reaches the camera, with room for
    /// whole lanes.
    weights: Vec<f32>,
    /// The number of bounces so far.
    pub depth: u32,
}

impl PathWave {
    /// Removes all rays; their paths will have had this number of bounces.
    pub fn restart(&mut self, depth: u32) {
        self.rays.clear();
        self.depth = depth;
    }

    /// The pixel of each ray.
    pub fn pixels(&self) -> &[u32] {
        &self.pixels[..self.rays.len()]
    }

    /// The index of each path's color.
    pub fn slots(&self) -> &[u32] {
        &self.slots[..self.rays.len()]
    }

    /// Makes room for eight more rays.
    #[inline(always)]
    pub(crate) fn reserve(&mut self) {
        let n = self.rays.len();
        self.rays.reserve(N_LANES);
        grow(&mut self.pixels, n + N_LANES);
        grow(&mut self.slots, n + N_LANES);
        grow(&mut self.weights, n + N_LANES);
    }

    /// Adds a path that starts with each ray of the first `n` lanes; slots ascend from
    /// `first_slot`.
    #[inline(always)]
    pub(crate) fn start<I: InstructionSet>(
        &mut self,
        set: I,
        [origin, direction]: [Vector<I::Lanes>; 2],
        pixels: &[u32; N_LANES],
        first_slot: u32,
        n: usize,
    ) {
        self.reserve();
        let first = self.rays.len();
        let mask = set.mask(u8::MAX >> (N_LANES - n));
        self.rays.push_lanes(origin, direction, mask);
        *lanes_mut(&mut self.pixels, first) = *pixels;
        *lanes_mut(&mut self.weights, first) = [1.0; N_LANES];
        for (slot, lane) in lanes_mut(&mut self.slots, first).iter_mut().zip(0..) {
            *slot = first_slot + lane;
        }
    }

    /// Adds the reflected rays of these lanes, which continue the paths of `rays` of
    /// the `wave`.
    #[inline(always)]
    pub(super) fn bounce<I: InstructionSet>(
        &mut self,
        set: I,
        [origin, direction]: [Vector<I::Lanes>; 2],
        wave: &PathWave,
        rays: &[u32; N_LANES],
        reflection: f32,
        mut lanes: u8,
    ) {
        self.reserve();
        let mut next = self.rays.len();
        self.rays.push_lanes(origin, direction, set.mask(lanes));
        while lanes != 0 {
            let ray = rays[lanes.trailing_zeros() as usize % N_LANES] as usize;
            lanes &= lanes - 1;
            self.pixels[next] = wave.pixels[ray];
            self.slots[next] = wave.slots[ray];
            self.weights[next] = wave.weights[ray] * reflection;
            next += 1;
        }
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
