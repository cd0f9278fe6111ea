//! A search that records every step of its traversal.

use super::hit::Hit;
use super::instanced::PlacedSearch;
use super::search::{BoxTests, Search};
use world::geometry::Ray;
use world::scene::{InstanceId, PlacedPrimitive, Primitive};

/// One step of a ray's traversal, in chronological order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TraversalStep {
    /// A visit to a node.
    Node {
        /// The node, as in [`BvhNode`](super::BvhNode).
        id: u32,
        /// The tests of its children's boxes.
        boxes: BoxTests,
    },
    /// A visit to a leaf; the tests of its primitives follow.
    Leaf {
        /// The leaf, as in [`BvhNode`](super::BvhNode).
        id: u32,
        /// True if the ray hit one of its primitives.
        hit: bool,
    },
    /// A test against a primitive.
    Test {
        /// Index of the primitive in the scene.
        primitive: u32,
        /// True if the ray hit it, before the limit at that time.
        hit: bool,
    },
}

/// Wraps another search and records its steps.
pub(super) struct Recorder<'a, S> {
    search: S,
    primitives: &'a [Primitive],
    steps: &'a mut Vec<TraversalStep>,
    /// Index of the last leaf among the steps.
    leaf: Option<usize>,
    /// Index of the test of the instance that the ray is in, and index of the last leaf outside the
    /// instance.
    entered: Option<(usize, Option<usize>)>,
    /// The hit that ended the search, if any.
    end: Option<Hit>,
}

impl<'a, S> Recorder<'a, S> {
    /// Records the search of a ray; appends to `steps`.
    pub(super) fn new(
        search: S,
        primitives: &'a [Primitive],
        steps: &'a mut Vec<TraversalStep>,
    ) -> Self {
        Self {
            search,
            primitives,
            steps,
            leaf: None,
            entered: None,
            end: None,
        }
    }

    /// Returns the recorded search and the hit that ended it, if any.
    pub(super) fn into_parts(self) -> (S, Option<Hit>) {
        (self.search, self.end)
    }
}

impl<S: Search> Search for Recorder<'_, S> {
    const NEAREST_FIRST: bool = S::NEAREST_FIRST;
    const RECORDS: bool = true;

    fn limit(&self) -> f32 {
        self.search.limit()
    }

    fn is_done(&self) -> bool {
        self.search.is_done()
    }

    fn visit_test(&mut self, primitive: u32) {
        self.steps.push(TraversalStep::Test {
            primitive,
            hit: false,
        });
    }

    fn test(&mut self, ray: &Ray, primitive: u32) {
        self.visit_test(primitive);
        if let Some(t) = self.primitives[primitive as usize].intersect(ray, self.limit()) {
            self.found(t, primitive);
        }
    }

    fn visit_node(&mut self, line: usize, boxes: BoxTests) {
        self.steps.push(TraversalStep::Node {
            id: line as u32,
            boxes,
        });
    }

    fn visit_leaf(&mut self, line: usize, primitives: impl Iterator<Item = u32>) {
        self.leaf = Some(self.steps.len());
        self.steps.push(TraversalStep::Leaf {
            id: line as u32,
            hit: false,
        });
        let test = |primitive| TraversalStep::Test {
            primitive,
            hit: false,
        };
        self.steps.extend(primitives.map(test));
    }

    fn found(&mut self, t: f32, primitive: u32) {
        self.mark(primitive);
        let was_done = self.search.is_done();
        self.search.found(t, primitive);
        self.end_if_done(was_done, t, primitive.into());
    }
}

impl<S: PlacedSearch> PlacedSearch for Recorder<'_, S> {
    fn enter(&mut self, primitive: u32) {
        self.entered = Some((self.steps.len(), self.leaf));
        self.visit_test(primitive);
    }

    fn leave(&mut self) {
        if let Some((_, leaf)) = self.entered.take() {
            self.leaf = leaf;
        }
    }

    fn found_in(&mut self, instance: InstanceId, t: f32, primitive: u32) {
        self.mark(primitive);
        let was_done = self.search.is_done();
        self.search.found_in(instance, t, primitive);
        let at = PlacedPrimitive {
            primitive,
            instance: Some(instance),
        };
        self.end_if_done(was_done, t, at);
    }
}

impl<S: Search> Recorder<'_, S> {
    /// Marks the last test of a primitive as a hit, with its leaf and, inside an instance, with the
    /// test of the instance and its leaf.
    fn mark(&mut self, primitive: u32) {
        let was_tested = |step: &TraversalStep| matches!(step, TraversalStep::Test { primitive: tested, .. } if *tested == primitive);
        let test = self.steps.iter().rposition(was_tested);
        let (instance, outer_leaf) = self.entered.unzip();
        let steps = test.into_iter().chain(self.leaf).chain(instance);
        for step in steps.chain(outer_leaf.flatten()) {
            if let TraversalStep::Leaf { hit, .. } | TraversalStep::Test { hit, .. } =
                &mut self.steps[step]
            {
                *hit = true;
            }
        }
    }

    /// Keeps the hit that ended the search, if it did.
    fn end_if_done(&mut self, was_done: bool, t: f32, at: PlacedPrimitive) {
        if self.search.is_done() && !was_done {
            self.end = Some(Hit {
                t,
                primitive: at.primitive,
                instance: at.instance,
            });
        }
    }
}
