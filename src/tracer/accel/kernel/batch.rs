//! A batch of ray queries and the arena that answers them.

use crate::accel::arena::Arena;
use crate::accel::search::Queries;
use crate::accel::unbounded::Unbounded;
use crate::cost::StreamProbe;
use world::scene::Primitive;

/// Queries about rays through an arena, which may be empty, and their answers.
pub(in crate::accel) struct Batch<'a, Q: Queries, P> {
    pub(in crate::accel) arena: &'a Arena,
    pub(in crate::accel) primitives: &'a [Primitive],
    /// Primitives outside the hierarchy; tested first.
    pub(in crate::accel) unbounded: &'a Unbounded,
    pub(in crate::accel) queries: &'a Q,
    /// One answer per query, at first the default.
    pub(in crate::accel) answers: &'a mut [Q::Answer],
    /// Receives the numbers of node visits and primitive tests.
    pub(in crate::accel) probe: &'a mut P,
}

impl<'a, Q: Queries, P: StreamProbe> Batch<'a, Q, P> {
    /// Reborrows the batch for a shorter lifetime.
    pub(in crate::accel) fn reborrow(&mut self) -> Batch<'_, Q, P> {
        Batch {
            answers: self.answers,
            probe: self.probe,
            ..*self
        }
    }

    /// Writes the answer of the query `index` and reports its counters.
    #[inline(always)]
    pub(super) fn answer(
        &mut self,
        index: usize,
        search: &Q::Search<'a>,
        n_visits: u32,
        n_tests: u32,
    ) {
        self.probe.traversal(index, n_visits, n_tests);
        self.answers[index] = Q::answer(search);
    }
}
