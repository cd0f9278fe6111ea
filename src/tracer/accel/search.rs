//! The two queries about a ray: its nearest hit, and if there is any.

use super::hit::{Hit, ShadowStream};
use world::geometry::{Ray, RayStream};
use world::scene::{ObjectId, Primitive};

/// The tests of the boxes of a node's children.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BoxTests {
    /// Number of boxes, 1 to 8.
    pub n: u8,
    /// Number of boxes that the ray enters before its limit at that time.
    pub n_hits: u8,
}

/// The state of a query while its ray is traversed.
pub(super) trait Search {
    /// True if the traversal should visit near children before far ones.
    const NEAREST_FIRST: bool;
    /// Returns the parameter before which hits count.
    fn limit(&self) -> f32;
    /// Returns true if no further primitive can change the answer.
    fn is_done(&self) -> bool;
    /// Tests the ray against the primitive with this index.
    fn test(&mut self, ray: &Ray, primitive: u32);
    /// True if the traversal calls [`visit_node`](Self::visit_node) and
    /// [`visit_leaf`](Self::visit_leaf).
    const RECORDS: bool = false;
    /// Called after a visit to the node at this cache line of the arena, with the tests of its
    /// children's boxes.
    fn visit_node(&mut self, _line: usize, _boxes: BoxTests) {}
    /// Called before the primitives of the leaf at this cache line are tested at once; without
    /// primitives where [`test`](Self::test) follows for each.
    fn visit_leaf(&mut self, _line: usize, _primitives: impl Iterator<Item = u32>) {}
    /// Called before the test of a primitive by a search that records, unless it was passed to
    /// [`visit_leaf`](Self::visit_leaf).
    fn visit_test(&mut self, _primitive: u32) {}
    /// Called for a hit on a primitive, at `t > 0` and before the limit that applied at the start
    /// of its group of primitives.
    fn found(&mut self, t: f32, primitive: u32);
}

/// A search whose state is kept in lanes beside the searches of other rays.
pub(super) trait LaneSearch: Search + Copy {
    /// Returns the limit, negative infinity if the search is done, and the primitive of the nearest
    /// hit.
    fn state(&self) -> (f32, u32);
    /// Returns true if the answer is not the default.
    fn has_found(&self) -> bool;
    /// Returns this search, which has found nothing yet, in such a state.
    fn resumed(self, limit: f32, nearest: u32) -> Self;
}

/// Queries about rays.
pub(super) trait Queries {
    /// The state of a traversal.
    type Search<'a>: LaneSearch
    where
        Self: 'a;
    /// The answer to a query.
    type Answer: Default;
    /// Returns the rays.
    fn rays(&self) -> &RayStream;
    /// Returns the search that answers query `i` among these primitives.
    fn search<'a>(&'a self, i: usize, primitives: &'a [Primitive]) -> Self::Search<'a>;
    /// Returns true if a search may ignore hits before its limit.
    fn ignores(&self) -> bool;
    /// Returns the answer that a finished search has found.
    fn answer(search: &Self::Search<'_>) -> Self::Answer;
}

/// Queries for the nearest hits of the rays.
impl Queries for RayStream {
    type Search<'a> = NearestHit<'a>;
    type Answer = Option<Hit>;

    #[inline(always)]
    fn rays(&self) -> &RayStream {
        self
    }

    #[inline(always)]
    fn search<'a>(&'a self, _: usize, primitives: &'a [Primitive]) -> NearestHit<'a> {
        NearestHit::new(primitives)
    }

    #[inline(always)]
    fn ignores(&self) -> bool {
        false
    }

    #[inline(always)]
    fn answer(search: &NearestHit) -> Option<Hit> {
        search.hit()
    }
}

/// Queries for the occlusion of the rays.
impl Queries for ShadowStream {
    type Search<'a> = AnyHit<'a>;
    type Answer = bool;

    #[inline(always)]
    fn rays(&self) -> &RayStream {
        &self.rays
    }

    #[inline(always)]
    fn search<'a>(&'a self, i: usize, primitives: &'a [Primitive]) -> AnyHit<'a> {
        AnyHit::new(primitives, self.t_max[i], self.ignored(i))
    }

