//! The agreement of two cost maps in different units.

use indexmap::IndexMap;
use serde::Serialize;

use crate::diff::ratio;
use math::statistics::{median, spearman};

/// The agreement of the costs of the pixels in A and B, which may have different units.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CostAgreement {
    /// The sums over all pixels.
    pub totals: [f64; 2],
    /// Spearman's rank correlation; `None` if all pixels of a map have the same cost.
    pub rank_correlation: Option<f64>,
    /// Number of the hottest pixels: 1 %, rounded up.
    pub n_hottest: usize,
    /// The share of the hottest pixels that A and B have in common. Pixels of the same cost at the
    /// limit count in part.
    pub hottest_in_common: f64,
    /// Half of the pixels agree within this factor, with both maps scaled to the same sum;
    /// infinite, null in JSON, if only one map has a cost in half of the pixels.
    pub median_factor: f64,
    /// The objects that the camera sees, the greatest difference first; empty if the output does
    /// not have the array `object`.
    pub objects: Vec<ObjectShare>,
}

/// The shares of the cost of the pixels that show an object.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ObjectShare {
    /// The name of the object.
    pub name: String,
    /// The shares of the totals of A and B, 0 to 1.
    pub shares: [f64; 2],
}

impl ObjectShare {
    /// Returns the change B - A of the share.
    pub(super) fn change(&self) -> f64 {
        self.shares[1] - self.shares[0]
    }
}

impl CostAgreement {
    /// Compares the costs of all pixels, whose totals are not 0. `objects` has the ID of the object
    /// of each pixel, or is empty.
    pub(super) fn measure(
        costs: [&[f64]; 2],
        objects: &[i32],
        name: impl Fn(i32) -> String,
    ) -> Self {
        let [a, b] = costs;
        let n_hottest = a.len().div_ceil(100);
        let weights = costs.map(|costs| weights_of_hottest(costs, n_hottest));
        let pairs = weights[0].iter().zip(&weights[1]);
        let in_common: f64 = pairs.map(|(a, b)| a.min(*b)).sum();
        let mut factors: Vec<f64> = scaled_ratios(costs)
            .map(|ratio| ratio.log2().abs())
            .collect();
        Self {
            totals: costs.map(|costs| costs.iter().sum()),
            rank_correlation: spearman(a, b),
            n_hottest,
            hottest_in_common: in_common / n_hottest as f64,
            median_factor: median(&mut factors).unwrap_or_default().exp2(),
            objects: shares(costs, objects, name),
        }
    }
}

/// Returns the ratio B / A of each pixel, after scaling both maps to the same sum.
pub(super) fn scaled_ratios(costs: [&[f64]; 2]) -> impl Iterator<Item = f64> {
    let totals = costs.map(|costs| costs.iter().sum::<f64>());
    let pairs = costs[0].iter().zip(costs[1]);
    pairs.map(move |(a, b)| ratio([a / totals[0], b / totals[1]]))
}

/// Returns 1 for each of the `n` pixels of the greatest cost, and 0 for the others; pixels of the
/// same cost at the limit share what is left.
fn weights_of_hottest(costs: &[f64], n: usize) -> Vec<f64> {
    let mut sorted = costs.to_vec();
    let (above, limit, _) = sorted.select_nth_unstable_by(n - 1, |a, b| b.total_cmp(a));
    let limit = *limit;
    let n_above = above.iter().filter(|&&cost| cost > limit).count();
    let n_tied = costs.iter().filter(|&&cost| cost == limit).count();
    let of_tied = (n - n_above) as f64 / n_tied as f64;
    let weight = |&cost: &f64| match cost {
        _ if cost > limit => 1.0,
        _ if cost == limit => of_tied,
        _ => 0.0,
    };
    costs.iter().map(weight).collect()
}

/// Returns the shares of the objects; objects with the same name are one.
fn shares(costs: [&[f64]; 2], objects: &[i32], name: impl Fn(i32) -> String) -> Vec<ObjectShare> {
    let mut by_id: IndexMap<i32, [f64; 2]> = IndexMap::new();
    for (pixel, id) in objects.iter().enumerate() {
        let sums = by_id.entry(*id).or_default();
        add(sums, costs.map(|costs| costs[pixel]));
    }
    let mut by_name: IndexMap<String, [f64; 2]> = IndexMap::new();
    for (id, sums) in by_id {
        add(by_name.entry(name(id)).or_default(), sums);
    }
    let totals = costs.map(|costs| costs.iter().sum::<f64>());
    let object = |(name, [a, b]): (String, [f64; 2])| ObjectShare {
        name,
        shares: [a / totals[0], b / totals[1]],
    };
    let mut found: Vec<ObjectShare> = by_name.into_iter().map(object).collect();
    found.sort_by(|x, y| y.change().abs().total_cmp(&x.change().abs()));
    found
}

fn add(sums: &mut [f64; 2], [a, b]: [f64; 2]) {
    sums[0] += a;
    sums[1] += b;
}
