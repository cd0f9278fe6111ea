//! What a ray looks for: its nearest hit, or any.

use super::Hit;
use crate::geometry::Ray;
use crate::scene::{ObjectId, Primitive};

/// A search that a structure shows primitives to.
pub(super) trait Search {
    /// Hits beyond this parameter do not count.
    fn t_max(&self) -> f32;
    /// Whether no further primitive can change the answer.
    fn is_done(&self) -> bool;
    /// Tests the primitive with this index.
    fn test(&mut self, primitive: u32);
}

/// The search for a ray's nearest hit.
pub(super) struct Nearest<'a> {
    primitives: &'a [Primitive],
    ray: &'a Ray,
    pub(super) hit: Option<Hit>,
    pub(super) n_tests: u32,
}

impl<'a> Nearest<'a> {
    pub(super) fn new(primitives: &'a [Primitive], ray: &'a Ray) -> Self {
        Self {
            primitives,
            ray,
            hit: None,
            n_tests: 0,
        }
    }
}

impl Search for Nearest<'_> {
    #[inline]
    fn t_max(&self) -> f32 {
        self.hit.map_or(f32::INFINITY, |hit| hit.t)
    }

    fn is_done(&self) -> bool {
        false
    }

    #[inline]
    fn test(&mut self, primitive: u32) {
        self.n_tests += 1;
        // One step further than the hit so far, so that ties are seen.
        let limit = self.t_max().next_up();
        let Some(t) = self.primitives[primitive as usize].intersect(self.ray, limit) else {
            return;
        };
        let wins = |hit: Hit| t < hit.t || primitive < hit.primitive;
        if self.hit.is_none_or(wins) {
            self.hit = Some(Hit { t, primitive });
        }
    }
}

/// The search for any hit.
pub(super) struct Any<'a> {
    primitives: &'a [Primitive],
    ray: &'a Ray,
    t_max: f32,
    ignored: Option<ObjectId>,
    pub(super) found: bool,
    pub(super) n_tests: u32,
}

impl<'a> Any<'a> {
    pub(super) fn new(
        primitives: &'a [Primitive],
        ray: &'a Ray,
        t_max: f32,
        ignored: Option<ObjectId>,
    ) -> Self {
        Self {
            primitives,
            ray,
            t_max,
            ignored,
            found: false,
            n_tests: 0,
        }
    }
}

impl Search for Any<'_> {
    #[inline]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline]
    fn is_done(&self) -> bool {
        self.found
    }

    #[inline]
    fn test(&mut self, primitive: u32) {
        self.n_tests += 1;
        let primitive = &self.primitives[primitive as usize];
        self.found |= primitive.intersect(self.ray, self.t_max).is_some()
            && self.ignored != Some(primitive.object);
    }
}
