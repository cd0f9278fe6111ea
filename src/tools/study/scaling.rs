//! Speedup and efficiency of more threads or ranks.

use serde_json::{Map, Value};

use super::by_round::ByRound;
use super::{Run, StatisticsRow, StudyPlan};

/// The factors that may change together with the number of threads.
const WITH_THREADS: [&str; 3] = ["threads", "ranks", "image_size"];
/// The metric of a run that efficiencies compare.
const THROUGHPUT: &str = "pixels_per_second";

/// A point with its threads of all ranks, and the number of pixels it renders in a second.
struct ScalingPoint<'a> {
    /// The row of its number of threads.
    row: &'a StatisticsRow,
    throughput: ByRound,
}

impl ScalingPoint<'_> {
    fn n_threads(&self) -> f64 {
        self.row.statistics.median
    }

    /// Returns the size of its image if it is a factor.
    fn image_size(&self) -> Option<&Value> {
        self.row.point.get("image_size")
    }

    /// Returns the point's values without those that may change together with the threads.
    fn others(&self) -> Map<String, Value> {
        let mut others = self.row.point.clone();
        others.retain(|name, _| !WITH_THREADS.contains(&name.as_str()));
        others
    }
}

/// Returns rows of `speedup` and `scaling_efficiency` for the points of a study that varies threads
/// or ranks. The baseline is the point with the fewest threads and otherwise the same values: the
/// speedup is the throughput in pixels over the baseline's throughput, and the efficiency the speedup
/// over the ratio of threads. That is strong scaling (t₁ / (n tₙ)). Where each size of the image has
/// only one number of threads, the sizes may differ: weak scaling if the pixels grow with the
/// threads (t₁ / tₙ).
///
/// A speedup is a ratio of two runs of one round; its statistics are those of the ratios of all
/// rounds, so that its interval also holds the noise of the baseline.
pub fn scaling_rows(plan: &StudyPlan, runs: &[Run], rows: &[StatisticsRow]) -> Vec<StatisticsRow> {
    let varies_threads = |row: &&StatisticsRow| {
        let keys = ["threads", "ranks"];
        row.metric == "n_threads" && keys.iter().any(|key| row.point.contains_key(*key))
    };
    let points = rows.iter().filter(varies_threads).map(|row| ScalingPoint {
        row,
        throughput: ByRound::new(plan, runs, &row.point, THROUGHPUT),
    });
    let points: Vec<ScalingPoint> = points.collect();
    let mut found = Vec::new();
    for point in &points {
        let Some(base) = baseline(point, &points) else {
            continue;
        };
        let speedups = point.throughput.over(&base.throughput);
        let threads_ratio = point.n_threads() / base.n_threads();
        let efficiencies: Vec<f64> = speedups.iter().map(|one| one / threads_ratio).collect();
        for (metric, values) in [("speedup", speedups), ("scaling_efficiency", efficiencies)] {
            found.extend(point.row.derive(metric, &values));
        }
    }
    found
}

