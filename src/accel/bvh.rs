//! A binary bounding volume hierarchy.
//!
//! Built from the top by the surface area heuristic over bins (Wald, "On fast
//! Construction of SAH-based Bounding Volume Hierarchies", 2007); traversed
//! front to back with a stack.

use super::search::Search;
use super::slab::Slabs;
use crate::geometry::{Aabb, Ray};
use crate::scene::Primitive;

/// How many bins a node's longest axis is cut into.
const N_BINS: usize = 16;
/// Most primitives in a leaf, where the heuristic has a choice.
const MAX_LEAF: usize = 4;
/// Deepest node, the root being at 0, and so the traversal's stack.
const MAX_DEPTH: usize = 64;
/// Cost of entering a node, in primitive tests.
const NODE_COST: f32 = 1.0;

/// A bounding volume hierarchy over some of a scene's primitives.
#[derive(Debug, Clone)]
pub struct Bvh {
    /// Depth first: a node's first child follows it.
    nodes: Vec<Node>,
    /// Indices of primitives, leaf by leaf.
    order: Vec<u32>,
    depth: usize,
}

/// The size of a hierarchy.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct BvhStatistics {
    /// Inner nodes and leaves.
    pub n_nodes: usize,
    /// Leaves alone.
    pub n_leaves: usize,
    /// Edges from the root to the deepest leaf.
    pub depth: usize,
    /// Expected cost of a ray through the root's box, in primitive tests, by
    /// the surface area heuristic.
    pub sah_cost: f32,
    /// Memory of nodes and order.
    pub bytes: usize,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    bounds: Aabb,
    kind: Kind,
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    /// `order[first..first + n]`.
    Leaf { first: u32, n: u32 },
    /// The first child is the next node.
    Inner { second_child: u32 },
}

/// A primitive during the build.
#[derive(Clone, Copy)]
struct Reference {
    bounds: Aabb,
    index: u32,
}

impl Bvh {
    /// Bytes of memory for each primitive, at most.
    pub const MAX_BYTES_PER_PRIMITIVE: usize =
        2 * size_of::<Node>() + size_of::<u32>() + size_of::<Reference>();

    /// Builds the hierarchy over the primitives with these indices.
    pub fn new(primitives: &[Primitive], indices: Vec<u32>) -> Self {
        let mut references: Vec<Reference> = indices
            .into_iter()
            .map(|index| Reference {
                bounds: primitives[index as usize].bounds(),
                index,
            })
            .collect();
        let mut bvh = Self {
            nodes: Vec::with_capacity(2 * references.len()),
            order: Vec::with_capacity(references.len()),
            depth: 0,
        };
        if !references.is_empty() {
            bvh.add_subtree(&mut references, 0);
        }
        bvh.nodes.shrink_to_fit();
        bvh
    }

    /// Its size and expected cost.
    pub fn statistics(&self) -> BvhStatistics {
        let root_area = self
            .nodes
            .first()
            .map_or(1.0, |root| root.bounds.surface_area());
        let cost = |node: &Node| {
            let tests = match node.kind {
                Kind::Leaf { n, .. } => n as f32,
                Kind::Inner { .. } => 0.0,
            };
            f64::from((NODE_COST + tests) * node.bounds.surface_area() / root_area)
        };
        let is_leaf = |node: &&Node| matches!(node.kind, Kind::Leaf { .. });
        BvhStatistics {
            n_nodes: self.nodes.len(),
            n_leaves: self.nodes.iter().filter(is_leaf).count(),
            depth: self.depth,
            sah_cost: self.nodes.iter().map(cost).sum::<f64>() as f32,
            bytes: size_of_val(&self.nodes[..]) + size_of_val(&self.order[..]),
        }
    }

    /// Shows the primitives that the ray may hit to the search, near ones
    /// first; gives the number of nodes entered.
    pub(super) fn traverse<S: Search>(&self, ray: &Ray, search: &mut S) -> u32 {
        let Some(root) = self.nodes.first() else {
            return 0;
        };
        let slabs = Slabs::new(ray, &root.bounds);
        let Some(root_t) = slabs.enter(&root.bounds, search.t_max()) else {
            return 0;
        };
        let mut n_visits = 0;
        // Nodes that wait, with where the ray enters them: a visit takes one
        // off and puts two on, so that one slot a level is enough.
        let mut stack = [(0.0, 0); MAX_DEPTH + 2];
        stack[0] = (root_t, 0);
        let mut n_waiting = 1;
        while n_waiting > 0 && !search.is_done() {
            n_waiting -= 1;
            let (t, index) = stack[n_waiting];
            if t > search.t_max() {
                continue;
            }
            n_visits += 1;
            match self.nodes[index as usize].kind {
                Kind::Leaf { first, n } => {
                    let leaf = &self.order[first as usize..][..n as usize];
                    leaf.iter().for_each(|&primitive| search.test(primitive));
                }
                Kind::Inner { second_child } => {
                    let enter = |child: u32| {
                        let bounds = &self.nodes[child as usize].bounds;
                        slabs.enter(bounds, search.t_max()).map(|t| (t, child))
                    };
                    let (first, second) = (enter(index + 1), enter(second_child));
                    let first_is_nearer = match (first, second) {
                        (Some((t0, _)), Some((t1, _))) => t0 <= t1,
                        _ => true,
                    };
                    // The nearer one last, so that it is taken off first.
                    let far_then_near = match first_is_nearer {
                        true => [second, first],
                        false => [first, second],
                    };
                    for child in far_then_near.into_iter().flatten() {
                        stack[n_waiting] = child;
                        n_waiting += 1;
                    }
                }
            }
        }
        n_visits
    }

