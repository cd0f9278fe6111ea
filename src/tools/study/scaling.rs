//! Speedup and efficiency of more threads or ranks.

use serde_json::{Map, Value};

use super::StatisticsRow;
use math::statistics::SampleStatistics;

/// The factors that may change together with the number of threads.
const WITH_THREADS: [&str; 3] = ["threads", "ranks", "image_size"];
/// The metric of a run that efficiencies compare.
const THROUGHPUT: &str = "pixels_per_second";

/// A point with its threads of all ranks, and the number of pixels it renders in a second.
struct ScalingPoint<'a> {
    row: &'a StatisticsRow,
    n_threads: f64,
}

/// Returns rows of `speedup` and `scaling_efficiency` for the points of a study that varies threads
/// or ranks. The baseline is the point with the fewest threads among the points that differ only in
/// the size of the image: the speedup is the throughput in pixels over the baseline's throughput,
/// and the efficiency the speedup over the ratio of threads. That is strong scaling where all
/// images are equal (t₁ / (n tₙ)), and weak scaling where their pixels grow with the threads (t₁ /
/// tₙ).
pub fn scaling_rows(rows: &[StatisticsRow]) -> Vec<StatisticsRow> {
    let of_metric = |name: &'static str| rows.iter().filter(move |row| row.metric == name);
    let points: Vec<ScalingPoint> = of_metric(THROUGHPUT)
        .filter(|row| {
            ["threads", "ranks"]
                .iter()
                .any(|key| row.point.contains_key(*key))
        })
        .filter_map(|row| {
            let threads = of_metric("n_threads").find(|threads| threads.point == row.point)?;
            let n_threads = threads.statistics.median;
            Some(ScalingPoint { row, n_threads })
        })
        .collect();
    let others = |point: &Map<String, Value>| {
        let mut others = point.clone();
        others.retain(|name, _| !WITH_THREADS.contains(&name.as_str()));
        others
    };
    let mut found = Vec::new();
    for point in &points {
        let alike = points.iter();
        let alike = alike.filter(|one| others(&one.row.point) == others(&point.row.point));
        let Some(base) = alike.min_by(|a, b| a.n_threads.total_cmp(&b.n_threads)) else {
            continue;
        };
        let speedup = 1.0 / base.row.statistics.median;
        let efficiency = speedup * base.n_threads / point.n_threads;
        for (metric, factor) in [("speedup", speedup), ("scaling_efficiency", efficiency)] {
            found.push(StatisticsRow {
                metric: metric.to_owned(),
                statistics: scaled(&point.row.statistics, factor),
                ..point.row.clone()
            });
        }
    }
    found
}

/// Returns the statistics of values that are all multiplied by a positive factor.
fn scaled(of: &SampleStatistics, factor: f64) -> SampleStatistics {
    SampleStatistics {
        mean: of.mean * factor,
        standard_deviation: of.standard_deviation * factor,
        min: of.min * factor,
        max: of.max * factor,
        median: of.median * factor,
        mad: of.mad * factor,
        low_95: of.low_95 * factor,
        high_95: of.high_95 * factor,
        ..*of
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn point(values: Value, metric: &str, measured: &[f64]) -> StatisticsRow {
        StatisticsRow {
            point: values.as_object().unwrap().clone(),
            metric: metric.to_owned(),
            statistics: SampleStatistics::from_values(measured).unwrap(),
            first_is_slow: false,
            oversubscribed: false,
        }
    }

    /// Returns the median of a metric of a point.
    fn median(rows: &[StatisticsRow], values: &Value, metric: &str) -> f64 {
        let of_point = rows
            .iter()
            .filter(|row| Some(&row.point) == values.as_object());
        let mut of_metric = of_point.filter(|row| row.metric == metric);
        of_metric.next().unwrap().statistics.median
    }

    /// By the wall times of the textbook definitions.
    #[test]
    fn strong_and_weak_scaling_are_those_of_the_definitions() {
        // Ranks of two threads: seconds for the same million pixels, and for one million each.
        let strong = [(1.0, 10.0), (2.0, 5.5), (4.0, 4.0)];
        let weak = [(1.0, 10.0), (2.0, 10.4), (4.0, 12.5)];
        let mut measured = Vec::new();
        let values = |ranks: f64, size: &str| json!({ "scene": size, "ranks": ranks });
        for ((ranks, seconds), (kind, pixels)) in strong
            .map(|run| (run, ("strong", 1e6)))
            .into_iter()
            .chain(weak.map(|run| (run, ("weak", 1e6 * run.0))))
        {
            let values = values(ranks, kind);
            measured.push(point(values.clone(), "n_threads", &[2.0 * ranks]));
            measured.push(point(values, "pixels_per_second", &[pixels / seconds]));
        }
        let found = scaling_rows(&measured);
        for (ranks, seconds) in strong {
            let values = values(ranks, "strong");
            let speedup = median(&found, &values, "speedup");
            assert!((speedup - 10.0 / seconds).abs() < 1e-9);
            let efficiency = median(&found, &values, "scaling_efficiency");
            assert!((efficiency - 10.0 / (ranks * seconds)).abs() < 1e-9);
        }
        for (ranks, seconds) in weak {
            let efficiency = median(&found, &values(ranks, "weak"), "scaling_efficiency");
            assert!((efficiency - 10.0 / seconds).abs() < 1e-9);
        }
    }

    #[test]
    fn a_study_without_threads_or_ranks_has_no_efficiency() {
        let values = json!({ "scene": "spot", "tile_size": 8 });
        let measured = [
            point(values.clone(), "n_threads", &[2.0]),
            point(values, "pixels_per_second", &[5.0]),
        ];
        assert!(scaling_rows(&measured).is_empty());
    }
}
