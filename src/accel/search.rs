//! What a ray looks for: its nearest hit, or any.

use super::{Hit, ShadowRay};
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
    /// Whether it wants to hear of each step.
    const WATCHES: bool = false;
    /// Hears that the ray has been at the node at this line of the arena, and
    /// whether it enters a child.
    fn passed(&mut self, _line: usize, _enters: bool) {}
    /// Hears that these primitives of the leaf at this line are tested now; none
    /// where each is told by [`test`](Self::test).
    fn tested(&mut self, _line: usize, _primitives: impl Iterator<Item = u32>) {}
    /// Hears of the hit of a primitive, at `t > 0` and before the limit that
    /// was when a group of primitives was begun.
    fn found(&mut self, t: f32, primitive: u32);
}

/// What is asked about a ray.
pub(super) trait Query {
    /// How the answer is found.
    type Search<'a>: Search
    where
        Self: 'a;
    /// The answer.
    type Answer: Default;
    /// The ray that it is about.
    fn ray(&self) -> &Ray;
    /// The search for the answer among these primitives.
    fn search<'a>(&'a self, primitives: &'a [Primitive]) -> Self::Search<'a>;
    /// What a search has found.
    fn answer(search: &Self::Search<'_>) -> Self::Answer;
}

/// A ray asks for its nearest hit.
impl Query for Ray {
    type Search<'a> = Nearest<'a>;
    type Answer = Option<Hit>;

    #[inline(always)]
    fn ray(&self) -> &Ray {
        self
    }

    #[inline(always)]
    fn search<'a>(&'a self, primitives: &'a [Primitive]) -> Nearest<'a> {
        Nearest::new(primitives, self)
    }

    #[inline(always)]
    fn answer(search: &Nearest) -> Option<Hit> {
        search.hit()
    }
}

impl Query for ShadowRay {
    type Search<'a> = Any<'a>;
    type Answer = bool;

    #[inline(always)]
    fn ray(&self) -> &Ray {
        &self.ray
    }

    #[inline(always)]
    fn search<'a>(&'a self, primitives: &'a [Primitive]) -> Any<'a> {
        Any::new(primitives, &self.ray, self.t_max, self.ignored)
    }

    #[inline(always)]
    fn answer(search: &Any) -> bool {
        search.found
    }
}

/// The search for a ray's nearest hit.
pub(super) struct Nearest<'a> {
    primitives: &'a [Primitive],
    ray: &'a Ray,
    /// The hit so far; none is at infinity.
    nearest: Hit,
    /// One step further than the hit so far, so that ties are seen.
    limit: f32,
}

impl<'a> Nearest<'a> {
    pub(super) fn new(primitives: &'a [Primitive], ray: &'a Ray) -> Self {
        Self {
            primitives,
            ray,
            nearest: Hit {
                t: f32::INFINITY,
                primitive: u32::MAX,
            },
            limit: f32::INFINITY,
        }
    }

    /// The hit, if there is one.
    #[inline(always)]
    pub(super) fn hit(&self) -> Option<Hit> {
        (self.limit < f32::INFINITY).then_some(self.nearest)
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
        let nearest = self.nearest;
        if t < nearest.t || t == nearest.t && primitive < nearest.primitive {
            self.nearest = Hit { t, primitive };
            // The next greater number, since it is finite and not negative.
            self.limit = f32::from_bits(t.to_bits() + 1);
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
