//! The best tree of eight-wide nodes and leaves that can be cut from a binary
//! one.
//!
//! By dynamic programming over the surface area heuristic: Ylitie, Karras and
//! Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
//! BVHs" (HPG 2017), section 3. For each subtree and each number of roots up
//! to seven: the least cost of the subtree as a forest of at most so many
//! roots. An eight-wide node over it then has the cheapest eight roots from
//! its two sides.

use super::binary::{BinaryNode, Kind};
use crate::accel::layout::{LeafKind, MAX_LEAF, NODE_LINES};

/// Most roots of a forest that takes the place of a subtree.
const MAX_ROOTS: usize = 7;
/// Cost of a node.
const NODE_COST: f32 = 1.0;
/// Cost of a leaf whose primitives are tested together, or of one primitive
/// that is not.
const TEST_COST: f32 = 0.7;
/// From so many nodes on both sides are done in parallel.
const PARALLEL: usize = 8192;
/// In `choices`: the subtree is a leaf, if it has one root.
const IS_LEAF: u32 = 1 << 31;

/// The best forests of a subtree.
pub(super) struct Forests {
    /// The cost of at most `i + 1` roots, without what leads to them.
    costs: [f32; MAX_ROOTS],
    /// Lines of the arena that they take.
    n_lines: [u32; MAX_ROOTS],
    n_primitives: usize,
    /// `None` if primitives of several kinds are in it.
    kind: Option<LeafKind>,
}

impl Forests {
    /// Lines of the whole tree as one root.
    pub(super) fn n_lines(&self) -> usize {
        self.n_lines[0] as usize
    }

    fn of_leaf(kind: LeafKind, area: f32) -> Self {
        Self {
            costs: [area * leaf_cost(kind, 1); MAX_ROOTS],
            n_lines: [kind.n_lines(1) as u32; MAX_ROOTS],
            n_primitives: 1,
            kind: Some(kind),
        }
    }
}

fn leaf_cost(kind: LeafKind, n: usize) -> f32 {
    match kind {
        LeafKind::Others => TEST_COST * n as f32,
        LeafKind::Triangles | LeafKind::Spheres => TEST_COST,
    }
}

/// Finds the best forests of a subtree and writes into its nodes how to make
/// them.
pub(super) fn choose(nodes: &mut [BinaryNode]) -> Forests {
    let (node, below) = nodes.split_first_mut().expect("a subtree has a root");
    let area = node.bounds.surface_area();
    let second = match node.kind {
        Kind::Leaf { kind, .. } => {
            let forests = Forests::of_leaf(kind, area);
            node.choices = IS_LEAF;
            node.n_lines = forests.n_lines[0];
            return forests;
        }
        Kind::Inner { second } => second as usize,
    };
    let n = below.len();
    let (left, right) = below.split_at_mut(second - 1);
    let (left, right) = match n < PARALLEL {
        true => (choose(left), choose(right)),
        false => rayon::join(|| choose(left), || choose(right)),
    };
    let forests = combine(&left, &right, area, &mut node.choices);
    node.n_lines = forests.n_lines[0];
    forests
}

/// The best forests of a node of this area over those of its two sides.
fn combine(left: &Forests, right: &Forests, area: f32, choices: &mut u32) -> Forests {
    let n_primitives = left.n_primitives + right.n_primitives;
    let kind = left.kind.filter(|_| left.kind == right.kind);
    let of_eight = Deal::best(left, right, 8);
    let mut costs = [of_eight.cost + NODE_COST * area; MAX_ROOTS];
    let mut n_lines = [of_eight.n_lines + NODE_LINES as u32; MAX_ROOTS];
    *choices = of_eight.choice(8);
    if let Some(kind) = kind.filter(|_| n_primitives <= MAX_LEAF) {
        let cost = area * leaf_cost(kind, n_primitives);
        if cost <= costs[0] {
            costs[0] = cost;
            n_lines[0] = kind.n_lines(n_primitives) as u32;
            *choices |= IS_LEAF;
        }
    }
    for n_roots in 2..=MAX_ROOTS {
        let deal = Deal::best(left, right, n_roots);
        let at = n_roots - 1;
        if deal.cost < costs[at - 1] {
            (costs[at], n_lines[at]) = (deal.cost, deal.n_lines);
            *choices |= deal.choice(n_roots);
        } else {
            (costs[at], n_lines[at]) = (costs[at - 1], n_lines[at - 1]);
        }
    }
    Forests {
        costs,
        n_lines,
        n_primitives,
        kind,
    }
}

/// Roots dealt to the two sides of a node.
struct Deal {
    n_left: usize,
    cost: f32,
    n_lines: u32,
}

impl Deal {
    /// The cheapest one of `n_roots` roots.
    #[inline]
    fn best(left: &Forests, right: &Forests, n_roots: usize) -> Self {
        let cost = |n_left: usize| left.costs[n_left - 1] + right.costs[n_roots - n_left - 1];
        let mut best = (1, cost(1));
        for n_left in 2..n_roots {
            let cost = cost(n_left);
            if cost < best.1 {
                best = (n_left, cost);
            }
        }
        let (n_left, cost) = best;
        Self {
            n_left,
            cost,
            n_lines: left.n_lines[n_left - 1] + right.n_lines[n_roots - n_left - 1],
        }
    }

    /// The left side's share in three bits, for each number of roots from 2.
    fn choice(&self, n_roots: usize) -> u32 {
        (self.n_left as u32) << (3 * (n_roots - 2))
    }
}

/// Whether the subtree is a leaf where it is one root.
pub(super) fn is_leaf(node: &BinaryNode) -> bool {
    node.choices & IS_LEAF != 0
}

/// Up to eight subtrees, by where they stand among the nodes.
#[derive(Default)]
pub(super) struct Roots {
    places: [usize; 8],
    n: usize,
}

impl Roots {
    /// The children of an eight-wide node over the subtree.
    pub(super) fn below(nodes: &[BinaryNode]) -> Self {
        let mut roots = Self::default();
        match nodes[0].kind {
            Kind::Leaf { .. } => roots.add(0),
            Kind::Inner { second } => roots.deal(nodes, 0, second as usize, 8),
        }
        roots
    }

    /// The subtree alone.
    pub(super) fn alone() -> Self {
        let mut roots = Self::default();
        roots.add(0);
        roots
    }

    /// Where they stand.
    pub(super) fn places(&mut self) -> &mut [usize] {
        &mut self.places[..self.n]
    }

    fn add(&mut self, place: usize) {
        self.places[self.n] = place;
        self.n += 1;
    }

    /// Adds the best at most `n_roots` roots of the subtree at `place`.
    fn expand(&mut self, nodes: &[BinaryNode], place: usize, mut n_roots: usize) {
        let node = &nodes[place];
        let share = |n_roots: usize| node.choices >> (3 * (n_roots - 2)) & 7;
        while n_roots > 1 && share(n_roots) == 0 {
            n_roots -= 1;
        }
        match node.kind {
            Kind::Inner { second } if n_roots > 1 => {
                self.deal(nodes, place, second as usize, n_roots);
            }
            _ => self.add(place),
        }
    }

    fn deal(&mut self, nodes: &[BinaryNode], place: usize, second: usize, n_roots: usize) {
        let n_left = (nodes[place].choices >> (3 * (n_roots - 2)) & 7) as usize;
        self.expand(nodes, place + 1, n_left);
        self.expand(nodes, place + second, n_roots - n_left);
    }
}