    /// Adds the nodes over the references, which it may reorder.
    fn add_subtree(&mut self, references: &mut [Reference], depth: usize) {
        let bounds = union_of(references);
        let index = self.nodes.len();
        self.depth = self.depth.max(depth);
        match split(references, &bounds, depth) {
            None => {
                let (first, n) = (self.order.len() as u32, references.len() as u32);
                self.order
                    .extend(references.iter().map(|reference| reference.index));
                self.nodes.push(Node {
                    bounds,
                    kind: Kind::Leaf { first, n },
                });
            }
            Some(middle) => {
                let kind = Kind::Inner { second_child: 0 };
                self.nodes.push(Node { bounds, kind });
                let (left, right) = references.split_at_mut(middle);
                self.add_subtree(left, depth + 1);
                let second_child = self.nodes.len() as u32;
                self.nodes[index].kind = Kind::Inner { second_child };
                self.add_subtree(right, depth + 1);
            }
        }
    }
}

/// Reorders the references into two groups and gives the size of the first;
/// `None` to make them one leaf.
fn split(references: &mut [Reference], bounds: &Aabb, depth: usize) -> Option<usize> {
    let n = references.len();
    if n == 1 {
        return None;
    }
    // Halving needs log2(n) levels more: switch to it before they run out.
    let levels_of_halves = n.next_power_of_two().trailing_zeros() as usize;
    let candidate = match depth + levels_of_halves < MAX_DEPTH {
        true => best_bin_split(references),
        false => None,
    };
    let leaf_cost = n as f32 * bounds.surface_area();
    let split_cost = |cost: f32| NODE_COST * bounds.surface_area() + cost;
    match candidate {
        Some(plane) if n > MAX_LEAF || split_cost(plane.cost) < leaf_cost => {
            Some(partition(references, |reference| plane.is_left(reference)))
        }
        None if n > MAX_LEAF => Some(n / 2),
        _ => None,
    }
}

/// A way to part references in two: by the bin of their centres on one axis.
struct BinSplit {
    axis: usize,
    from: f32,
    bins_per_length: f32,
    n_left_bins: usize,
    /// Sum over both sides of area times number.
    cost: f32,
}

impl BinSplit {
    fn is_left(&self, reference: &Reference) -> bool {
        bin(reference, self.axis, self.from, self.bins_per_length) < self.n_left_bins
    }
}

/// The cheapest split over the axes; `None` if all centres coincide.
fn best_bin_split(references: &[Reference]) -> Option<BinSplit> {
    let centers = Aabb::of_points(references.iter().map(|reference| reference.bounds.center()));
    (0..3)
        .filter_map(|axis| {
            let extent = centers.max[axis] - centers.min[axis];
            let bins_per_length = N_BINS as f32 / extent;
            let usable = extent > 0.0 && bins_per_length.is_finite();
            usable.then(|| best_split_along(references, axis, centers.min[axis], bins_per_length))
        })
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
}

fn best_split_along(
    references: &[Reference],
    axis: usize,
    from: f32,
    bins_per_length: f32,
) -> BinSplit {
    let mut bins = [(Aabb::EMPTY, 0_u32); N_BINS];
    for reference in references {
        let (bounds, n) = &mut bins[bin(reference, axis, from, bins_per_length)];
        *bounds = bounds.union(reference.bounds);
        *n += 1;
    }
    let grow = |(bounds, n): &mut (Aabb, u32), bin: &(Aabb, u32)| {
        (*bounds, *n) = (bounds.union(bin.0), *n + bin.1);
        Some((bounds.surface_area() * *n as f32, *n))
    };
    let left = bins.iter().scan((Aabb::EMPTY, 0), grow);
    let mut right: Vec<_> = bins.iter().rev().scan((Aabb::EMPTY, 0), grow).collect();
    right.reverse();
    let (n_left_bins, cost) = left
        .zip(&right[1..])
        .enumerate()
        .filter(|(_, (left, right))| left.1 > 0 && right.1 > 0)
        .map(|(i, (left, right))| (i + 1, left.0 + right.0))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((1, f32::INFINITY));
    BinSplit {
        axis,
        from,
        bins_per_length,
        n_left_bins,
        cost,
    }
}

fn bin(reference: &Reference, axis: usize, from: f32, bins_per_length: f32) -> usize {
    let center = reference.bounds.center()[axis];
    (((center - from) * bins_per_length) as usize).min(N_BINS - 1)
}

fn union_of(references: &[Reference]) -> Aabb {
    references.iter().fold(Aabb::EMPTY, |bounds, reference| {
        bounds.union(reference.bounds)
    })
}

/// Moves the left references to the front and gives their number, neither
/// none nor all.
fn partition(references: &mut [Reference], is_left: impl Fn(&Reference) -> bool) -> usize {
    let mut n_left = 0;
    for i in 0..references.len() {
        if is_left(&references[i]) {
            references.swap(i, n_left);
            n_left += 1;
        }
    }
    n_left.clamp(1, references.len() - 1)
}
