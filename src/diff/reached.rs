//! `objects.csv`: what any ray meets.

use indexmap::IndexMap;

use super::{Group, Measure, Side, Total, Totals};
use crate::text::Diagnostic;

/// What the rays cost that met something.
type Costs = Vec<(Measure, f64)>;

/// The objects of both tables; none unless both are there.
///
/// # Errors
/// A table that cannot be read.
pub(super) fn groups([a, b]: &[Side; 2]) -> Result<Vec<Group>, Diagnostic> {
    let (Some(a), Some(b)) = (costs(a)?, costs(b)?) else {
        return Ok(Vec::new());
    };
    let sides = [&a, &b];
    let has = |costs: &IndexMap<String, Costs>, measure| {
        let mut all = costs.values().flatten();
        all.any(|(other, _)| *other == measure)
    };
    let is_common = |measure: &Measure| sides.iter().all(|costs| has(costs, *measure));
    let measures: Vec<Measure> = Measure::ALL.into_iter().filter(is_common).collect();
    let group = |name: &String| {
        let total = |&measure: &Measure| Total {
            measure,
            cost: sides.map(|costs| costs.get(name).map_or(0.0, |costs| sum(costs, measure))),
        };
        Group {
            name: name.clone(),
            bounds: None,
            totals: Totals(measures.iter().map(total).collect()),
        }
    };
    let of_b_alone = b.keys().filter(|name| !a.contains_key(*name));
    Ok(a.keys().chain(of_b_alone).map(group).collect())
}

fn sum(costs: &Costs, measure: Measure) -> f64 {
    let of_measure = costs.iter().filter(|(other, _)| *other == measure);
    of_measure.map(|(_, cost)| cost).sum()
}

/// What all rays cost that met an object, by the object's name, those of one
/// name together; `None` without a table.
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
    let columns: Vec<(Measure, usize)> = Measure::ALL
        .into_iter()
        .filter_map(|measure| Some((measure, table.column(measure.array)?)))
        .collect();
    let mut costs: IndexMap<String, Costs> = IndexMap::new();
    for row in &table.rows {
        if kinds.map(|column| row[column].as_str()) == ["object", "hit", "all"] {
            let cost = |&(measure, column): &(Measure, usize)| {
                let cost = row[column].parse().ok()?;
                Some((measure, cost))
            };
            let of_name = costs.entry(row[name].clone()).or_default();
            of_name.extend(columns.iter().filter_map(cost));
        }
    }
    Ok(Some(costs))
}
