//! The cheapest eight-wide trees of a subtree, for `collapse`.
//!
//! Dynamic programming over the surface area heuristic: Ylitie, Karras and Laine, "Efficient
//! Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs" (HPG 2017), section 3. For each
//! subtree and each number of roots up to seven: the least cost of the subtree as a forest of at
//! most that many roots. The children of an eight-wide node are the cheapest eight roots out of the
//! two subtrees.
//!
//! # Two surface area heuristics
//!
//! The collapse minimizes the *time SAH*: expected traversal time in units of the time for a node.
//! The kernel tests all triangles or spheres of a leaf at once, so a leaf costs the same with one
//! or with eight of them. [`sah_cost`](crate::accel::BvhStatistics::sah_cost) reports the *count
//! SAH*: the expected sum of node visits and primitive tests, in which each primitive counts. Only
//! the count SAH can be compared with the counters of a rendering; only the time SAH makes fast
//! trees: with the count SAH leaves would be small, and their lanes empty.

use super::bounds::LaneBounds;
use super::reference::Reference;
use crate::accel::layout::{LeafKind, MAX_LEAF, NODE_LINES};
use math::simd::{Arithmetic, InstructionSet, Lanes, N_LANES};

/// Greatest number of roots of a forest that replaces a subtree.
const MAX_ROOTS: usize = 7;
/// Cost of a node in the time SAH.
const NODE_TIME: f32 = 1.0;
/// Cost in the time SAH of a leaf whose primitives are tested at once, or of a primitive that is
/// tested separately.
const TEST_TIME: f32 = 0.7;

/// The cheapest forests of a subtree.
#[derive(Clone, Copy)]
pub(super) struct Forests {
    /// Entry `i`: the cost of a forest of at most `i + 1` roots, in units of half a surface area;
    /// infinite in the last entry.
    costs: [f32; N_LANES],
    /// Entry `i`: the cache lines that this forest takes in the arena.
    n_lines: [u32; N_LANES],
    n_primitives: usize,
    /// `None` if the subtree has primitives of several kinds.
    kind: Option<LeafKind>,
}

/// The forms of a subtree, as one root of a forest or as several.
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Zeroable)]
pub(super) struct ForestChoices(u32);

impl ForestChoices {
    const IS_LEAF: u32 = 1 << 31;

    /// Returns true if the subtree becomes a leaf where it is a single root.
    pub(super) fn is_leaf(self) -> bool {
        self.0 & Self::IS_LEAF != 0
    }

    /// Returns the number of references of that leaf.
    pub(super) fn leaf_size(self) -> usize {
        (self.0 >> 21 & 7) as usize + 1
    }

    /// Returns how many of `n_roots` roots, two or more, the first of the two subtrees gets; 0 if
    /// fewer roots cost no more.
    pub(super) fn n_first(self, n_roots: usize) -> usize {
        (self.0 >> (3 * (n_roots - 2)) & 7) as usize
    }

    #[inline(always)]
    fn set(&mut self, n_roots: usize, n_first: usize) {
        self.0 |= (n_first as u32) << (3 * (n_roots - 2));
    }

    #[inline(always)]
    fn set_leaf(&mut self, n: usize) {
        self.0 |= Self::IS_LEAF | (n as u32 - 1) << 21;
    }
}

/// Returns the cost of a leaf in the time SAH.
#[inline(always)]
fn leaf_time(kind: LeafKind, n: usize) -> f32 {
    match kind {
        LeafKind::Others => TEST_TIME * n as f32,
        LeafKind::Triangles | LeafKind::Spheres | LeafKind::Capsules => TEST_TIME,
    }
}

impl Forests {
    /// Returns the forests of a single reference: a leaf.
    #[inline(always)]
    pub(super) fn from_reference(reference: &Reference) -> Self {
        let kind = reference.kind();
        let mut costs = [reference.half_area() * leaf_time(kind, 1); N_LANES];
        costs[MAX_ROOTS] = f32::INFINITY;
        Self {
            costs,
            n_lines: [kind.n_lines(1) as u32; N_LANES],
            n_primitives: 1,
            kind: Some(kind),
        }
    }

