//! Traversal of the hierarchy by a packet.
#![expect(unsafe_code, reason = "the arena was checked once, for all rays")]

use arrayvec::ArrayVec;
use bytemuck::cast_ref;

use super::beam::Beam;
use super::rays::PacketRays;
use super::searches::Searches;
use super::soa::{N_HALVES, N_RAYS, PerRay};
use crate::accel::arena::{Arena, Leaf};
use crate::accel::kernel::batch::Batch;
use crate::accel::layout::{LeafKind, MAX_DEPTH, NodeRef, WideNode};
use crate::accel::search::{LaneSearch, Queries};
use crate::accel::unbounded::Unbounded;
use crate::cost::{StreamProbe, Traversals};
use math::simd::{InstructionSet, N_LANES};
use world::scene::Primitive;

/// A packet: its rays, their searches and their counters.
pub(super) struct Packet<'r, I: InstructionSet, Q> {
    rays: &'r PacketRays<'r, I>,
    beam: Beam<I>,
    searches: Searches<'r, I, Q>,
    n_visits: PerRay<u32>,
    n_tests: PerRay<u32>,
}

/// A child still to be visited.
#[derive(Clone, Copy)]
pub(super) struct StackEntry {
    /// The parent, and the child's lane in it.
    parent: NodeRef,
    lane: u8,
    /// The rays that are active in the parent.
    active: u16,
    /// Lower bound for where any ray enters the child.
    enter: f32,
}

/// Each node on a path leaves at most seven children on the stack, and the last one pushes eight.
const CAPACITY: usize = (N_LANES - 1) * (MAX_DEPTH + 1) + N_LANES;

/// The children still to be visited. Its memory is not initialized.
pub(super) type PacketStack = ArrayVec<StackEntry, CAPACITY>;

impl<'r, I: InstructionSet, Q: Queries> Packet<'r, I, Q> {
    /// Starts the queries from index `first` on.
    #[inline(always)]
    pub(super) fn new(
        rays: &'r PacketRays<'r, I>,
        queries: &'r Q,
        first: usize,
        primitives: &'r [Primitive],
    ) -> Self {
        Self {
            rays,
            beam: Beam::around(rays),
            searches: Searches::new(rays.set, queries, first, primitives),
            n_visits: [[0; N_LANES]; N_HALVES],
            n_tests: [[0; N_LANES]; N_HALVES],
        }
    }

    /// Tests the unbounded primitives; returns the unfinished rays.
    #[inline(always)]
    pub(super) fn test_unbounded(&mut self, unbounded: &Unbounded) -> u16 {
        if unbounded.len() == 0 {
            return u16::MAX;
        }
        self.n_tests = [[unbounded.len() as u32; N_LANES]; N_HALVES];
        self.rays.planes(unbounded.planes(), &mut self.searches);
        if !unbounded.are_planes() {
            for ray in 0..N_RAYS {
                let mut search = self.searches.get(ray);
                unbounded.test_others(&self.rays.soa.ray(ray), &mut search);
                self.searches.set(ray, &search);
            }
        }
        self.searches.update_farthest();
        !self.searches.finished()
    }

    /// Traverses the hierarchy with these rays, at least one. Returns the gain over single
    /// traversals in units of what a single traversal spends on a box that its ray enters: see
    /// [`BOX_COST`].
    #[inline(always)]
    pub(super) fn traverse<P: StreamProbe>(
        &mut self,
        arena: &Arena,
        mut active: u16,
        stack: &mut PacketStack,
    ) -> i32 {
        let mut gain = START_GAIN;
        let mut current = NodeRef::ROOT;
        stack.clear();
        loop {
            // At an inner node: push the children that the beam hits.
            if P::COUNTS {
                add(self.rays.set, &mut self.n_visits, active, 1);
            }
            // SAFETY: the reference is the root or a child of a node, and refers to a node.
            let node = unsafe { arena.node(current) };
            self.push_children(current, node, active, stack);
            loop {
                // Pop a child; stop when none is left.
                let Some(entry) = stack.pop() else {
                    return gain;
                };
                // Skip a child past the farthest limit.
                if entry.enter >= self.searches.farthest {
                    continue;
                }
                // Find the rays that enter its box; skip the child if none does.
                // SAFETY: its children were pushed: it is a node.
                let parent = unsafe { arena.node(entry.parent) };
                let lane = usize::from(entry.lane) % N_LANES;
                let limits = &self.searches.limits;
                active = self.rays.entering(parent, lane, limits) & entry.active;
                gain += active.count_ones() as i32 - BOX_COST;
                if active == 0 {
                    continue;
                }
                current = NodeRef(parent.children[lane]);
                // Descend into an inner node.
                if !current.is_leaf() {
                    break;
                }
                // At a leaf: test its primitives against the active rays.
                if P::COUNTS {
                    add(
                        self.rays.set,
                        &mut self.n_tests,
                        active,
                        current.leaf_size() as u32,
                    );
                }
                // SAFETY: the reference is a child of a node, and refers to a leaf.
                let leaf = unsafe { arena.leaf(current) };
                self.test(leaf, active);
            }
        }
    }

