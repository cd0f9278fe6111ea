//! The values of `bvh.pvsm` and `surface.pvsm`.

use std::iter::zip;

use serde::{Deserialize, Serialize};

use crate::paraview::{Axis, ColorScale, StateValue};
use crate::writers::RenderingView;
use render::attribution::{Hierarchy, Visits};
use scene::config::{BvhLimits, CostMode};
use tracer::accel::BvhNode;
use tracer::cost::Metric;

/// Maximum number of boxes shown; a larger hierarchy is shown at a higher level.
const MAX_BOXES: usize = 3000;
/// Maximum number of boxes drawn as wireframes.
const MAX_FRAMES: usize = 200;
/// Maximum number of primitives drawn with their edges.
const MAX_EDGES: usize = 100;

/// The values of the keys that begin with `bvh.` and `surface.`.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct AttributionValues {
    bvh: Option<Boxes>,
    surface: Option<Primitives>,
}

/// The cost of the primitives.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Primitives {
    has_edges: bool,
    cost: Axis,
    wasted: Axis,
}

/// The boxes shown, and their cost.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Boxes {
    level: Level,
    n: usize,
    cost: Axis,
    wasted: Axis,
}

/// The level of the hierarchy that is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Level {
    Leaves,
    Depth(u32),
}

impl AttributionValues {
    /// Returns the values of the rendering's cost attribution, if it has one.
    pub(super) fn new(rendering: &RenderingView) -> Self {
        let Some(attribution) = rendering.attribution else {
            return Self::default();
        };
        let (cost, limits) = (rendering.film.cost, rendering.config.output.bvh);
        let hierarchy = attribution.hierarchy.as_ref();
        let visits = attribution.primitives.as_ref();
        Self {
            bvh: hierarchy.map(|hierarchy| Boxes::new(hierarchy, cost, limits)),
            surface: visits.map(|visits| {
                let all = zip(&rendering.scene.primitives, visits);
                let shown = all.filter(|(primitive, _)| !primitive.is_unbounded());
                Primitives::new(&shown.map(|(_, visits)| *visits).collect::<Vec<_>>(), cost)
            }),
        }
    }

    /// Returns the values of both renderings.
    pub(super) fn spanning(&self, other: &Self) -> Self {
        let boxes = self.bvh.as_ref().zip(other.bvh.as_ref());
        let surfaces = self.surface.as_ref().zip(other.surface.as_ref());
        Self {
            bvh: boxes.map(|(a, b)| a.spanning(b)),
            surface: surfaces.map(|(a, b)| a.spanning(b)),
        }
    }

    /// Returns the value of a key.
    pub(super) fn value(&self, key: &str) -> Option<StateValue> {
        let (what, key) = key.split_once('.')?;
        match what {
            "bvh" => self.bvh.as_ref()?.value(key),
            "surface" => self.surface.as_ref()?.value(key),
            _ => None,
        }
    }
}

impl Primitives {
    fn new(visits: &[Visits], cost: CostMode) -> Self {
        Self {
            has_edges: visits.len() <= MAX_EDGES,
            cost: cost_axis(visits, cost, "primitive", "tests"),
            wasted: wasted_axis(visits, "Tests that met nothing", "wasted_tests"),
        }
    }

    fn spanning(&self, other: &Self) -> Self {
        Self {
            has_edges: self.has_edges && other.has_edges,
            cost: self.cost.spanning(&other.cost),
            wasted: self.wasted.spanning(&other.wasted),
        }
    }

    fn value(&self, key: &str) -> Option<StateValue> {
        match (key, key.strip_prefix("wasted.")) {
            ("representation", _) if self.has_edges => Some("Surface With Edges".into()),
            ("representation", _) => Some("Surface".into()),
            (_, Some(key)) => self.wasted.value(key),
            _ => self.cost.value(key),
        }
    }
}

