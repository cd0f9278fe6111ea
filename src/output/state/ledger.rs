//! What `bvh.pvsm` and `surface.pvsm` show.

use crate::config::{BvhLimits, CostMode};
use crate::ledger::{Hierarchy, Visits};
use crate::output::Rendering;
use crate::output::cost_picture::Range;
use crate::scene::Primitive;

use super::between;

/// Of so many leaves one is shown,
const SHOWN_PART: usize = 20;
/// but no fewer and no more than so many: what the eye can tell apart.
const SHOWN: [usize; 2] = [100, 1000];

/// The values of the keys that begin with `bvh.` and `surface.`.
#[derive(Default)]
pub(super) struct LedgerValues {
    bvh: Option<Boxes>,
    surface: Option<Scale>,
}

/// Boxes by their cost, and by what was wasted on them.
struct Boxes {
    /// 1 where leaves alone are shown; else 0.
    is_leaf: f64,
    /// Boxes below are not shown.
    least: [f64; 2],
    scale: Scale,
}

/// The array that tells the cost, and which values the colours span of it and
/// of what was wasted.
struct Scale {
    array: &'static str,
    title: &'static str,
    ranges: [[f64; 2]; 2],
}

impl LedgerValues {
    /// Those of the rendering's ledger, if it has one.
    pub(super) fn of(rendering: &Rendering) -> Self {
        let Some(ledger) = rendering.ledger else {
            return Self::default();
        };
        let (cost, limits) = (rendering.film.cost, rendering.config.output.bvh);
        let primitives = &rendering.scene.primitives;
        let hierarchy = ledger.hierarchy.as_ref();
        Self {
            bvh: hierarchy.map(|hierarchy| boxes(hierarchy, cost, limits)),
            surface: ledger.primitives.as_ref().map(|visits| Scale {
                array: if cost.has_time() { "time_ns" } else { "tests" },
                title: match cost.has_time() {
                    true => "Time per primitive (ns)",
                    false => "Tests per primitive",
                },
                ranges: amounts(shown(primitives, visits), cost).map(|amounts| {
                    let range = Range::of(&amounts);
                    [range.low, range.high]
                }),
            }),
        }
    }

    /// The value of a key.
    pub(super) fn value(&self, key: &str) -> Option<String> {
        let (what, key) = key.split_once('.')?;
        let scale = match what {
            "bvh" => &self.bvh.as_ref()?.scale,
            "surface" => self.surface.as_ref()?,
            _ => return None,
        };
        match key {
            "array" => return Some(scale.array.to_owned()),
            "title" => return Some(scale.title.to_owned()),
            _ => {}
        }
        let number = match (key, &self.bvh) {
            ("is_leaf", Some(boxes)) => boxes.is_leaf,
            ("least", Some(boxes)) => boxes.least[0],
            ("wasted.least", Some(boxes)) => boxes.least[1],
            _ => {
                let (key, [low, high]) = match key.strip_prefix("wasted.") {
                    Some(key) => (key, scale.ranges[1]),
                    None => (key, scale.ranges[0]),
                };
                let at = |f: f64| low * (high / low).powf(f);
                match key.strip_prefix("label(") {
                    Some(fraction) => between(fraction, |f| rounded(at(f)))?,
                    None => between(key.strip_prefix("log(")?, at)?,
                }
            }
        };
        Some(number.to_string())
    }
}

/// To two digits.
fn rounded(number: f64) -> f64 {
    format!("{number:.1e}").parse().unwrap_or(number)
}

/// The visits of the primitives that have a surface to show.
fn shown<'a>(
    primitives: &'a [Primitive],
    visits: &'a [Visits],
) -> impl Iterator<Item = &'a Visits> {
    let all = primitives.iter().zip(visits);
    let shown = all.filter(|(primitive, _)| !primitive.is_unbounded());
    shown.map(|(_, visits)| visits)
}

/// The dearest leaves; the dearest boxes where no leaf is written.
fn boxes(hierarchy: &Hierarchy, cost: CostMode, limits: BvhLimits) -> Boxes {
    let written = || {
        let all = hierarchy.nodes.iter().zip(&hierarchy.visits);
        all.filter(|(node, visits)| node.depth <= limits.max_depth && visits.n >= limits.min_visits)
    };
    let has_leaves = written().any(|(node, _)| node.is_leaf);
    let candidates = written().filter(|(node, _)| node.is_leaf == has_leaves);
    let mut amounts = amounts(candidates.map(|(_, visits)| visits), cost);
    let least = amounts.each_mut().map(|amounts| dearest(amounts));
    Boxes {
        is_leaf: if has_leaves { 1.0 } else { 0.0 },
        least,
        scale: Scale {
            array: if cost.has_time() { "time_ns" } else { "visits" },
            title: match cost.has_time() {
                true => "Time per box (ns)",
                false => "Visits per box",
            },
            ranges: std::array::from_fn(|i| range(&amounts[i], least[i])),
        },
    }
}

/// From the smallest to the largest of the amounts that are shown.
fn range(amounts: &[f32], least: f64) -> [f64; 2] {
    let shown = amounts
        .iter()
        .copied()
        .map(f64::from)
        .filter(|amount| *amount >= least);
    let (low, high) = shown.fold((f64::INFINITY, least), |(low, high), amount| {
        (low.min(amount), high.max(amount))
    });
    let low = low.min(high);
    [low, high.max(1.01 * low)]
}

/// The amount that as many boxes reach as are to be shown; at least 1.
fn dearest(amounts: &mut [f32]) -> f64 {
    let [fewest, most] = SHOWN;
    let n_shown = (amounts.len() / SHOWN_PART).clamp(fewest, most);
    match amounts.len().checked_sub(n_shown) {
        None | Some(0) => 1.0,
        Some(rank) => f64::from(*amounts.select_nth_unstable_by(rank, f32::total_cmp).1).max(1.0),
    }
}

/// What tells the cost of each, and what was wasted on it.
fn amounts<'a>(visits: impl Iterator<Item = &'a Visits>, cost: CostMode) -> [Vec<f32>; 2] {
    let of = |visits: &Visits| match cost.has_time() {
        true => visits.time_ns(),
        false => visits.n as f32,
    };
    visits
        .map(|visits| (of(visits), visits.n_wasted() as f32))
        .unzip::<_, _, Vec<f32>, Vec<f32>>()
        .into()
}
