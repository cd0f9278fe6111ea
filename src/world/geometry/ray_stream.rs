//! Many rays as a structure of arrays.

use super::ray::Ray;
use math::simd::{InstructionSet, Lanes, Mask, N_LANES, Vector, VectorColumn};

/// Rays with one array per coordinate, so that lanes of rays are loaded and stored directly.
#[derive(Debug, Clone, Default)]
pub struct RayStream {
    origins: VectorColumn,
    directions: VectorColumn,
    n: usize,
}

impl RayStream {
    /// Returns the number of rays.
    #[inline]
    pub fn len(&self) -> usize {
        self.n
    }

    /// Returns true if there are no rays.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.n == 0
    }

    /// Removes all rays.
    #[inline]
    pub fn clear(&mut self) {
        self.n = 0;
    }

    /// Adds a ray.
    #[inline]
    pub fn push(&mut self, ray: Ray) {
        self.reserve(1);
        self.origins.set(self.n, ray.origin);
        self.directions.set(self.n, ray.direction);
        self.n += 1;
    }

    /// Returns ray `i`.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Ray {
        Ray {
            origin: self.origins.get(i),
            direction: self.directions.get(i),
        }
    }

    /// Returns the origins and the directions of the rays with these indices, one per lane.
    #[inline(always)]
    pub fn gather<I: InstructionSet>(
        &self,
        set: I,
        rays: &[u32; N_LANES],
    ) -> [Vector<I::Lanes>; 2] {
        [
            self.origins.gather(set, rays),
            self.directions.gather(set, rays),
        ]
    }

    /// Returns all rays.
    #[inline]
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Ray> {
        (0..self.n).map(|i| self.get(i))
    }

    /// Makes room for `n` more rays.
    #[inline(always)]
    pub fn reserve(&mut self, n: usize) {
        self.origins.grow(self.n + n);
        self.directions.grow(self.n + n);
    }

    /// Appends the rays in the lanes of `mask`; there must be room for eight.
    #[inline(always)]
    pub fn push_lanes<L: Lanes>(&mut self, origin: Vector<L>, direction: Vector<L>, mask: L::Mask) {
        self.origins.store_lanes(self.n, origin, mask);
        self.directions.store_lanes(self.n, direction, mask);
        self.n += mask.bits().count_ones() as usize;
    }

    /// Returns the coordinates of the origins and of the directions of eight rays.
    #[inline(always)]
    pub fn lanes(&self, first: usize) -> [[&[f32; N_LANES]; 3]; 2] {
        [self.origins.lanes(first), self.directions.lanes(first)]
    }
}

impl FromIterator<Ray> for RayStream {
    fn from_iter<T: IntoIterator<Item = Ray>>(rays: T) -> Self {
        let mut stream = Self::default();
        rays.into_iter().for_each(|ray| stream.push(ray));
        stream
    }
}
