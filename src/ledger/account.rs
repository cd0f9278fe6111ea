//! What is written down of each thing.

use crate::accel::BvhNode;
use crate::cost::RayKind;

/// The work of some rays.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Work {
    /// How many rays.
    pub rays: u64,
    /// BVH nodes that they entered.
    pub node_visits: u64,
    /// Their tests of primitives.
    pub primitive_tests: u64,
    /// Their thread time in picoseconds, whole ones so that the order of a sum
    /// changes nothing; 0 where no time was measured.
    pub time_ps: u64,
}

impl Work {
    /// That of both.
    pub fn with(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            node_visits: self.node_visits + other.node_visits,
            primitive_tests: self.primitive_tests + other.primitive_tests,
            time_ps: self.time_ps + other.time_ps,
        }
    }
}

/// To which thing a ray is charged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Charge {
    /// To what the camera ray met that it goes back to: what is seen pays for
    /// its light and its mirror images.
    Primary,
    /// To what the ray itself met; a shadow ray's is what is in its way.
    Hit,
}

impl Charge {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Primary, Self::Hit];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Hit => "hit",
        }
    }
}

/// What is charged to an object or to a material, or to nothing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Account {
    /// By [`Charge`], then by [`RayKind`].
    pub(super) work: [[Work; 4]; 2],
}

impl Account {
    /// The work of its rays of one kind.
    pub fn of_kind(&self, charge: Charge, kind: RayKind) -> Work {
        self.work[charge as usize][kind as usize]
    }

    /// The work of all of its rays.
    pub fn all(&self, charge: Charge) -> Work {
        let kinds = self.work[charge as usize];
        kinds.into_iter().fold(Work::default(), Work::with)
    }

    /// That of both.
    pub fn with(self, other: Self) -> Self {
        let both =
            |charge: usize, kind: usize| self.work[charge][kind].with(other.work[charge][kind]);
        Self {
            work: std::array::from_fn(|charge| std::array::from_fn(|kind| both(charge, kind))),
        }
    }

    /// Camera rays that see it. Over the samples of a pixel it is how many
    /// pixels it fills.
    pub fn n_samples(&self) -> u64 {
        self.of_kind(Charge::Hit, RayKind::Camera).rays
    }
}

/// How often rays came to a thing, and what for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Visits {
    /// How often: visits of a node, tests of a primitive.
    pub n: u64,
    /// How many of them led on: to a child of a node, or to a hit that was the
    /// nearest so far.
    pub n_hits: u64,
    /// Thread time in picoseconds; 0 where none was measured.
    pub time_ps: u64,
}

impl Visits {
    /// Those that were for nothing.
    pub fn n_wasted(&self) -> u64 {
        self.n - self.n_hits
    }

    /// The time in nanoseconds.
    pub fn time_ns(&self) -> f32 {
        (self.time_ps as f64 / 1e3) as f32
    }
}

/// The hierarchy and how often rays came to each part of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Hierarchy {
    /// Nodes and leaves, each before those below it.
    pub nodes: Vec<BvhNode>,
    /// Of each of them. A ray that visits a leaf is tested against all of the
    /// leaf's primitives; the time of a leaf is that of its tests, and the time
    /// of a node is that of the node alone.
    pub visits: Vec<Visits>,
}

impl Hierarchy {
    /// What a ray that came to the root spent in each node and below it, in
    /// primitive tests on the scale of [`BvhNode::sah_cost`], which foretells it:
    /// one for each node visited and each primitive tested there, over the
    /// visits of the root. 0 where no ray came.
    pub fn costs(&self) -> Vec<f32> {
        let mut steps: Vec<u64> = self.nodes.iter().zip(&self.visits).map(own_steps).collect();
        // Those below a node come after it.
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
}

/// The steps of all rays in a node alone.
fn own_steps((node, visits): (&BvhNode, &Visits)) -> u64 {
    if node.is_leaf {
        visits.n * u64::from(node.n_primitives)
    } else {
        visits.n
    }
}
