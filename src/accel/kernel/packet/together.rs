//! A packet on its way.

use std::array;

use super::beam::Beam;
use super::rays::{Rays, greatest};
use super::{N_HALVES, N_RAYS};
use crate::accel::arena::{Arena, Leaf};
use crate::accel::build::MAX_DEPTH;
use crate::accel::kernel::batch::Batch;
use crate::accel::kernel::test_leaf;
use crate::accel::layout::{LeafKind, Node, Word};
use crate::accel::search::{Query, Search};
use crate::accel::simd::{InstructionSet, Lanes, N_LANES};
use crate::cost::StreamProbe;
use crate::scene::Primitive;

/// A number for each ray.
pub(super) type Each<T> = [[T; N_LANES]; N_HALVES];

/// A packet: what its rays look for, and what they have cost.
pub(super) struct Together<'r, I: InstructionSet, S> {
    rays: &'r Rays<'r, I>,
    beam: Beam<I>,
    searches: [S; N_RAYS],
    /// Below all numbers for rays that are done.
    limits: Each<f32>,
    /// The largest of them.
    farthest: f32,
    n_visits: Each<u32>,
    n_tests: Each<u32>,
}

/// A child whose turn comes later.
#[derive(Clone, Copy)]
struct Waiting {
    /// The node that it is a child of, and which one.
    parent: Word,
    lane: u8,
    /// The rays that are active in the parent.
    active: u16,
    /// No ray enters it before this.
    enter: f32,
}

/// A node leaves at most seven children behind, and the last one pushes eight.
const CAPACITY: usize = (N_LANES - 1) * (MAX_DEPTH + 1) + N_LANES;

/// The children that wait.
pub(super) struct Stack {
    len: usize,
    waiting: [Waiting; CAPACITY],
}

impl<'r, I: InstructionSet, S: Search> Together<'r, I, S> {
    /// The rays of these queries.
    #[inline(always)]
    pub(super) fn new<'a, Q: Query<Search<'a> = S>>(
        rays: &'r Rays<'r, I>,
        queries: &'a [Q; N_RAYS],
        primitives: &'a [Primitive],
    ) -> Self {
        let searches: [S; N_RAYS] = array::from_fn(|lane| queries[lane].search(primitives));
        let mut limits = [[0.0; N_LANES]; N_HALVES];
        for (limit, search) in limits.as_flattened_mut().iter_mut().zip(&searches) {
            *limit = search.limit();
        }
        let [a, b] = &limits;
        Self {
            rays,
            beam: Beam::around(rays),
            searches,
            limits,
            farthest: greatest(rays.set.load(a).max(rays.set.load(b))),
            n_visits: [[0; N_LANES]; N_HALVES],
            n_tests: [[0; N_LANES]; N_HALVES],
        }
    }

    /// Tests these primitives first; gives the rays that are not done then.
    #[inline(always)]
    pub(super) fn test_always(&mut self, always: &[u32]) -> u16 {
        let mut active = u16::MAX;
        if always.is_empty() {
            return active;
        }
        self.n_tests = [[always.len() as u32; N_LANES]; N_HALVES];
        for lane in 0..N_RAYS {
            let search = &mut self.searches[lane];
            for &primitive in always {
                search.test(primitive);
            }
            self.limits[lane / N_LANES][lane % N_LANES] = limit(search);
            active &= !(u16::from(search.is_done()) << lane);
        }
        self.limits_have_changed();
        active
    }

    /// Sends these rays, one at least, through the hierarchy. Gives what that
    /// saves, in boxes that a ray enters.
    #[inline(always)]
    pub(super) fn descend<P: StreamProbe>(
        &mut self,
        arena: &Arena,
        mut active: u16,
        stack: &mut Stack,
    ) -> i32 {
        let mut gain = START_GAIN;
        let mut word = Word::ROOT;
        stack.len = 0;
        loop {
            if P::COUNTS {
                add(self.rays.set, &mut self.n_visits, active, 1);
            }
            // SAFETY: the word is the root or a child of a node, and no leaf.
            self.push_children(word, unsafe { arena.node(word) }, active, stack);
            loop {
                let Some(waiting) = stack.pop() else {
                    return gain;
                };
                if waiting.enter > self.farthest {
                    continue;
                }
                // SAFETY: its children were pushed, so that it is a node.
                let parent = unsafe { arena.node(waiting.parent) };
                let lane = usize::from(waiting.lane) % N_LANES;
                active = self.rays.entering(parent, lane, &self.limits) & waiting.active;
                gain += active.count_ones() as i32 - BOX_COST;
                if active == 0 {
                    continue;
                }
                word = Word(parent.children[lane]);
                if !word.is_leaf() {
                    break;
                }
                if P::COUNTS {
                    add(
                        self.rays.set,
                        &mut self.n_tests,
                        active,
                        word.leaf_size() as u32,
                    );
                }
                // SAFETY: the word is a child of a node, and no node.
                self.test(unsafe { arena.leaf(word) }, word.leaf_kind(), active);
            }
        }
    }

