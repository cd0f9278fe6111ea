//! Primitives outside the hierarchy, tested against every ray.

use super::search::Search;
use math::simd::{Arithmetic, InstructionSet, Lanes, Mask, N_LANES, Vector};
use world::geometry::{Intersectable, Plane, Ray, Shape};
use world::scene::Primitive;

/// The unbounded primitives; with brute force, all primitives.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Unbounded {
    /// Planes, tested against rays in lanes, with their indices.
    planes: Vec<(u32, Plane)>,
    /// Primitives tested one by one.
    others: Vec<u32>,
}

impl Unbounded {
    /// Returns the unbounded primitives with these indices.
    pub(super) fn new(primitives: &[Primitive], indices: Vec<u32>) -> Self {
        let mut unbounded = Self::default();
        for index in indices {
            match primitives[index as usize].world_shape() {
                Some(Shape::Plane(plane)) => unbounded.planes.push((index, *plane)),
                _ => unbounded.others.push(index),
            }
        }
        unbounded
    }

    /// Returns these primitives, all tested one by one.
    pub(super) fn one_by_one(others: Vec<u32>) -> Self {
        Self {
            planes: Vec::new(),
            others,
        }
    }

    /// Returns the indices of all primitives.
    pub(super) fn indices(&self) -> impl Iterator<Item = u32> {
        let planes = self.planes.iter().map(|(index, _)| *index);
        planes.chain(self.others.iter().copied())
    }

    /// Returns the planes, with their indices.
    #[inline(always)]
    pub(super) fn planes(&self) -> &[(u32, Plane)] {
        &self.planes
    }

    /// Returns the number of primitives.
    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.planes.len() + self.others.len()
    }

    /// Tests all primitives against one ray.
    #[inline]
    pub(super) fn test<S: Search>(&self, ray: &Ray, search: &mut S) {
        for (primitive, plane) in &self.planes {
            if S::RECORDS {
                search.test(ray, *primitive);
            } else if let Some(t) = plane.intersect(ray, search.limit()) {
                search.found(t, *primitive);
            }
        }
        self.test_others(ray, search);
    }

    /// Tests the primitives that are not planes against one ray.
    #[inline(always)]
    pub(super) fn test_others<S: Search>(&self, ray: &Ray, search: &mut S) {
        for &primitive in &self.others {
            search.test(ray, primitive);
        }
    }

    /// Returns true if all primitives are planes.
    #[inline(always)]
    pub(super) fn are_planes(&self) -> bool {
        self.others.is_empty()
    }

    /// Tests the planes against a ray per lane. Calls `found` for each hit before the limit of its
    /// ray, with the lane, the parameter and the primitive.
    #[inline(always)]
    pub(super) fn test_planes<I: InstructionSet>(
        &self,
        set: I,
        origin: Vector<I::Lanes>,
        direction: Vector<I::Lanes>,
        limits: I::Lanes,
        mut found: impl FnMut(usize, f32, u32),
    ) {
        for (primitive, plane) in &self.planes {
            let t = plane.hits_of_lanes(origin, direction);
            let mut hits = (set.splat(0.0).lt(t) & t.lt(limits)).bits();
            let t = t.to_array();
            while hits != 0 {
                let lane = hits.trailing_zeros() as usize % N_LANES;
                hits &= hits - 1;
                found(lane, t[lane], *primitive);
            }
        }
    }
}