    /// Returns the forests of references of one kind, where no division costs less than one leaf,
    /// and the choices that lead to them.
    #[inline(always)]
    pub(super) fn from_leaf(kind: LeafKind, n: usize, half_area: f32) -> (Self, ForestChoices) {
        let mut costs = [half_area * leaf_time(kind, n); N_LANES];
        costs[MAX_ROOTS] = f32::INFINITY;
        let forests = Self {
            costs,
            n_lines: [kind.n_lines(n) as u32; N_LANES],
            n_primitives: n,
            kind: Some(kind),
        };
        let mut choices = ForestChoices(0);
        choices.set_leaf(n);
        (forests, choices)
    }

    /// Returns the forests of two references that are tested at once in a leaf, given the half
    /// areas of both and of their box, and the choices that lead to them.
    #[inline(always)]
    pub(super) fn from_pair(
        kind: LeafKind,
        half_areas: [f32; 2],
        half_area: f32,
    ) -> (Self, ForestChoices) {
        let (mut forests, mut choices) = Self::from_leaf(kind, 2, half_area);
        let [first, second] = half_areas;
        let apart = TEST_TIME * first + TEST_TIME * second;
        if apart < forests.costs[0] {
            for n_roots in 2..=MAX_ROOTS {
                forests.costs[n_roots - 1] = apart;
                forests.n_lines[n_roots - 1] = 2 * kind.n_lines(1) as u32;
            }
            choices.set(2, 1);
        }
        (forests, choices)
    }

    /// Returns the cost of the subtree as a single root.
    #[inline(always)]
    pub(super) fn cost(&self) -> f32 {
        self.costs[0]
    }

    /// Returns the cache lines of the subtree as a single root.
    #[inline(always)]
    pub(super) fn n_lines(&self) -> u32 {
        self.n_lines[0]
    }

    /// Returns the forests of a node within these bounds, combined from the forests of its two
    /// subtrees, and the choices that lead to them.
    #[inline(always)]
    pub(super) fn combine<I: InstructionSet>(
        set: I,
        first: &Self,
        second: &Self,
        bounds: &LaneBounds,
    ) -> (Self, ForestChoices) {
        let half_area = bounds.half_area();
        let best = Distributions::best(set, first, second);
        let mut choices = ForestChoices(0);
        let (mut costs, mut n_lines) = ([f32::INFINITY; N_LANES], [0; N_LANES]);
        // One root as a node, whose children are eight roots.
        costs[0] = best.costs[7] + NODE_TIME * half_area;
        n_lines[0] = best.n_lines(8, first, second) + NODE_LINES as u32;
        choices.set(8, best.n_first(8));
        // One root as a leaf, if it costs no more.
        let n_primitives = first.n_primitives + second.n_primitives;
        let kind = first.kind.filter(|_| first.kind == second.kind);
        if let Some(kind) = kind.filter(|_| n_primitives <= MAX_LEAF) {
            let cost = half_area * leaf_time(kind, n_primitives);
            if cost <= costs[0] {
                costs[0] = cost;
                n_lines[0] = kind.n_lines(n_primitives) as u32;
                choices.set_leaf(n_primitives);
            }
        }
        // Two to seven roots, distributed over the subtrees, where they cost less than fewer.
        for n_roots in 2..=MAX_ROOTS {
            let at = n_roots - 1;
            if best.costs[at] < costs[at - 1] {
                costs[at] = best.costs[at];
                n_lines[at] = best.n_lines(n_roots, first, second);
                choices.set(n_roots, best.n_first(n_roots));
            } else {
                (costs[at], n_lines[at]) = (costs[at - 1], n_lines[at - 1]);
            }
        }
        let forests = Self {
            costs,
            n_lines,
            n_primitives,
            kind,
        };
        (forests, choices)
    }
}

