//! The CPU time that measuring adds to rendering.

use serde_json::{Map, Value};

use super::by_round::ByRound;
use super::metric_list::OVERHEAD;
use super::{Run, StatisticsRow, StudyPlan};

/// The factor of the cost modes, and its level without measurement.
pub(super) const COST: &str = "cost";
const UNMEASURED: &str = "none";
/// The metric of a run that overheads compare.
const CPU_TIME: &str = "render_cpu_ms";

/// Returns rows of `measuring_overhead` for the points of a study that varies `cost`: the CPU time
/// of the stage `render` over the CPU time of the point with `cost: none` and otherwise the same
/// values, minus 1. Programs beside it change the CPU time less than the wall time.
///
/// An overhead compares two runs of one round; its statistics are over all rounds.
pub fn overhead_rows(plan: &StudyPlan, runs: &[Run], rows: &[StatisticsRow]) -> Vec<StatisticsRow> {
    let overhead = |row: &StatisticsRow| {
        let unmeasured = unmeasured(&row.point)?;
        let [times, base] =
            [&row.point, &unmeasured].map(|point| ByRound::new(plan, runs, point, CPU_TIME));
        let overheads: Vec<f64> = times.over(&base).iter().map(|ratio| ratio - 1.0).collect();
        row.derive(OVERHEAD, &overheads)
    };
    let times = rows.iter().filter(|row| row.metric == CPU_TIME);
    times.filter_map(overhead).collect()
}

/// Returns true if a study has a point with an overhead.
pub(super) fn has_overheads(plan: &StudyPlan) -> bool {
    let points = plan.points();
    let mut bases = points.iter().filter_map(|point| unmeasured(&point.values));
    bases.any(|base| points.iter().any(|point| point.values == base))
}

/// Returns the values of a point with `cost: none`; `None` if it has no other `cost`.
fn unmeasured(point: &Map<String, Value>) -> Option<Map<String, Value>> {
    let mut unmeasured = point.clone();
    let mode = unmeasured.insert(COST.to_owned(), UNMEASURED.into())?;
    (mode != UNMEASURED).then_some(unmeasured)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::study::{RunMetrics, statistics_rows};
    use scene::yaml;

    /// The machine is slower by a tenth in the second round after the warm-up.
    #[test]
    fn an_overhead_compares_the_runs_of_a_round() {
        let text = "{ title: t, scenes: [a.yaml], vary: { cost: [none, counters, time] } }";
        let plan: StudyPlan = yaml::from_str(text).unwrap();
        let times = [("none", 100.0), ("counters", 110.0), ("time", 150.0)];
        let runs: Vec<Run> = (times.into_iter())
            .flat_map(|(mode, ms)| {
                let Value::Object(point) = json!({ "scene": "a", "cost": mode }) else {
                    unreachable!()
                };
                [(0, 7.0), (1, 1.0), (2, 1.1)].map(|(round, pace)| Run {
                    point: point.clone(),
                    round,
                    metrics: RunMetrics([(CPU_TIME.to_owned(), pace * ms)].into()),
                })
            })
            .collect();
        let rows = statistics_rows(&plan, &runs, None);
        let found = overhead_rows(&plan, &runs, &rows);
        let found: Vec<_> = (found.iter())
            .map(|row| {
                let [min, max] = [row.statistics.min, row.statistics.max];
                assert!(max - min < 1e-9 && row.statistics.n == 2);
                (row.point["cost"].as_str().unwrap(), (100.0 * min).round())
            })
            .collect();
        assert_eq!(found, [("counters", 10.0), ("time", 50.0)]);
    }
}
