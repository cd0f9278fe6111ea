//! Statistics of a study as a table: one row per point and metric.

use std::io::{self, Write};

use indexmap::IndexMap;
use serde::Serialize;
use serde_json::{Map, Value};

use super::median_interval::MedianInterval;
use super::sample::SampleStatistics;
use super::{Run, StudyPlan};
use host::text::text_cell;

/// The statistics of one metric at one point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StatisticsRow {
    /// The point's values, by factor name.
    pub point: Map<String, Value>,
    /// The metric's name, which ends with its unit.
    pub metric: String,
    /// The statistics over the runs after the warm-up.
    #[serde(flatten)]
    pub statistics: SampleStatistics,
    /// True if the first run after the warm-up is an outlier above the median.
    pub first_is_slow: bool,
    /// True if the runs had more threads than there are processors, so that threads shared
    /// processors.
    pub oversubscribed: bool,
}

impl StatisticsRow {
    /// Returns the row of another metric at this point, computed from several runs; `None` without
    /// values.
    pub(super) fn derive(&self, metric: &str, values: &[f64]) -> Option<Self> {
        Some(Self {
            point: self.point.clone(),
            metric: metric.to_owned(),
            statistics: SampleStatistics::from_values(values)?,
            first_is_slow: false,
            oversubscribed: self.oversubscribed,
        })
    }
}

/// Returns the rows of all measured points in the plan's order, on a machine with `n_processors`
/// (`None` if unknown, then no point counts as oversubscribed).
pub fn statistics_rows(
    plan: &StudyPlan,
    runs: &[Run],
    n_processors: Option<u64>,
) -> Vec<StatisticsRow> {
    let rows_of = |values: Map<String, Value>| {
        let counts = |run: &&Run| run.round >= plan.warm_up && run.point == values;
        let mut columns: IndexMap<&str, Vec<f64>> = IndexMap::new();
        for run in runs.iter().filter(counts) {
            for (name, value) in &run.metrics.0 {
                columns.entry(name).or_default().push(*value);
            }
        }
        let n_threads = columns.get("n_threads").and_then(|threads| threads.first());
        let oversubscribed = n_threads
            .zip(n_processors)
            .is_some_and(|(threads, processors)| *threads > processors as f64);
        let row = |(metric, measured): (&str, Vec<f64>)| {
            let statistics = SampleStatistics::from_values(&measured)?;
            let first = measured[0];
            Some(StatisticsRow {
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

/// Writes the rows as CSV with one column per factor.
///
/// # Errors
/// If `out` cannot be written to.
pub fn write_csv(rows: &[StatisticsRow], out: &mut impl Write) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    if let Some(row) = rows.first() {
        let factors = row.point.keys().map(|name| text_cell(name));
        let columns = statistics_columns(row).map(|(name, _)| name.into());
        table.write_record(factors.chain(columns).map(|name| name.into_owned()))?;
    }
    for row in rows {
        let factors = row.point.values().map(text);
        table.write_record(factors.chain(statistics_columns(row).map(|(_, value)| value)))?;
    }
    table.flush()
}

/// Returns the columns of a row after its factors: name and value.
fn statistics_columns(row: &StatisticsRow) -> [(&'static str, String); 14] {
    let of = &row.statistics;
    let of_interval = |part: fn(&MedianInterval) -> f64| {
        let interval = of.interval.as_ref();
        interval.map_or(String::new(), |interval| part(interval).to_string())
    };
    [
        ("metric", row.metric.clone()),
        ("n", of.n.to_string()),
        ("mean", of.mean.to_string()),
        ("standard_deviation", of.standard_deviation.to_string()),
        ("min", of.min.to_string()),
        ("max", of.max.to_string()),
        ("median", of.median.to_string()),
        ("mad", of.mad.to_string()),
        ("low_95", of_interval(|interval| interval.low_95)),
        ("high_95", of_interval(|interval| interval.high_95)),
        ("coverage", of_interval(|interval| interval.coverage)),
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
