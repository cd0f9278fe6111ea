//! The cost of all rays that hit each object, from `objects.csv`.

use indexmap::IndexMap;

use super::{CostGroup, Side, Total, Totals};
use base::text::Diagnostic;
use tracer::cost::Metric;

/// The costs of the rays that hit each object, by the object's name.
struct HitCosts {
    metrics: Vec<Metric>,
    /// The sums of each metric; objects with the same name are one.
    of_names: IndexMap<String, Vec<f64>>,
}

impl HitCosts {
    fn cost(&self, name: &str, metric: Metric) -> f64 {
        let index = self.metrics.iter().position(|other| *other == metric);
        let sums = self.of_names.get(name);
        index.zip(sums).map_or(0.0, |(index, sums)| sums[index])
    }
}

/// Returns the objects of both tables; none unless both outputs have a table.
///
/// # Errors
/// If a table cannot be read.
pub(super) fn groups([a, b]: &[Side; 2]) -> Result<Vec<CostGroup>, Diagnostic> {
    let (Some(a), Some(b)) = (costs(a)?, costs(b)?) else {
        return Ok(Vec::new());
    };
    let metrics: Vec<Metric> = a
        .metrics
        .iter()
        .copied()
        .filter(|metric| b.metrics.contains(metric))
        .collect();
    let group = |name: &String| {
        let total = |&metric: &Metric| Total {
            metric,
            cost: [&a, &b].map(|costs| costs.cost(name, metric)),
        };
        CostGroup {
            name: name.clone(),
            bounds: None,
            totals: Totals(metrics.iter().map(total).collect()),
        }
    };
    let of_b_alone = b
        .of_names
        .keys()
        .filter(|name| !a.of_names.contains_key(*name));
    Ok(a.of_names.keys().chain(of_b_alone).map(group).collect())
}

/// Reads the costs of all rays that hit each object. `None` without a table.
fn costs(side: &Side) -> Result<Option<HitCosts>, Diagnostic> {
    let Some(table) = side.objects()? else {
        return Ok(None);
    };
    let needed = |name: &str| {
        let missing = || side.no_table(&format!("it has no column `{name}`"));
        table.column(name).ok_or_else(missing)
    };
    let kinds = [needed("kind")?, needed("charge")?, needed("ray_kind")?];
    let name = needed("name")?;
    let (metrics, columns): (Vec<Metric>, Vec<usize>) = Metric::ALL
        .into_iter()
        .filter_map(|metric| Some((metric, table.column(metric.name)?)))
        .unzip();
    let mut of_names: IndexMap<String, Vec<f64>> = IndexMap::new();
    table.read_rows(|row| {
        if kinds.map(|column| row[column]) == ["object", "hit", "all"] {
            let sums = of_names.entry(row[name].to_owned());
            let sums = sums.or_insert_with(|| vec![0.0; columns.len()]);
            for (sum, &column) in sums.iter_mut().zip(&columns) {
                *sum += row[column].parse().unwrap_or(0.0);
            }
        }
    })?;
    Ok(Some(HitCosts { metrics, of_names }))
}
