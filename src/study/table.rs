//! Results as a table: a row for each point and each number.

use std::io::{self, Write};

use indexmap::IndexMap;
use serde::Serialize;
use serde_json::{Map, Value};

use super::{Plan, Results, Run};
use crate::statistics::SampleStatistics;
use crate::text::text_cell;

/// One number of one point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The point's values by factor.
    pub point: Map<String, Value>,
    /// What was measured, with its unit at the end.
    pub metric: String,
    /// Over the runs that count.
    #[serde(flatten)]
    pub statistics: SampleStatistics,
    /// Whether the first run of all, warm-up left out, is an outlier above.
    pub first_is_slow: bool,
    /// Whether the point's runs had more threads than there are processors:
    /// threads took turns.
    pub oversubscribed: bool,
}

/// The rows of all points of the plan that have been measured, in its order, on
/// a machine with so many processors, if that is known.
pub fn rows(plan: &Plan, results: &Results, n_processors: Option<u64>) -> Vec<Row> {
    let rows_of = |values: Map<String, Value>| {
        let counts = |run: &&Run| run.round >= plan.warm_up && run.point == values;
        let mut columns: IndexMap<&str, Vec<f64>> = IndexMap::new();
        for run in results.runs.iter().filter(counts) {
            for (name, value) in &run.metrics.0 {
                columns.entry(name).or_default().push(*value);
            }
        }
        let n_threads = columns.get("n_threads").and_then(|threads| threads.first());
        let oversubscribed = n_threads
            .zip(n_processors)
            .is_some_and(|(threads, processors)| *threads > processors as f64);
        let row = |(metric, measured): (&str, Vec<f64>)| {
            let statistics = SampleStatistics::of(&measured)?;
            let first = measured[0];
            Some(Row {
                point: values.clone(),
                metric: metric.to_owned(),
                statistics,
                first_is_slow: statistics.is_outlier(first) && first > statistics.median,
                oversubscribed,
            })
        };
        columns.into_iter().filter_map(row).collect::<Vec<_>>()
    };
    let points = plan.points().into_iter();
    points.flat_map(|point| rows_of(point.values)).collect()
}

/// Writes the rows as CSV, a column for each factor.
///
/// # Errors
/// If `out` cannot be written to.
pub fn write_csv(rows: &[Row], out: &mut impl Write) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    if let Some(row) = rows.first() {
        let factors = row.point.keys().map(String::as_str);
        table.write_record(factors.chain(columns(row).map(|(name, _)| name)))?;
    }
    for row in rows {
        let factors = row.point.values().map(text);
        table.write_record(factors.chain(columns(row).map(|(_, value)| value)))?;
    }
    table.flush()
}

/// What a row has besides its factors, by name.
fn columns(row: &Row) -> [(&'static str, String); 13] {
    let of = &row.statistics;
    [
        ("metric", row.metric.clone()),
        ("n", of.n.to_string()),
        ("mean", of.mean.to_string()),
        ("standard_deviation", of.standard_deviation.to_string()),
        ("min", of.min.to_string()),
        ("max", of.max.to_string()),
        ("median", of.median.to_string()),
        ("mad", of.mad.to_string()),
        ("low_95", of.low_95.to_string()),
        ("high_95", of.high_95.to_string()),
        ("n_outliers", of.n_outliers.to_string()),
        ("first_is_slow", row.first_is_slow.to_string()),
        ("oversubscribed", row.oversubscribed.to_string()),
    ]
}

fn text(value: &Value) -> String {
    match value {
        Value::String(text) => text_cell(text).into_owned(),
        other => other.to_string(),
    }
}
