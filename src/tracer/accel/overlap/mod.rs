//! End-point overlap: surfaces in the boxes of nodes that do not hold them.
//!
//! A ray that ends on a surface visits every node whose box has the end in it, also nodes that do
//! not hold the surface. The surface area heuristic, which is about long rays, leaves these visits
//! out. With `S` the surfaces of all primitives, `Q(n)` those of the primitives in the leaves of
//! node `n` and below, and `C(n)` the cost of a visit, 1 for an inner node and the number of
//! primitives for a leaf, the end-point overlap of the hierarchy is the sum over its nodes of
//! `C(n) area((S \ Q(n)) ∩ box(n)) / area(S)` (T. Aila, T. Karras, S. Laine, On Quality Metrics of
//! Bounding Volume Hierarchies, High-Performance Graphics 2013).

mod surface;

use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use crate::accel::layout::{self, CacheLine, NodeRef};
use crate::accel::nodes::BvhNode;
use crate::accel::statistics::NODE_COUNT;
use surface::{Clipper, FacetedSurface};
use world::geometry::Aabb;
use world::scene::Primitive;

/// A part of the whole surface that counts as 1: parts are integers, so that their sums do not
/// depend on the order of threads.
const WHOLE: f64 = (1_u64 << 63) as f64;

/// Sets the end-point overlap of the nodes, which are the list of all nodes of an arena with these
/// lines.
pub(super) fn measure(lines: &[CacheLine], primitives: &[Primitive], nodes: &mut [BvhNode]) {
    measure_of(&references(lines, nodes), primitives, nodes);
}

/// Sets the end-point overlap of the nodes, given the primitives in their leaves in ascending order.
fn measure_of(references: &[LeafReference], primitives: &[Primitive], nodes: &mut [BvhNode]) {
    let groups = references.chunk_by(|a, b| a.primitive == b.primitive);
    let groups: Vec<&[LeafReference]> = groups.collect();
    let surface =
        |group: &[LeafReference]| FacetedSurface::new(&primitives[group[0].primitive as usize]);
    let areas: Vec<f64> = groups
        .par_iter()
        .map(|group| surface(group).area())
        .collect();
    let parents = parents(nodes);
    let walk = OverlapWalk {
        ends: ends(&parents),
        parts: nodes.iter().map(|_| AtomicU64::new(0)).collect(),
        unit: areas.iter().sum::<f64>().max(f64::MIN_POSITIVE) / WHOLE,
        nodes,
    };
    groups
        .par_iter()
        .for_each_init(Clipper::default, |clipper, group| {
            let bounds = primitives[group[0].primitive as usize].bounds();
            walk.add(&surface(group), bounds, group, clipper);
        });
    let cost = |(node, part): (&BvhNode, AtomicU64)| {
        let n = if node.is_leaf {
            node.n_primitives.into()
        } else {
            NODE_COUNT
        };
        n * part.into_inner() as f64 / WHOLE
    };
    let mut costs: Vec<f64> = walk.nodes.iter().zip(walk.parts).map(cost).collect();
    for i in (1..costs.len()).rev() {
        costs[parents[i]] += costs[i];
    }
    for (node, cost) in nodes.iter_mut().zip(costs) {
        node.epo = Some(cost as f32);
    }
}

/// A primitive in a leaf.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct LeafReference {
    primitive: u32,
    /// Index in the list of nodes.
    leaf: u32,
}

/// Returns the primitives in all leaves, by primitive.
fn references(lines: &[CacheLine], nodes: &[BvhNode]) -> Vec<LeafReference> {
    let mut references = Vec::new();
    let inner = nodes.iter().filter(|node| !node.is_leaf);
    for node in inner.map(|node| layout::node(lines, NodeRef::node(node.id))) {
        let children = node.children[..node.n_children()]
            .iter()
            .map(|&child| NodeRef(child));
        for leaf in children.filter(|child| child.is_leaf()) {
            let (_, indices) = layout::contents(leaf, bytemuck::cast_slice(&lines[leaf.line()..]));
            let leaf = index_of(nodes, leaf.line() as u32) as u32;
            references.extend(
                indices
                    .into_iter()
                    .map(|primitive| LeafReference { primitive, leaf }),
            );
        }
    }
    references.par_sort_unstable();
    references
}

/// Returns the index of each node's parent, and 0 for the root.
fn parents(nodes: &[BvhNode]) -> Vec<usize> {
    let parent = |node: &BvhNode| node.parent.map_or(0, |parent| index_of(nodes, parent));
    nodes.iter().map(parent).collect()
}

fn index_of(nodes: &[BvhNode], id: u32) -> usize {
    let found = nodes.binary_search_by_key(&id, |node| node.id);
    found.expect("the node is listed")
}

/// Returns the index of the first node after each node's subtree: descendants follow their
/// ancestors at once.
fn ends(parents: &[usize]) -> Vec<usize> {
    let mut ends: Vec<usize> = (1..=parents.len()).collect();
    for i in (1..ends.len()).rev() {
        ends[parents[i]] = ends[parents[i]].max(ends[i]);
    }
    ends
}

/// The nodes and the parts of the surface in their boxes.
struct OverlapWalk<'a> {
    nodes: &'a [BvhNode],
    ends: Vec<usize>,
    parts: Vec<AtomicU64>,
    /// The area of a part of 1.
    unit: f64,
}

