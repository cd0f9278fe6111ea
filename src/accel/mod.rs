//! Primitives → the nearest hit, or whether there is one.
//!
//! Two structures with the same answers: [`Bvh`], and the brute force that
//! tests everything and so is the truth that the other is held to. Planes have
//! no bounds and stay outside the hierarchy. Of two hits at the same distance
//! the primitive with the lower number counts.

mod bvh;
mod search;
mod slab;

use crate::config::Acceleration;
use crate::cost::Probe;
use crate::geometry::Ray;
use crate::scene::{ObjectId, Primitive};

pub use bvh::{Bvh, BvhStatistics};
use search::{Any, Nearest, Search};

/// A ray's hit on a primitive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Parameter along the ray, greater than 0.
    pub t: f32,
    /// The primitive's index in the scene.
    pub primitive: u32,
}

/// The structure that finds hits.
#[derive(Debug, Clone)]
pub struct Accel<'a> {
    primitives: &'a [Primitive],
    /// Primitives to test against every ray: the planes, or all.
    always: Vec<u32>,
    bvh: Option<Bvh>,
}

impl<'a> Accel<'a> {
    /// Builds the structure of this kind over the primitives, fewer than 2^32.
    pub fn new(primitives: &'a [Primitive], kind: Acceleration) -> Self {
        let all = 0..primitives.len() as u32;
        let (always, bvh) = match kind {
            Acceleration::BruteForce => (all.collect(), None),
            Acceleration::Bvh => {
                let (planes, bounded): (Vec<u32>, Vec<u32>) =
                    all.partition(|&i| primitives[i as usize].is_unbounded());
                (planes, Some(Bvh::new(primitives, bounded)))
            }
        };
        Self {
            primitives,
            always,
            bvh,
        }
    }

    /// The hierarchy's size; `None` for brute force.
    pub fn statistics(&self) -> Option<BvhStatistics> {
        self.bvh.as_ref().map(Bvh::statistics)
    }

    /// The nearest hit of the ray with `t > 0`.
    pub fn nearest<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        let mut nearest = Nearest::new(self.primitives, ray);
        let n_visits = self.search(ray, &mut nearest);
        probe.traversal(n_visits, nearest.n_tests);
        nearest.hit
    }

    /// Whether anything is hit with `t` in (0, `t_max`) that does not belong
    /// to `ignored`.
    ///
    /// Brute force tests all primitives even after a hit: its count of tests
    /// is rays times primitives.
    pub fn occluded<P: Probe>(
        &self,
        ray: &Ray,
        t_max: f32,
        ignored: Option<ObjectId>,
        probe: &mut P,
    ) -> bool {
        let mut any = Any::new(self.primitives, ray, t_max, ignored);
        let n_visits = self.search(ray, &mut any);
        probe.traversal(n_visits, any.n_tests);
        any.found
    }

    /// Shows what the ray may hit to the search; gives the nodes entered.
    fn search<S: Search>(&self, ray: &Ray, search: &mut S) -> u32 {
        self.always
            .iter()
            .for_each(|&primitive| search.test(primitive));
        match &self.bvh {
            Some(bvh) => bvh.traverse(ray, search),
            None => 0,
        }
    }
}