    /// Pushes the children that rays may enter, the first to visit on top.
    #[inline(always)]
    fn push_children(
        &self,
        parent: NodeRef,
        node: &WideNode,
        active: u16,
        stack: &mut PacketStack,
    ) {
        let (mut positions, enter) =
            self.beam
                .entered::<Q::Search<'_>>(self.rays.set, node, self.searches.farthest);
        while positions != 0 {
            let position = positions.trailing_zeros() as usize % N_LANES;
            positions &= positions - 1;
            stack.push(StackEntry {
                parent,
                lane: self.beam.lane::<Q::Search<'_>>(node, position) as u8,
                active,
                enter: enter[position],
            });
        }
    }

    /// Tests the rays against a leaf: with one ray per lane or, if few rays are active, ray by ray
    /// with one primitive per lane.
    #[inline(always)]
    fn test(&mut self, leaf: Leaf, active: u16) {
        let n_halves = u32::from(active & 0xff != 0) + u32::from(active >> 8 != 0);
        let are_few = RAY_COST * active.count_ones() <= n_halves * leaf.len() as u32;
        let Self { rays, searches, .. } = self;
        match leaf.kind() {
            LeafKind::Triangles if !are_few => rays.triangles(leaf, active, searches),
            LeafKind::Spheres if !are_few => rays.spheres(leaf, active, searches),
            _ => {
                let mut lanes = active;
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize % N_RAYS;
                    lanes &= lanes - 1;
                    let intersector = rays.intersector(lane);
                    let mut search = searches.get(lane);
                    intersector.test(rays.set, leaf, &mut search);
                    searches.set(lane, &search);
                }
            }
        }
        searches.update_farthest();
    }

    /// Writes the answers of the coherent rays and reports their counters. The first ray of the
    /// packet has index `first`.
    #[inline(always)]
    pub(super) fn answer<P: StreamProbe>(
        &self,
        batch: &mut Batch<'_, Q, P>,
        first: usize,
        coherent: u16,
    ) {
        // Write only the answers that are not the default: selects between both kinds would wait
        // for each other.
        for lane in 0..N_RAYS {
            let search = self.searches.get(lane);
            if coherent >> lane & 1 != 0 && search.has_found() {
                batch.answers[first + lane] = Q::answer(&search);
            }
        }
        if P::COUNTS {
            let traversals = Traversals::<N_RAYS> {
                node_visits: cast_ref(&self.n_visits),
                primitive_tests: cast_ref(&self.n_tests),
                active: coherent.into(),
            };
            batch.probe.traversals(first, &traversals);
        }
    }
}

/// Gain of a packet before its traversal starts, in the unit of [`BOX_COST`]: preparing sixteen
/// rays at once is cheaper.
const START_GAIN: i32 = 20;

/// Cost of a packet's box test. The unit is the cost of a box that a ray enters in a single
/// traversal.
const BOX_COST: i32 = 6;

/// Cost of one ray's test of up to eight primitives, in tests of one primitive against eight rays.
const RAY_COST: u32 = 2;

/// Adds `n` to the counts of these rays.
#[inline(always)]
fn add<I: InstructionSet>(set: I, counts: &mut PerRay<u32>, rays: u16, n: u32) {
    for (counts, rays) in counts.iter_mut().zip(rays.to_le_bytes()) {
        set.add_to(counts, rays, n);
    }
}
