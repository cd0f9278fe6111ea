//! Many rays at once through the hierarchy.
//!
//! [`RAYS_IN_FLIGHT`] rays take turns. In each round every ray that is at a node
//! takes one step, without a branch that depends on it, and asks for the memory
//! of the next; then every ray at a leaf is tested; then rays that are done make
//! room for others. So one ray's cache misses, chains of arithmetic and wrong
//! guesses are hidden behind the work of the others.

use std::mem::MaybeUninit;

use super::batch::Batch;
use super::block::Blocks;
use super::slab::Slabs;
use super::stack::Stack;
use super::{push_entered, test_leaf};
use crate::accel::arena::Arena;
use crate::accel::layout::Word;
use crate::accel::search::{Query, Search};
use crate::accel::simd::{InstructionSet, Work};
use crate::cost::StreamProbe;

/// Rays in flight: enough to hide memory's latency, few enough that their state
/// stays in the nearest cache.
pub const RAYS_IN_FLIGHT: usize = 16;

/// The queries of a batch with these numbers, each ray on its own.
pub(in crate::accel) struct Stream<'a, Q: Query, P> {
    pub(in crate::accel) batch: Batch<'a, Q, P>,
    pub(in crate::accel) numbers: &'a [u32],
}

/// A ray on its way.
struct Flight<I: InstructionSet, S> {
    slabs: Slabs<I>,
    blocks: Blocks<I>,
    search: S,
    /// Where it goes next.
    word: Word,
    n_visits: u32,
    n_tests: u32,
    /// The index of its query.
    number: usize,
    stack: Stack,
}

impl<Q: Query, P: StreamProbe> Work for Stream<'_, Q, P> {
    type Output = ();

    #[inline(always)]
    fn run<I: InstructionSet>(mut self, set: I) {
        let mut flights = [const { MaybeUninit::uninit() }; RAYS_IN_FLIGHT];
        let (mut at_nodes, mut at_leaves) = (Set::EMPTY, Set::EMPTY);
        let mut n_launched = 0;
        for (i, flight) in flights.iter_mut().enumerate() {
            at_nodes.insert_if(i, self.launch(set, &mut n_launched, flight));
        }
        while !(at_nodes.is_empty() && at_leaves.is_empty()) {
            let (mut nodes, mut leaves) = (at_nodes, at_leaves);
            at_leaves = Set::EMPTY;
            while let Some(i) = nodes.take() {
                // SAFETY: what is in a set was launched.
                let flight = unsafe { flights[i].assume_init_mut() };
                flight.descend::<P>(set, self.batch.arena);
                at_leaves.insert_if(i, flight.word.is_leaf());
            }
            at_nodes.remove(at_leaves);
            while let Some(i) = leaves.take() {
                // SAFETY: what is in a set was launched.
                let flight = unsafe { flights[i].assume_init_mut() };
                if flight.test::<P>(set, self.batch.arena) {
                    at_leaves.insert_if(i, flight.word.is_leaf());
                    at_nodes.insert_if(i, !flight.word.is_leaf());
                } else {
                    let Flight {
                        number,
                        n_visits,
                        n_tests,
                        search,
                        ..
                    } = flight;
                    self.batch.answer(*number, search, *n_visits, *n_tests);
                    at_nodes.insert_if(i, self.launch(set, &mut n_launched, &mut flights[i]));
                }
            }
        }
    }
}

impl<'a, Q: Query, P: StreamProbe> Stream<'a, Q, P> {
    /// Starts the next ray that has to go through the hierarchy, at the root;
    /// rays that need not are answered on the way. `false` if there is none.
    #[inline(always)]
    fn launch<I: InstructionSet>(
        &mut self,
        set: I,
        n_launched: &mut usize,
        flight: &mut MaybeUninit<Flight<I, Q::Search<'a>>>,
    ) -> bool {
        let Batch {
            arena,
            primitives,
            always,
            queries,
            ..
        } = self.batch;
        let n_tests = always.len() as u32;
        while let Some(&number) = self.numbers.get(*n_launched) {
            let number = number as usize;
            *n_launched += 1;
            let query = &queries[number];
            let mut search = query.search(primitives);
            for &primitive in always {
                search.test(primitive);
            }
            if arena.is_empty() || search.is_done() {
                self.batch.answer(number, &search, 0, n_tests);
                continue;
            }
            let flight = flight.write(Flight {
                slabs: Slabs::new(set, query.ray(), arena.largest()),
                blocks: Blocks::new(set, query.ray()),
                search,
                word: Word::ROOT,
                n_visits: 0,
                n_tests,
                number,
                stack: Stack::new(),
            });
            flight.stack.push(Word::END, f32::NEG_INFINITY);
            return true;
        }
        false
    }
}

impl<I: InstructionSet, S: Search> Flight<I, S> {
    /// Goes through its node to the next word.
    #[inline(always)]
    fn descend<P: StreamProbe>(&mut self, set: I, arena: &Arena) {
        if P::COUNTS {
            self.n_visits += 1;
        }
        // SAFETY: the word is the root or a child of a node, and no leaf.
        let node = unsafe { arena.node(self.word) };
        let limit = set.splat(self.search.limit());
        let (enter, exit) = self.slabs.span(set, node, limit);
        push_entered::<I, S>(
            set,
            node,
            enter,
            exit,
            self.slabs.order_shift(),
            &mut self.stack,
        );
        self.go_on(set, arena);
    }

    /// Tests its leaf and goes on to the next word; `false` if it has arrived.
    #[inline(always)]
    fn test<P: StreamProbe>(&mut self, set: I, arena: &Arena) -> bool {
        if self.word == Word::END {
            return false;
        }
        if P::COUNTS {
            self.n_tests += self.word.leaf_size() as u32;
        }
        let limit = self.search.limit();
        // SAFETY: the word is a child of a node, and no node.
        let leaf = unsafe { arena.leaf(self.word) };
        test_leaf(&self.blocks, leaf, self.word.leaf_kind(), &mut self.search);
        if self.search.is_done() {
            return false;
        }
        if S::NEAREST_FIRST && self.search.limit() < limit {
            self.stack.keep_up_to(self.search.limit());
        }
        self.go_on(set, arena);
        true
    }

    /// Takes the next word off the stack and asks for its memory, so that it is
    /// there in the next round.
    #[inline(always)]
    fn go_on(&mut self, set: I, arena: &Arena) {
        self.word = self.stack.pop_one();
        let line = arena.address(self.word);
        set.prefetch(line);
        set.prefetch(line.wrapping_add(1));
        set.prefetch(line.wrapping_add(2));
        set.prefetch(line.wrapping_add(3));
    }
}

/// Flights by their numbers.
#[derive(Clone, Copy)]
struct Set(u32);

impl Set {
    const EMPTY: Self = Self(0);

    #[inline(always)]
    fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Adds a flight, without a branch on whether it belongs here.
    #[inline(always)]
    fn insert_if(&mut self, flight: usize, belongs: bool) {
        self.0 |= u32::from(belongs) << flight;
    }

    /// Removes others.
    #[inline(always)]
    fn remove(&mut self, others: Self) {
        self.0 &= !others.0;
    }

    /// Takes one out.
    #[inline(always)]
    fn take(&mut self) -> Option<usize> {
        let flight = self.0.trailing_zeros() as usize % RAYS_IN_FLIGHT;
        let is_there = self.0 != 0;
        self.0 &= self.0.wrapping_sub(1);
        is_there.then_some(flight)
    }
}
