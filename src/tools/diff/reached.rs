//! The cost of all rays that hit each object, from `objects.csv`.

use indexmap::IndexMap;

use super::{CostGroup, Side, Total, Totals};
use base::text::Diagnostic;
use tracer::cost::Metric;

/// The costs of the rays that hit an object, by metric.
type Costs = Vec<(Metric, f64)>;

/// Returns the objects of both tables; none unless both outputs have a table.
///
/// # Errors
/// If a table cannot be read.
pub(super) fn groups([a, b]: &[Side; 2]) -> Result<Vec<CostGroup>, Diagnostic> {
    let (Some(a), Some(b)) = (costs(a)?, costs(b)?) else {
        return Ok(Vec::new());
    };
    let sides = [&a, &b];
    let has = |costs: &IndexMap<String, Costs>, metric| {
        let mut all = costs.values().flatten();
        all.any(|(other, _)| *other == metric)
    };
    let is_common = |metric: &Metric| sides.iter().all(|costs| has(costs, *metric));
    let metrics: Vec<Metric> = Metric::ALL.into_iter().filter(is_common).collect();
    let group = |name: &String| {
        let total = |&metric: &Metric| Total {
            metric,
            cost: sides.map(|costs| costs.get(name).map_or(0.0, |costs| sum(costs, metric))),
        };
        CostGroup {
            name: name.clone(),
            bounds: None,
            totals: Totals(metrics.iter().map(total).collect()),
        }
    };
    let of_b_alone = b.keys().filter(|name| !a.contains_key(*name));
    Ok(a.keys().chain(of_b_alone).map(group).collect())
}

fn sum(costs: &Costs, metric: Metric) -> f64 {
    let of_metric = costs.iter().filter(|(other, _)| *other == metric);
    of_metric.map(|(_, cost)| cost).sum()
}

/// Reads the costs of all rays that hit each object, by the object's name; objects with the same
/// name may repeat a metric. `None` without a table.
fn costs(side: &Side) -> Result<Option<IndexMap<String, Costs>>, Diagnostic> {
    let Some(table) = side.objects()? else {
        return Ok(None);
    };
    let needed = |name: &str| {
        let missing = || side.no_table(&format!("it has no column `{name}`"));
        table.column(name).ok_or_else(missing)
    };
    let kinds = [needed("kind")?, needed("charge")?, needed("ray_kind")?];
    let name = needed("name")?;
    let columns: Vec<(Metric, usize)> = Metric::ALL
        .into_iter()
        .filter_map(|metric| Some((metric, table.column(metric.name)?)))
        .collect();
    let mut costs: IndexMap<String, Costs> = IndexMap::new();
    for row in &table.rows {
        if kinds.map(|column| row[column].as_str()) == ["object", "hit", "all"] {
            let cost = |&(metric, column): &(Metric, usize)| {
                let cost = row[column].parse().ok()?;
                Some((metric, cost))
            };
            let of_name = costs.entry(row[name].clone()).or_default();
            of_name.extend(columns.iter().filter_map(cost));
        }
    }
    Ok(Some(costs))
}