impl Boxes {
    fn new(hierarchy: &Hierarchy, cost: CostMode, limits: BvhLimits) -> Self {
        let written = hierarchy.within(limits);
        let level = Level::new(written.iter().map(|(node, ..)| *node));
        let shown = || written.iter().filter(|(node, ..)| level.has(node));
        let visits: Vec<Visits> = shown().map(|(_, visits, _)| **visits).collect();
        let below = shown().map(|(_, visits, cost)| (f64::from(*cost), visits.n));
        let title = "Visits and tests per ray";
        Self {
            level,
            n: visits.len(),
            cost: match level {
                Level::Leaves => cost_axis(&visits, cost, "leaf", "visits"),
                Level::Depth(_) => {
                    Axis::new("measured_cost", title, ColorScale::Logarithmic, most(below))
                }
            },
            wasted: wasted_axis(&visits, "Visits that met nothing", "wasted_visits"),
        }
    }

    /// Takes the boxes of the first at its level; captions count its boxes.
    fn spanning(&self, other: &Self) -> Self {
        Self {
            level: self.level,
            n: self.n,
            cost: self.cost.spanning(&other.cost),
            wasted: self.wasted.spanning(&other.wasted),
        }
    }

    fn value(&self, key: &str) -> Option<StateValue> {
        let is_framed = self.n <= MAX_FRAMES;
        let text = match key {
            "representation" if is_framed => "Wireframe".to_owned(),
            "representation" => "Surface With Edges".to_owned(),
            "line_width" => if self.n <= 40 { "3" } else { "1.5" }.to_owned(),
            "level.array" => self.level.array().to_owned(),
            "level" => self.level.number().to_string(),
            "caption" => self.level.caption(self.n),
            _ => {
                return match key.strip_prefix("wasted.") {
                    Some(key) => self.wasted.value(key),
                    None => self.cost.value(key),
                };
            }
        };
        Some(text.into())
    }
}

impl Level {
    /// Chooses the leaves or, if they are too many, the deepest level with only levels of at most
    /// [`MAX_BOXES`] boxes above it: past a crowded level, few boxes mean only that few branches
    /// are as deep.
    fn new<'n>(written: impl Iterator<Item = &'n BvhNode>) -> Self {
        let (mut n_leaves, mut n_at) = (0, Vec::new());
        for node in written {
            n_leaves += usize::from(node.is_leaf);
            let depth = node.depth as usize;
            n_at.resize(n_at.len().max(depth + 1), 0_usize);
            n_at[depth] += 1;
        }
        if (1..=MAX_BOXES).contains(&n_leaves) {
            return Self::Leaves;
        }
        let is_seen = |n: &&usize| (1..=MAX_BOXES).contains(*n);
        let n_levels = n_at.iter().take_while(is_seen).count();
        Self::Depth(n_levels.saturating_sub(1) as u32)
    }

    fn has(self, node: &BvhNode) -> bool {
        match self {
            Self::Leaves => node.is_leaf,
            Self::Depth(depth) => node.depth == depth,
        }
    }

    /// Returns the array that selects the boxes: its value is [`number`](Self::number).
    fn array(self) -> &'static str {
        match self {
            Self::Leaves => "is_leaf",
            Self::Depth(_) => "depth",
        }
    }

    fn number(self) -> u32 {
        match self {
            Self::Leaves => 1,
            Self::Depth(depth) => depth,
        }
    }

    fn caption(self, n: usize) -> String {
        use base::numbers::count;
        match self {
            Self::Leaves if n == 1 => "The only leaf of the hierarchy".to_owned(),
            Self::Leaves => format!("{} leaves of the hierarchy", count(n as u64)),
            Self::Depth(0) => "The hierarchy's root".to_owned(),
            Self::Depth(depth) => {
                let n = count(n as u64);
                format!("{n} boxes at depth {depth}")
            }
        }
    }
}