impl OverlapWalk<'_> {
    /// Adds the surface of the primitive of a group to all nodes that do not hold it.
    fn add(
        &self,
        surface: &FacetedSurface,
        bounds: Aabb,
        group: &[LeafReference],
        clipper: &mut Clipper,
    ) {
        let mut i = 0;
        while let Some(node) = self.nodes.get(i) {
            let subtree = i..self.ends[i];
            let is_held = group.iter().any(|at| subtree.contains(&(at.leaf as usize)));
            let is_apart = is_held || !node.bounds.overlaps(bounds);
            let area = if is_apart {
                0.0
            } else {
                surface.area_within(&node.bounds, clipper)
            };
            if area > 0.0 {
                let part = (area / self.unit) as u64;
                self.parts[i].fetch_add(part, Ordering::Relaxed);
            }
            // The boxes of descendants are in the node's.
            let is_entered = is_held || area > 0.0;
            i = if is_entered { i + 1 } else { subtree.end };
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use proptest::prelude::*;

    use super::*;
    use crate::accel::{Accel, Acceleration, Quality};
    use world::geometry::{Shape, Sphere, Triangle};
    use world::scene::{MaterialId, ObjectId};

    fn primitive(shape: Shape) -> Primitive {
        Primitive::new(shape, None, ObjectId(0), MaterialId(0))
    }

    fn triangle(vertices: [Vec3; 3]) -> Primitive {
        primitive(Shape::Triangle(Triangle { vertices }))
    }

    /// A node between two coordinates on x: the root has the ID 0 and the leaves.
    fn node(id: u32, from: f32, to: f32, n_primitives: u32) -> BvhNode {
        BvhNode {
            id,
            parent: (id > 0).then_some(0),
            bounds: Aabb {
                min: Vec3::new(from, 0.0, 0.0),
                max: Vec3::new(to, 2.0, 0.0),
            },
            depth: id.min(1),
            is_leaf: id > 0,
            n_primitives,
            sah_cost: 0.0,
            epo: None,
            mesh: None,
        }
    }

    /// Right angles with legs of 2 along x and y, in a leaf of one triangle and a leaf of two.
    #[test]
    fn three_triangles_overlap_as_computed_by_hand() {
        let right_angle = |x: f32| {
            let corner = Vec3::new(x, 0.0, 0.0);
            triangle([corner, corner + 2.0 * Vec3::X, corner + 2.0 * Vec3::Y])
        };
        let primitives = [0.0, 1.0, 10.0].map(right_angle);
        let mut nodes = [
            node(0, 0.0, 12.0, 3),
            node(4, 0.0, 2.0, 1),
            node(5, 1.0, 12.0, 2),
        ];
        let leaves = [1, 2, 2].into_iter().zip(0..);
        let references = leaves.map(|(leaf, primitive)| LeafReference { primitive, leaf });
        let references: Vec<LeafReference> = references.collect();
        measure_of(&references, &primitives, &mut nodes);
        // Of an area of 6: 1.5 of the second triangle in the first leaf, and 0.5 of the first
        // triangle in the second leaf, which has two tests.
        let expected = [1.5 + 2.0 * 0.5, 1.5, 2.0 * 0.5].map(|area| Some(area / 6.0));
        assert_eq!(nodes.map(|node| node.epo), expected);
    }

    /// Measures the overlap of every node with every primitive.
    fn slow_twin(references: &[LeafReference], primitives: &[Primitive], nodes: &[BvhNode]) -> f64 {
        let is_above = |i: usize, leaf: u32| {
            let mut above = Some(nodes[leaf as usize]);
            while let Some(node) = above.filter(|node| node.id != nodes[i].id) {
                above = node.parent.map(|parent| nodes[index_of(nodes, parent)]);
            }
            above.is_some()
        };
        let mut clipper = Clipper::default();
        let mut sum = 0.0;
        for (i, node) in nodes.iter().enumerate() {
            let cost = if node.is_leaf { node.n_primitives } else { 1 };
            for (primitive, number) in primitives.iter().zip(0..) {
                let mut of_primitive = references.iter().filter(|at| at.primitive == number);
                if !of_primitive.any(|at| is_above(i, at.leaf)) {
                    let area =
                        FacetedSurface::new(primitive).area_within(&node.bounds, &mut clipper);
                    sum += f64::from(cost) * area;
                }
            }
        }
        let areas = primitives
            .iter()
            .map(|primitive| FacetedSurface::new(primitive).area());
        sum / areas.sum::<f64>()
    }

    fn point() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-1.0_f32..1.0).prop_map(Vec3::from)
    }

    fn shape() -> impl Strategy<Value = Primitive> {
        let small = (point(), prop::array::uniform3(point()))
            .prop_map(|(at, corners)| triangle(corners.map(|corner| at + 0.2 * corner)));
        let large = prop::array::uniform3(point()).prop_map(triangle);
        let sphere = (point(), 0.01_f32..0.3)
            .prop_map(|(center, radius)| primitive(Shape::Sphere(Sphere { center, radius })));
        prop_oneof![4 => small, 1 => large, 1 => sphere]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn the_overlap_is_the_sum_over_all_nodes_and_primitives(
            primitives in prop::collection::vec(shape(), 1..120),
            quality in prop::sample::select(vec![Quality::Fast, Quality::Balanced, Quality::High]),
        ) {
            let accel = Accel::new(&primitives[..], Acceleration::Bvh(quality));
            let mut nodes = accel.nodes();
            accel.measure_overlap(&mut nodes);
            let lines = accel.index.upper.bvh.as_ref().unwrap().arena().lines();
            let references = references(lines, &nodes);
            let expected = slow_twin(&references, &primitives, &nodes);
            let found = f64::from(nodes[0].epo.unwrap());
            prop_assert!((found - expected).abs() <= 1e-6 * expected, "{found} {expected}");

            let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
            let mut again = accel.nodes();
            one.install(|| accel.measure_overlap(&mut again));
            prop_assert_eq!(again, nodes);
        }
    }
}
