//! The costs attributed to objects, materials, primitives and nodes.

use scene::config::BvhLimits;
use tracer::accel::BvhNode;
use tracer::cost::{Metric, RayKind};

/// The work of some rays.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Work {
    /// Number of rays.
    pub rays: u64,
    /// BVH node visits of the rays.
    pub node_visits: u64,
    /// Primitive tests of the rays.
    pub primitive_tests: u64,
    /// Thread time of the rays in picoseconds, as integers so that sums do not depend on their
    /// order; 0 if no time was measured.
    pub time_ps: u64,
    /// The pixels that camera rays are samples of, in units of [`Self::PIXEL_UNIT`]: integers for
    /// the same reason.
    pub pixel_units: u64,
}

impl Work {
    /// A whole pixel: each of its `n` camera rays counts as an n-th of it, rounded.
    pub const PIXEL_UNIT: u64 = 1 << 30;

    /// The counted metrics of rays, in order of preference.
    pub const COUNTED: [Metric; 3] = [Metric::NODE_VISITS, Metric::PRIMITIVE_TESTS, Metric::RAYS];

    /// Returns one of [`Self::COUNTED`], or the time in nanoseconds for any metric of times; 0 for
    /// any other.
    pub fn get(&self, metric: Metric) -> f64 {
        match metric {
            _ if metric.is_timed() => (self.time_ps as f64 / 1e3).round(),
            Metric::NODE_VISITS => self.node_visits as f64,
            Metric::PRIMITIVE_TESTS => self.primitive_tests as f64,
            Metric::RAYS => self.rays as f64,
            _ => 0.0,
        }
    }

    /// Adds the costs of both.
    pub fn with(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            node_visits: self.node_visits + other.node_visits,
            primitive_tests: self.primitive_tests + other.primitive_tests,
            time_ps: self.time_ps + other.time_ps,
            pixel_units: self.pixel_units + other.pixel_units,
        }
    }
}

/// The rule by which a ray's cost is attributed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AttributionRule {
    /// To the first hit of the ray's path: a visible object is charged for its shadow rays and its
    /// reflections.
    Primary,
    /// To the ray's hit; for a shadow ray to its occluder.
    Hit,
}

impl AttributionRule {
    /// Both rules.
    pub const ALL: [Self; 2] = [Self::Primary, Self::Hit];

    /// Returns the rule's name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Hit => "hit",
        }
    }
}

/// The cost attributed to an object or a material, or to the background.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct AttributedCost {
    /// Indexed by [`AttributionRule`], then by [`RayKind`].
    pub(super) work: [[Work; RayKind::ALL.len()]; 2],
}

impl AttributedCost {
    /// Returns the work of rays of one kind.
    pub fn work(&self, charge: AttributionRule, kind: RayKind) -> Work {
        self.work[charge as usize][kind as usize]
    }

    /// Returns the work of all rays.
    pub fn all(&self, charge: AttributionRule) -> Work {
        let kinds = self.work[charge as usize];
        kinds.into_iter().fold(Work::default(), Work::with)
    }

    /// Adds the costs of both.
    pub fn with(self, other: Self) -> Self {
        let both =
            |charge: usize, kind: usize| self.work[charge][kind].with(other.work[charge][kind]);
        Self {
            work: std::array::from_fn(|charge| std::array::from_fn(|kind| both(charge, kind))),
        }
    }

    /// Returns the number of pixels covered, each of a pixel's samples counted as its share.
    pub fn n_pixels(&self) -> f64 {
        let units = self.work(AttributionRule::Hit, RayKind::Camera).pixel_units;
        units as f64 / Work::PIXEL_UNIT as f64
    }

    /// Returns the number of camera rays that hit the object.
    pub fn n_samples(&self) -> u64 {
        self.work(AttributionRule::Hit, RayKind::Camera).rays
    }
}

/// The visits of a node or the tests of a primitive.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Visits {
    /// Number of visits or tests.
    pub n: u64,
    /// Number of successful ones: visits that continued to a child, or tests that found the nearest
    /// hit so far.
    pub n_hits: u64,
    /// Thread time in picoseconds; 0 if no time was measured.
    pub time_ps: u64,
}

impl Visits {
    /// Returns the number of unsuccessful visits or tests.
    pub fn n_wasted(&self) -> u64 {
        self.n - self.n_hits
    }

    /// Returns the time in nanoseconds.
    pub fn time_ns(&self) -> f32 {
        (self.time_ps as f64 / 1e3) as f32
    }
}

/// The nodes of the hierarchy and their visits.
#[derive(Debug, Clone, PartialEq)]
pub struct Hierarchy {
    /// Inner nodes and leaves, each before its descendants.
    pub nodes: Vec<BvhNode>,
    /// The visits of each node. A ray that visits a leaf is tested against all of its primitives.
    /// The time of a leaf is the time of its tests; the time of an inner node excludes its
    /// children.
    pub visits: Vec<Visits>,
}

impl Hierarchy {
    /// Returns the measured cost of each subtree per ray that visited the root, on the scale of
    /// [`BvhNode::sah_cost`], which predicts it: one for each node visit and each primitive test in
    /// the subtree, divided by the visits of the root. 0 for a subtree that no ray visited.
    pub fn costs(&self) -> Vec<f32> {
        let steps = self.nodes.iter().zip(&self.visits);
        let mut steps: Vec<u64> = steps
            .map(|(node, visits)| own_steps(node, visits))
            .collect();
        // Descendants come after their ancestors.
        for i in (1..self.nodes.len()).rev() {
            if let Some(parent) = self.nodes[i].parent {
                let parent = self.nodes.binary_search_by_key(&parent, |node| node.id);
                steps[parent.expect("the parents are listed")] += steps[i];
            }
        }
        let n_rays = self.visits.first().map_or(0, |root| root.n).max(1);
        let per_ray = |steps| (steps as f64 / n_rays as f64) as f32;
        steps.into_iter().map(per_ray).collect()
    }

    /// Returns the nodes within the limits in their order, each with its visits and its entry of
    /// [`Self::costs`].
    pub fn within(&self, limits: BvhLimits) -> Vec<(&BvhNode, &Visits, f32)> {
        let all = self.nodes.iter().zip(&self.visits).zip(self.costs());
        all.map(|((node, visits), cost)| (node, visits, cost))
            .filter(|(node, visits, _)| limits.include(node.depth, visits.n))
            .collect()
    }
}

/// Returns the traversal steps of all rays in a node, without its children.
fn own_steps(node: &BvhNode, visits: &Visits) -> u64 {
    if node.is_leaf {
        visits.n * u64::from(node.n_primitives)
    } else {
        visits.n
    }
}
