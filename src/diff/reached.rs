//! `objects.csv`: what any ray meets.

use std::fs::File;
use std::io;
use std::path::Path;

use super::{Group, Measure, Side, Total, Totals};
use crate::yaml::Diagnostic;

/// The file's name.
const FILE: &str = "objects.csv";

/// The objects of both tables; none unless both are there.
///
/// # Errors
/// A table that cannot be read.
pub(super) fn groups(sides: &[Side; 2]) -> Result<Vec<Group>, Diagnostic> {
    let [a, b] = sides.each_ref().map(|side| side.path_of(FILE));
    let (Some(a), Some(b)) = (rows(&a)?, rows(&b)?) else {
        return Ok(Vec::new());
    };
    let mut names: Vec<&String> = a.iter().map(|row| &row.name).collect();
    for row in &b {
        if !names.contains(&&row.name) {
            names.push(&row.name);
        }
    }
    let group = |name: &String| {
        let cost = |rows: &[Row], measure| {
            let of_name = rows.iter().filter(|row| row.name == *name);
            of_name.filter_map(|row| row.cost(measure)).sum::<f64>()
        };
        let total = |&measure: &Measure| Total {
            measure,
            cost: [cost(&a, measure), cost(&b, measure)],
        };
        let is_common = |measure: &&Measure| {
            let has = |rows: &[Row]| rows.iter().any(|row| row.cost(**measure).is_some());
            has(&a) && has(&b)
        };
        Group {
            name: name.clone(),
            bounds: None,
            totals: Totals(Measure::ALL.iter().filter(is_common).map(total).collect()),
        }
    };
    Ok(names.into_iter().map(group).collect())
}

/// An object and what the rays cost that met it.
struct Row {
    name: String,
    costs: Vec<(Measure, f64)>,
}

impl Row {
    fn cost(&self, measure: Measure) -> Option<f64> {
        let (_, cost) = self.costs.iter().find(|(other, _)| *other == measure)?;
        Some(*cost)
    }
}

/// The objects by all rays that met them; `None` without a table.
fn rows(path: &Path) -> Result<Option<Vec<Row>>, Diagnostic> {
    let fail = |reason: String| {
        let message = format!("cannot read `{}`: {reason}", path.display());
        Diagnostic::new(message).with_help("render again with `--also objects`")
    };
    let file = match File::open(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        file => file.map_err(|error| fail(error.to_string()))?,
    };
    let mut table = csv::Reader::from_reader(file);
    let headers = table
        .headers()
        .map_err(|error| fail(error.to_string()))?
        .clone();
    let column = |name: &str| headers.iter().position(|header| header == name);
    let needed = |name| column(name).ok_or_else(|| fail(format!("it has no column `{name}`")));
    let [kind, charge, ray_kind, name] = ["kind", "charge", "ray_kind", "name"].map(needed);
    let [kind, charge, ray_kind, name] = [kind?, charge?, ray_kind?, name?];
    let costs: Vec<(Measure, usize)> = Measure::ALL
        .into_iter()
        .filter_map(|measure| Some((measure, column(measure.array)?)))
        .collect();
    let mut rows = Vec::new();
    for record in table.records() {
        let record = record.map_err(|error| fail(error.to_string()))?;
        let cell = |column: usize| record.get(column).unwrap_or_default();
        if [kind, charge, ray_kind].map(cell) == ["object", "hit", "all"] {
            let cost =
                |&(measure, column): &(Measure, usize)| Some((measure, cell(column).parse().ok()?));
            rows.push(Row {
                name: cell(name).to_owned(),
                costs: costs.iter().filter_map(cost).collect(),
            });
        }
    }
    Ok(Some(rows))
}