    /// Puts the children that rays may enter on the stack, the one to visit
    /// first on top.
    #[inline(always)]
    fn push_children(&self, word: Word, node: &Node, active: u16, stack: &mut Stack) {
        let (mut places, enter) = self.beam.entered::<S>(self.rays.set, node, self.farthest);
        while places != 0 {
            let place = places.trailing_zeros() as usize % N_LANES;
            places &= places - 1;
            stack.push(Waiting {
                parent: word,
                lane: self.beam.lane::<S>(node, place) as u8,
                active,
                enter: enter[place],
            });
        }
    }

    /// Tests the rays against a leaf: with rays in the lanes, or, where they
    /// are few, ray by ray with primitives in the lanes.
    #[inline(always)]
    fn test(&mut self, leaf: Leaf, kind: LeafKind, active: u16) {
        let n_halves = u32::from(active & 0xff != 0) + u32::from(active >> 8 != 0);
        let are_few = RAY_COST * active.count_ones() <= n_halves * leaf.len() as u32;
        let Self {
            rays,
            searches,
            limits,
            ..
        } = self;
        let mut is_changed = false;
        let mut note = |lane: usize, search: &S| {
            limits[lane / N_LANES][lane % N_LANES] = limit(search);
            is_changed = true;
        };
        let found = |lane: usize, t: f32, primitive: u32| {
            let search = &mut searches[lane];
            if t < search.limit() {
                search.found(t, primitive);
                note(lane, search);
            }
        };
        match kind {
            LeafKind::Triangles if !are_few => rays.triangles(leaf, active, found),
            LeafKind::Spheres if !are_few => rays.spheres(leaf, active, found),
            _ => {
                let mut lanes = active;
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize % N_RAYS;
                    lanes &= lanes - 1;
                    test_leaf(&rays.alone(lane), leaf, kind, &mut searches[lane]);
                    note(lane, &searches[lane]);
                }
            }
        }
        if is_changed {
            self.limits_have_changed();
        }
    }

    #[inline(always)]
    fn limits_have_changed(&mut self) {
        let [a, b] = &self.limits;
        let set = self.rays.set;
        self.farthest = greatest(set.load(a).max(set.load(b)));
    }

    /// Notes what these rays have found, the first of which has this number.
    #[inline(always)]
    pub(super) fn answer<'a, Q: Query<Search<'a> = S>, P: StreamProbe>(
        &self,
        batch: &mut Batch<'a, Q, P>,
        first: usize,
        alike: u16,
    ) {
        let n_visits = self.n_visits.as_flattened();
        let n_tests = self.n_tests.as_flattened();
        for (lane, search) in self.searches.iter().enumerate() {
            if alike >> lane & 1 != 0 {
                batch.answer(first + lane, search, n_visits[lane], n_tests[lane]);
            }
        }
    }
}

/// What a packet saves before its way begins, in boxes that a ray enters: rays
/// are made ready faster together.
const START_GAIN: i32 = 20;

/// How many rays must enter a box for its test to cost as much as theirs.
const BOX_COST: i32 = 4;

/// How many primitives are tested against eight rays in the time in which one
/// ray is tested against eight primitives.
const RAY_COST: u32 = 2;

/// Only hits before this parameter count.
#[inline(always)]
fn limit<S: Search>(search: &S) -> f32 {
    match search.is_done() {
        true => f32::NEG_INFINITY,
        false => search.limit(),
    }
}

/// Adds a number to the counts of these rays.
#[inline(always)]
fn add<I: InstructionSet>(set: I, counts: &mut Each<u32>, rays: u16, n: u32) {
    for (counts, rays) in counts.iter_mut().zip(rays.to_le_bytes()) {
        set.add_to(counts, rays, n);
    }
}

impl Stack {
    /// Nothing waits.
    pub(super) fn new() -> Self {
        let nothing = Waiting {
            parent: Word::ROOT,
            lane: 0,
            active: 0,
            enter: 0.0,
        };
        Self {
            len: 0,
            waiting: [nothing; CAPACITY],
        }
    }

    #[inline(always)]
    fn push(&mut self, waiting: Waiting) {
        self.waiting[self.len] = waiting;
        self.len += 1;
    }

    /// Takes the child that was added last.
    #[inline(always)]
    fn pop(&mut self) -> Option<Waiting> {
        self.len = self.len.checked_sub(1)?;
        Some(self.waiting[self.len])
    }
}