/// Returns the axis of the time of each node or primitive, or of the number of visits.
fn cost_axis(visits: &[Visits], cost: CostMode, thing: &str, count: &str) -> Axis {
    if let Some(metric) = Metric::measured_by(cost) {
        let times = visits.iter().map(|of| (f64::from(of.time_ns()), of.n_hits));
        return Axis::new(
            metric.name,
            &format!("Time per {thing}"),
            ColorScale::Logarithmic,
            most(times),
        )
        .in_time_unit();
    }
    let counts = visits.iter().map(|of| (of.n as f64, of.n_hits));
    let mut name = format!("{count} per {thing}");
    name[..1].make_ascii_uppercase();
    Axis::new(count, &name, ColorScale::Logarithmic, most(counts))
}

fn wasted_axis(visits: &[Visits], name: &str, array: &str) -> Axis {
    let wasted = visits.iter().map(|of| (of.n_wasted() as f64, of.n));
    Axis::new(array, name, ColorScale::Logarithmic, most(wasted))
}

/// Returns the weighted 1 % and 99 % quantiles of the positive values. Hidden parts of
/// the scene have small weights, so that visible parts determine the colors.
fn most(weighted: impl Iterator<Item = (f64, u64)>) -> [f64; 2] {
    let mut values: Vec<(f64, u64)> = weighted.filter(|(value, _)| *value > 0.0).collect();
    values.sort_unstable_by(|(a, _), (b, _)| a.total_cmp(b));
    if values.iter().all(|(_, weight)| *weight == 0) {
        values.iter_mut().for_each(|(_, weight)| *weight = 1);
    }
    let total = values.iter().map(|(_, weight)| *weight as f64).sum::<f64>();
    let quantile = |part: f64| {
        let mut before = 0.0;
        let is_reached = |(_, weight): &&(f64, u64)| {
            before += *weight as f64;
            before >= part * total
        };
        values
            .iter()
            .find(is_reached)
            .map_or(1.0, |(value, _)| *value)
    };
    let [low, high] = [0.01, 0.99].map(quantile);
    // A smaller range would exaggerate differences.
    if high >= 1.5 * low {
        [low, high]
    } else {
        let middle = (low * high).sqrt();
        [middle / 1.5, middle * 1.5]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(depth: u32) -> BvhNode {
        BvhNode {
            id: 0,
            parent: None,
            bounds: world::geometry::Aabb::EMPTY,
            depth,
            is_leaf: false,
            n_primitives: 1,
            sah_cost: 1.0,
            epo: None,
            mesh: None,
        }
    }

    #[test]
    fn few_deep_branches_do_not_stand_for_the_hierarchy() {
        let level = |n_at: &[usize]| {
            let at = |(depth, n): (usize, &usize)| vec![node(depth as u32); *n];
            let nodes: Vec<BvhNode> = n_at.iter().enumerate().flat_map(at).collect();
            let is_leaf = |node: BvhNode| BvhNode {
                is_leaf: true,
                ..node
            };
            let leaves = vec![is_leaf(node(9)); MAX_BOXES + 1];
            Level::new(nodes.iter().chain(&leaves))
        };
        assert_eq!(level(&[1, 8, 64, 512, 4000, 9000, 14]), Level::Depth(3));
        assert_eq!(level(&[MAX_BOXES + 1]), Level::Depth(0));
    }

    #[test]
    fn what_weighs_little_has_no_part_in_the_range() {
        let seen = (100..200).map(|value| (f64::from(value), 1000));
        let hidden = (1..100).map(|value| (f64::from(value), 1));
        assert_eq!(most(seen.chain(hidden)), [100.0, 198.0]);
        assert_eq!(most([(0.0, 5)].into_iter()), [1.0 / 1.5, 1.5]);
        let equal = most([(9.0, 0), (9.0, 0)].into_iter());
        assert!(equal[0] < 9.0 && equal[1] > 9.0);
    }
}
