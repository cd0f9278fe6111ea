//! Many queries that are answered together.

use crate::accel::arena::Arena;
use crate::accel::search::Query;
use crate::cost::StreamProbe;
use crate::scene::Primitive;

/// Queries about rays through an arena, which may be empty.
pub(in crate::accel) struct Batch<'a, Q: Query, P> {
    pub(in crate::accel) arena: &'a Arena,
    pub(in crate::accel) primitives: &'a [Primitive],
    /// Primitives that are tested first.
    pub(in crate::accel) always: &'a [u32],
    pub(in crate::accel) queries: &'a [Q],
    /// As many as there are queries.
    pub(in crate::accel) answers: &'a mut [Q::Answer],
    /// What hears of the nodes and tests.
    pub(in crate::accel) probe: &'a mut P,
}

impl<'a, Q: Query, P: StreamProbe> Batch<'a, Q, P> {
    /// The same queries, for a while.
    pub(in crate::accel) fn reborrow(&mut self) -> Batch<'_, Q, P> {
        Batch {
            answers: self.answers,
            probe: self.probe,
            ..*self
        }
    }

    /// Notes what was found of the query with this number, and tells the probe.
    #[inline(always)]
    pub(super) fn answer(
        &mut self,
        number: usize,
        search: &Q::Search<'a>,
        n_visits: u32,
        n_tests: u32,
    ) {
        if P::COUNTS {
            self.probe.traversal(number, n_visits, n_tests);
        }
        self.answers[number] = Q::answer(search);
    }
}
