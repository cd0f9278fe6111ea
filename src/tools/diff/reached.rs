//! The cost of all rays that hit each object, from `objects.csv`.

use indexmap::IndexMap;

use super::{CostGroup, Side, Total, Totals};
use host::text::Diagnostic;
use tracer::cost::Metric;

/// The costs of the rays that hit each object, by the object's name.
struct HitCosts {
    metrics: Vec<Metric>,
    /// True for each metric that has a number in some row: times that were not measured have none.
    is_measured: Vec<bool>,
    /// The sums of each metric; objects with the same name are one.
    of_names: IndexMap<String, Vec<f64>>,
}

impl HitCosts {
    fn cost(&self, name: &str, metric: Metric) -> f64 {
        let sums = self.of_names.get(name);
        let index = self.index(metric);
        index.zip(sums).map_or(0.0, |(index, sums)| sums[index])
    }

    fn has(&self, metric: Metric) -> bool {
        self.index(metric)
            .is_some_and(|index| self.is_measured[index])
    }

    fn index(&self, metric: Metric) -> Option<usize> {
        self.metrics.iter().position(|other| *other == metric)
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
    let is_common = |metric: &Metric| a.has(*metric) && b.has(*metric);
    let metrics: Vec<Metric> = Metric::ALL.into_iter().filter(is_common).collect();
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
    let mut is_measured = vec![false; metrics.len()];
    let mut of_names: IndexMap<String, Vec<f64>> = IndexMap::new();
    table.read_rows(|row| {
        if kinds.map(|column| row[column]) == ["object", "hit", "all"] {
            let sums = of_names.entry(row[name].to_owned());
            let sums = sums.or_insert_with(|| vec![0.0; columns.len()]);
            for (index, &column) in columns.iter().enumerate() {
                if let Ok(cost) = row[column].parse::<f64>() {
                    sums[index] += cost;
                    is_measured[index] = true;
                }
            }
        }
    })?;
    Ok(Some(HitCosts {
        metrics,
        is_measured,
        of_names,
    }))
}
