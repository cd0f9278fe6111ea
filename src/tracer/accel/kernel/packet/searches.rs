//! The searches of a packet's rays, one per lane.

use super::rays::greatest;
use super::soa::{N_HALVES, N_RAYS, PerRay, rays_per_part};
use crate::accel::search::{LaneSearch, Queries, Search};
use math::simd::{Arithmetic, InstructionSet, N_LANES, Wide};
use world::scene::Primitive;

/// The states of the searches, field by field.
pub(super) struct Searches<'a, I, Q> {
    set: I,
    queries: &'a Q,
    primitives: &'a [Primitive],
    /// Index of the first query.
    first: usize,
    /// Limit of each ray; negative infinity once the ray is finished.
    pub(super) limits: PerRay<f32>,
    /// Primitives of the nearest hits so far.
    nearest: PerRay<u32>,
    /// The largest limit at the last call of [`update_farthest`](Self::update_farthest).
    pub(super) farthest: f32,
    /// True if a limit has changed since then.
    is_changed: bool,
}

impl<'a, I: InstructionSet, Q: Queries> Searches<'a, I, Q> {
    /// Starts the searches of the queries from index `first` on.
    #[inline(always)]
    pub(super) fn new(set: I, queries: &'a Q, first: usize, primitives: &'a [Primitive]) -> Self {
        let mut limits = [[0.0; N_LANES]; N_HALVES];
        for (lane, limit) in limits.as_flattened_mut().iter_mut().enumerate() {
            *limit = queries.search(first + lane, primitives).limit();
        }
        Self {
            set,
            queries,
            primitives,
            first,
            farthest: greatest(set, &limits),
            limits,
            nearest: [[u32::MAX; N_LANES]; N_HALVES],
            is_changed: false,
        }
    }

    /// Returns the search of a ray.
    #[inline(always)]
    pub(super) fn get(&self, ray: usize) -> Q::Search<'a> {
        let (half, lane) = (ray / N_LANES % N_HALVES, ray % N_LANES);
        let search = self.queries.search(self.first + ray, self.primitives);
        search.resumed(self.limits[half][lane], self.nearest[half][lane])
    }

    /// Replaces the search of a ray.
    #[inline(always)]
    pub(super) fn set(&mut self, ray: usize, search: &Q::Search<'a>) {
        let (half, lane) = (ray / N_LANES % N_HALVES, ray % N_LANES);
        (self.limits[half][lane], self.nearest[half][lane]) = search.state();
        self.is_changed = true;
    }

    /// Reports a ray's hit on a primitive.
    #[inline(always)]
    pub(super) fn found(&mut self, ray: usize, t: f32, primitive: u32) {
        if t < self.limits.as_flattened()[ray % N_RAYS] {
            let mut search = self.get(ray);
            search.found(t, primitive);
            self.set(ray, &search);
        }
    }

    /// Reports the hits of the rays of a part on a primitive.
    #[inline(always)]
    pub(super) fn found_in_part(&mut self, part: usize, hits: u16, t: I::Wide, primitive: u32) {
        // Select the rays whose hit is nearer than their limit.
        let set = self.set;
        let limits = set.load_wide(&self.limits, part);
        let nearer = hits & I::Wide::bits(t.lt(limits));
        if nearer == 0 {
            return;
        }
        // Decide which rays are updated in lanes, and which one by one.
        let (next, mut single) = if Q::Search::NEAREST_FIRST {
            // At equal distance the primitive decides.
            let next = t.next_up();
            (next, nearer & !I::Wide::bits(next.lt(limits)))
        } else {
            let all = if self.queries.ignores() { nearer } else { 0 };
            (set.splat_wide(f32::NEG_INFINITY), all)
        };
        // Update limits and nearest primitives in lanes.
        let lanes = set.wide_mask(nearer & !single);
        I::Wide::select(lanes, next, limits).store(&mut self.limits, part);
        if Q::Search::NEAREST_FIRST {
            let nearest = bytemuck::cast_mut::<_, PerRay<f32>>(&mut self.nearest);
            let of_part = set.load_wide(nearest, part);
            let primitive = set.splat_wide(f32::from_bits(primitive));
            I::Wide::select(lanes, primitive, of_part).store(nearest, part);
        }
        self.is_changed = true;
        // Update the remaining rays one by one.
        let t = t.to_arrays();
        while single != 0 {
            let lane = single.trailing_zeros() as usize % N_RAYS;
            single &= single - 1;
            let ray = rays_per_part::<I>() * part + lane;
            self.found(ray, t.as_flattened()[lane], primitive);
        }
    }

    /// Returns the finished rays, as bits.
    #[inline(always)]
    pub(super) fn finished(&self) -> u16 {
        let least = self.set.splat_wide(f32::NEG_INFINITY);
        let mut finished = 0;
        for part in 0..I::Wide::N_PARTS {
            let limits = self.set.load_wide(&self.limits, part);
            finished |= I::Wide::bits(limits.le(least)) << (rays_per_part::<I>() * part);
        }
        finished
    }

    /// Recomputes the largest limit if a limit has changed.
    #[inline(always)]
    pub(super) fn update_farthest(&mut self) {
        if self.is_changed {
            self.farthest = greatest(self.set, &self.limits);
            self.is_changed = false;
        }
    }
}