    #[inline(always)]
    fn ignores(&self) -> bool {
        !self.ignored.is_empty()
    }

    #[inline(always)]
    fn answer(search: &AnyHit) -> bool {
        search.found
    }
}

/// The search for a ray's nearest hit.
#[derive(Clone, Copy)]
pub(super) struct NearestHit<'a> {
    primitives: &'a [Primitive],
    /// Parameter and primitive of the nearest hit so far; infinity if there is none.
    nearest: (f32, u32),
    /// The next float after the `t` of that hit: hits at equal distance count.
    limit: f32,
}

impl<'a> NearestHit<'a> {
    pub(super) fn new(primitives: &'a [Primitive]) -> Self {
        Self {
            primitives,
            nearest: (f32::INFINITY, u32::MAX),
            limit: f32::INFINITY,
        }
    }

    /// Returns the hit, if any.
    #[inline(always)]
    pub(super) fn hit(&self) -> Option<Hit> {
        let (t, primitive) = self.nearest;
        self.has_found().then_some(Hit {
            t,
            primitive,
            instance: None,
        })
    }
}

impl Search for NearestHit<'_> {
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
    fn test(&mut self, ray: &Ray, primitive: u32) {
        if let Some(t) = self.primitives[primitive as usize].intersect(ray, self.limit) {
            self.found(t, primitive);
        }
    }

    #[inline(always)]
    fn found(&mut self, t: f32, primitive: u32) {
        let (nearest, of_primitive) = self.nearest;
        if t < nearest || t == nearest && primitive < of_primitive {
            self.nearest = (t, primitive);
            // The next greater float, since `t` is finite and not negative.
            self.limit = f32::from_bits(t.to_bits() + 1);
        }
    }
}

impl LaneSearch for NearestHit<'_> {
    #[inline(always)]
    fn state(&self) -> (f32, u32) {
        (self.limit, self.nearest.1)
    }

    #[inline(always)]
    fn has_found(&self) -> bool {
        self.limit < f32::INFINITY
    }

    #[inline(always)]
    fn resumed(self, limit: f32, nearest: u32) -> Self {
        // The float before the limit, or infinity without a hit.
        let has_hit = limit < f32::INFINITY;
        Self {
            nearest: (
                f32::from_bits(limit.to_bits() - u32::from(has_hit)),
                nearest,
            ),
            limit,
            ..self
        }
    }
}

/// The search for any hit.
#[derive(Clone, Copy)]
pub(super) struct AnyHit<'a> {
    primitives: &'a [Primitive],
    t_max: f32,
    ignored: Option<ObjectId>,
    pub(super) found: bool,
}

impl<'a> AnyHit<'a> {
    pub(super) fn new(primitives: &'a [Primitive], t_max: f32, ignored: Option<ObjectId>) -> Self {
        Self {
            primitives,
            t_max,
            ignored,
            found: false,
        }
    }
}

impl Search for AnyHit<'_> {
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
    fn test(&mut self, ray: &Ray, primitive: u32) {
        if let Some(t) = self.primitives[primitive as usize].intersect(ray, self.t_max) {
            self.found(t, primitive);
        }
    }

    #[inline(always)]
    fn found(&mut self, _: f32, primitive: u32) {
        // The primitive is likely not in the cache: load it only if needed.
        self.found |= match self.ignored {
            None => true,
            ignored => ignored != Some(self.primitives[primitive as usize].object),
        };
    }
}

impl LaneSearch for AnyHit<'_> {
    #[inline(always)]
    fn state(&self) -> (f32, u32) {
        let limit = if self.found {
            f32::NEG_INFINITY
        } else {
            self.t_max
        };
        (limit, u32::MAX)
    }

    #[inline(always)]
    fn has_found(&self) -> bool {
        self.found
    }

    #[inline(always)]
    fn resumed(self, limit: f32, _: u32) -> Self {
        Self {
            found: limit == f32::NEG_INFINITY,
            ..self
        }
    }
}