/// The cheapest distributions of roots over the two subtrees of a node.
struct Distributions {
    /// Entry `i`: the cost with `i + 1` roots, two or more.
    costs: [f32; N_LANES],
    /// Entry `i`: the roots of the first subtree, a small integer.
    n_first: [f32; N_LANES],
}

impl Distributions {
    #[inline(always)]
    fn best<I: InstructionSet>(set: I, first: &Forests, second: &Forests) -> Self {
        let of_second = set.load(&second.costs);
        let mut costs = set.splat(f32::INFINITY);
        let mut n_first = set.splat(1.0);
        // More roots than primitives cost no less.
        for n in 1..=first.n_primitives.min(MAX_ROOTS) {
            // Lane i: the second subtree gets the other i + 1 - n roots.
            let rest = of_second.permute(&SHIFTS[n - 1], set.splat_bits(0));
            let cost = set.splat(first.costs[n - 1]) + rest;
            let is_cheaper = cost.lt(costs);
            costs = cost.min(costs);
            n_first = I::Lanes::select(is_cheaper, set.splat(n as f32), n_first);
        }
        Self {
            costs: costs.to_array(),
            n_first: n_first.to_array(),
        }
    }

    #[inline(always)]
    fn n_first(&self, n_roots: usize) -> usize {
        // From 1 to 7; the mask avoids bounds checks.
        self.n_first[n_roots - 1] as u32 as usize & 7
    }

    /// Returns the cache lines of `n_roots` roots.
    #[inline(always)]
    fn n_lines(&self, n_roots: usize, first: &Forests, second: &Forests) -> u32 {
        let n_first = self.n_first(n_roots);
        let n_second = (n_roots - n_first) & 7;
        first.n_lines[(n_first - 1) & 7] + second.n_lines[(n_second - 1) & 7]
    }
}

/// Row `k` moves lanes up by `k + 1`; the last lane fills the lanes below.
static SHIFTS: [[u32; N_LANES]; MAX_ROOTS] = {
    let mut shifts = [[7; N_LANES]; MAX_ROOTS];
    let mut k = 0;
    while k < MAX_ROOTS {
        let mut lane = k + 1;
        while lane < N_LANES {
            shifts[k][lane] = (lane - k - 1) as u32;
            lane += 1;
        }
        k += 1;
    }
    shifts
};

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use math::simd::{Simd, SimdKernel};

    struct Best<'a>(&'a Forests, &'a Forests);

    impl SimdKernel for Best<'_> {
        type Output = Distributions;

        #[inline(always)]
        fn run<I: InstructionSet>(self, set: I) -> Distributions {
            Distributions::best(set, self.0, self.1)
        }
    }

    /// Returns forests with these costs.
    fn forests(costs: [u8; MAX_ROOTS]) -> Forests {
        let mut forests = Forests {
            costs: [f32::INFINITY; N_LANES],
            n_lines: [0; N_LANES],
            n_primitives: MAX_ROOTS,
            kind: None,
        };
        for (entry, cost) in forests.costs.iter_mut().zip(costs) {
            *entry = f32::from(cost);
        }
        forests
    }

    proptest! {
        #[test]
        fn the_best_distribution_is_the_first_of_the_cheapest(
            // Few different numbers, so that some sums are equal.
            first in prop::array::uniform7(0_u8..9),
            second in prop::array::uniform7(0_u8..9),
        ) {
            for simd in Simd::available() {
                let best = simd.run(Best(&forests(first), &forests(second)));
                for n_roots in 2..=8 {
                    let cost = |n_first: usize| first[n_first - 1] + second[n_roots - n_first - 1];
                    let n_first = (1..n_roots).min_by_key(|&n_first| cost(n_first)).unwrap();
                    prop_assert_eq!(best.n_first(n_roots), n_first);
                    prop_assert_eq!(best.costs[n_roots - 1], f32::from(cost(n_first)));
                }
            }
        }
    }
}
