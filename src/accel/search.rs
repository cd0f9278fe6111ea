//! What a ray looks for: its nearest hit, or any.

use super::Hit;
use crate::geometry::Ray;
use crate::scene::{ObjectId, Primitive};

/// A search that a structure shows primitives to.
pub(super) trait Search {
    /// Whether near primitives should come before far ones.
    const NEAREST_FIRST: bool;
    /// Only hits before this parameter count.
    fn limit(&self) -> f32;
    /// Whether no further primitive can change the answer.
    fn is_done(&self) -> bool;
    /// Tests the primitive with this index.
    fn test(&mut self, primitive: u32);
    /// Hears of the hit of a primitive, at `t > 0` and before the limit that
    /// was when a group of primitives was begun.
    fn found(&mut self, t: f32, primitive: u32);
}

/// The search for a ray's nearest hit.
pub(super) struct Nearest<'a> {
    primitives: &'a [Primitive],
    ray: &'a Ray,
    pub(super) hit: Option<Hit>,
    /// One step further than the hit so far, so that ties are seen.
    limit: f32,
}

impl<'a> Nearest<'a> {
    pub(super) fn new(primitives: &'a [Primitive], ray: &'a Ray) -> Self {
        Self {
            primitives,
            ray,
            hit: None,
            limit: f32::INFINITY,
        }
    }
}

impl Search for Nearest<'_> {
    const NEAREST_FIRST: bool = true;

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }

    #[inline(always)]
    fn is_done(&self) -> bool {
        false
    }

    #[inline]
    fn test(&mut self, primitive: u32) {
        if let Some(t) = self.primitives[primitive as usize].intersect(self.ray, self.limit) {
            self.found(t, primitive);
        }
    }

    #[inline(always)]
    fn found(&mut self, t: f32, primitive: u32) {
        let wins = |hit: Hit| t < hit.t || t == hit.t && primitive < hit.primitive;
        if self.hit.is_none_or(wins) {
            self.hit = Some(Hit { t, primitive });
            self.limit = t.next_up();
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
        }
    }
}

impl Search for Any<'_> {
    const NEAREST_FIRST: bool = false;

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn is_done(&self) -> bool {
        self.found
    }

    #[inline]
    fn test(&mut self, primitive: u32) {
        if let Some(t) = self.primitives[primitive as usize].intersect(self.ray, self.t_max) {
            self.found(t, primitive);
        }
    }

    #[inline(always)]
    fn found(&mut self, _: f32, primitive: u32) {
        // The primitive is far away in memory: look only if it matters.
        self.found |= match self.ignored {
            None => true,
            ignored => ignored != Some(self.primitives[primitive as usize].object),
        };
    }
}
