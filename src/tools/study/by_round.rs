//! Values of a metric by round, and their ratios.

use serde_json::{Map, Value};

use super::{Run, StudyPlan};

/// The values of a metric at a point with their rounds, warm-up left out.
pub(super) struct ByRound(Vec<(u32, f64)>);

impl ByRound {
    /// Collects the values greater than 0 of the `metric` at a point.
    pub(super) fn new(
        plan: &StudyPlan,
        runs: &[Run],
        point: &Map<String, Value>,
        metric: &str,
    ) -> Self {
        let of_point = runs
            .iter()
            .filter(|run| run.round >= plan.warm_up && run.point == *point);
        let value = of_point.filter_map(|run| Some((run.round, *run.metrics.0.get(metric)?)));
        Self(value.filter(|(_, value)| *value > 0.0).collect())
    }

    /// Returns true without a value.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the ratio of these values to others for each round that both have. The runs of a round
    /// follow each other closely, so that a slow drift of the machine cancels.
    pub(super) fn over(&self, others: &Self) -> Vec<f64> {
        let ratio = |&(round, value): &(u32, f64)| {
            let (_, other) = others.0.iter().find(|(known, _)| *known == round)?;
            Some(value / other)
        };
        self.0.iter().filter_map(ratio).collect()
    }
}