/// Returns the point that another one is compared to; see [`scaling_rows`].
fn baseline<'a>(
    point: &ScalingPoint,
    points: &'a [ScalingPoint<'a>],
) -> Option<&'a ScalingPoint<'a>> {
    let of_others = points.iter().filter(|one| one.others() == point.others());
    let of_others: Vec<&ScalingPoint> = of_others.collect();
    let is_pair = |a: &ScalingPoint, b: &ScalingPoint| {
        a.image_size() == b.image_size() && a.n_threads() != b.n_threads()
    };
    let is_strong = of_others
        .iter()
        .any(|a| of_others.iter().any(|b| is_pair(a, b)));
    let comparable = of_others
        .into_iter()
        .filter(|one| !is_strong || one.image_size() == point.image_size());
    comparable.min_by(|a, b| a.n_threads().total_cmp(&b.n_threads()))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::study::{RunMetrics, SampleStatistics};
    use scene::yaml;

    /// Rows of `n_threads`, and the runs of two rounds after the warm-up: the machine is slower by a
    /// tenth in the second one.
    fn scaling(points: &[(Value, f64, f64)]) -> Vec<StatisticsRow> {
        let text = "{ title: t, scenes: [a.yaml], vary: { threads: [1] } }";
        let plan: StudyPlan = yaml::from_str(text).unwrap();
        let (mut rows, mut runs) = (Vec::new(), Vec::new());
        for (values, n_threads, pixels_per_second) in points {
            let point = values.as_object().unwrap();
            rows.push(StatisticsRow {
                point: point.clone(),
                metric: "n_threads".to_owned(),
                statistics: SampleStatistics::from_values(&[*n_threads]).unwrap(),
                first_is_slow: false,
                oversubscribed: false,
            });
            runs.extend([(0, 0.1), (1, 1.0), (2, 0.9)].map(|(round, pace)| Run {
                point: point.clone(),
                round,
                metrics: RunMetrics([(THROUGHPUT.to_owned(), pace * pixels_per_second)].into()),
            }));
        }
        scaling_rows(&plan, &runs, &rows)
    }

    /// Returns the smallest and the largest value of a metric of a point.
    fn range(rows: &[StatisticsRow], values: &Value, metric: &str) -> [f64; 2] {
        let of_point = rows
            .iter()
            .filter(|row| Some(&row.point) == values.as_object());
        let mut of_metric = of_point.filter(|row| row.metric == metric);
        let statistics = of_metric.next().unwrap().statistics;
        [statistics.min, statistics.max]
    }

    /// By the wall times of the textbook definitions; the drift of the machine cancels.
    #[test]
    fn strong_and_weak_scaling_are_those_of_the_definitions() {
        // Ranks of two threads: seconds for the same million pixels, and for one million each.
        let strong = [(1.0, 10.0), (2.0, 5.5), (4.0, 4.0)];
        let weak = [(1.0, 10.0), (2.0, 10.4), (4.0, 12.5)];
        let values = |ranks: f64, kind: &str| json!({ "scene": kind, "ranks": ranks });
        let strong_points =
            strong.map(|(ranks, seconds)| (values(ranks, "strong"), 2.0 * ranks, 1e6 / seconds));
        let weak_points = weak
            .map(|(ranks, seconds)| (values(ranks, "weak"), 2.0 * ranks, 1e6 * ranks / seconds));
        let found = scaling(&[strong_points, weak_points].concat());
        let is_near = |values: &Value, metric: &str, expected: f64| {
            let ends = range(&found, values, metric);
            assert!(
                ends.iter().all(|end| (end - expected).abs() < 1e-9),
                "{ends:?}"
            );
        };
        for (ranks, seconds) in strong {
            is_near(&values(ranks, "strong"), "speedup", 10.0 / seconds);
            is_near(
                &values(ranks, "strong"),
                "scaling_efficiency",
                10.0 / (ranks * seconds),
            );
        }
        for (ranks, seconds) in weak {
            is_near(&values(ranks, "weak"), "scaling_efficiency", 10.0 / seconds);
        }
    }

    #[test]
    fn each_size_of_the_image_has_its_baseline() {
        let values =
            |threads: u32, width: u32| json!({ "threads": threads, "image_size": [width, 100] });
        // A large picture has more pixels in a second than a small one.
        let rates = [
            (1, 100, 10.0),
            (2, 100, 18.0),
            (1, 400, 30.0),
            (2, 400, 57.0),
        ];
        let points = rates.map(|(n, width, rate)| (values(n, width), f64::from(n), rate));
        let found = scaling(&points);
        for (threads, width, expected) in
            [(1, 100, 1.0), (2, 100, 1.8), (1, 400, 1.0), (2, 400, 1.9)]
        {
            let ends = range(&found, &values(threads, width), "speedup");
            assert!(
                ends.iter().all(|end| (end - expected).abs() < 1e-9),
                "{ends:?}"
            );
        }
    }

    #[test]
    fn a_study_without_threads_or_ranks_has_no_efficiency() {
        let values = json!({ "scene": "spot", "tile_size": 8 });
        assert!(scaling(&[(values, 2.0, 5.0)]).is_empty());
    }
}
