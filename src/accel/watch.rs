//! A search that keeps account of every step.

use super::Hit;
use super::search::Search;
use crate::geometry::Ray;
use crate::scene::Primitive;

/// What a ray did on its way, in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// Was at a node.
    Node {
        /// The node, as in [`BvhNode`](super::BvhNode).
        id: u32,
        /// Whether it entered a child.
        hit: bool,
    },
    /// Was at a leaf; the tests of its primitives follow.
    Leaf {
        /// The leaf, as in [`BvhNode`](super::BvhNode).
        id: u32,
        /// Whether it met one of them.
        hit: bool,
    },
    /// Was tested against a primitive.
    Test {
        /// The primitive's index in the scene.
        primitive: u32,
        /// Whether they meet, nearer than what was known then.
        hit: bool,
    },
}

/// Shows all to another search and writes it down.
pub(super) struct Watched<'a, S> {
    search: S,
    primitives: &'a [Primitive],
    ray: &'a Ray,
    steps: &'a mut Vec<Step>,
    /// The index of the leaf's step among them, in a leaf.
    leaf: Option<usize>,
    /// What ended the search, if a hit did.
    end: Option<Hit>,
}

impl<'a, S> Watched<'a, S> {
    /// Watches the search of a ray; adds to `steps`.
    pub(super) fn new(
        search: S,
        primitives: &'a [Primitive],
        ray: &'a Ray,
        steps: &'a mut Vec<Step>,
    ) -> Self {
        Self {
            search,
            primitives,
            ray,
            steps,
            leaf: None,
            end: None,
        }
    }

    /// What the search that was watched has found, and the hit that ended it,
    /// if one did.
    pub(super) fn into_found(self) -> (S, Option<Hit>) {
        (self.search, self.end)
    }
}

impl<S: Search> Search for Watched<'_, S> {
    const NEAREST_FIRST: bool = S::NEAREST_FIRST;
    const WATCHES: bool = true;

    fn limit(&self) -> f32 {
        self.search.limit()
    }

    fn is_done(&self) -> bool {
        self.search.is_done()
    }

    fn test(&mut self, primitive: u32) {
        self.steps.push(Step::Test {
            primitive,
            hit: false,
        });
        if let Some(t) = self.primitives[primitive as usize].intersect(self.ray, self.limit()) {
            self.found(t, primitive);
        }
    }

    fn passed(&mut self, line: usize, enters: bool) {
        self.steps.push(Step::Node {
            id: line as u32,
            hit: enters,
        });
    }

    fn tested(&mut self, line: usize, primitives: impl Iterator<Item = u32>) {
        self.leaf = Some(self.steps.len());
        self.steps.push(Step::Leaf {
            id: line as u32,
            hit: false,
        });
        let test = |primitive| Step::Test {
            primitive,
            hit: false,
        };
        self.steps.extend(primitives.map(test));
    }

    fn found(&mut self, t: f32, primitive: u32) {
        let was_tested = |step: &Step| matches!(step, Step::Test { primitive: tested, .. } if *tested == primitive);
        let test = self.steps.iter().rposition(was_tested);
        for step in test.into_iter().chain(self.leaf) {
            match &mut self.steps[step] {
                Step::Node { hit, .. } | Step::Leaf { hit, .. } | Step::Test { hit, .. } => {
                    *hit = true;
                }
            }
        }
        let was_done = self.search.is_done();
        self.search.found(t, primitive);
        if self.search.is_done() && !was_done {
            self.end = Some(Hit { t, primitive });
        }
    }
}
