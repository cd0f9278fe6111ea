//! Choice of the factors that distinguish the series of a plot.

use serde_json::{Map, Value, json};

use crate::study::StatisticsRow;

/// Returns the factors that a plot of `metric` over `x` needs, so that no series has two points at
/// one `x`: always the scene, the others only where necessary.
///
/// If `x` is a factor, another factor that changes with it, such as the image size with the number
/// of threads, stays within a series. If `x` is a metric, so does each factor that `x` depends on:
/// a series connects its levels.
pub(super) fn series_factors(x: &str, metric: &str, rows: &[StatisticsRow]) -> Vec<String> {
    let of_metric = || rows.iter().filter(|row| row.metric == metric);
    let is_factor = of_metric().any(|row| row.point.contains_key(x));
    let x_of = |row: &StatisticsRow| {
        let is_x = |other: &&StatisticsRow| other.metric == x && other.point == row.point;
        let median = |row: &StatisticsRow| json!(row.statistics.median);
        row.point
            .get(x)
            .cloned()
            .or_else(|| rows.iter().find(is_x).map(median))
    };
    let points: Vec<PointAtX> = of_metric()
        .filter_map(|row| Some((&row.point, x_of(row)?)))
        .collect();
    if is_factor {
        for_factor(x, &points)
    } else {
        for_metric(&points)
    }
}

/// The values of a point by factor name, and its `x`.
type PointAtX<'a> = (&'a Map<String, Value>, Value);

/// Returns the factors that a plot over the factor `x` needs.
fn for_factor(x: &str, points: &[PointAtX]) -> Vec<String> {
    let mut needed: Vec<String> = Vec::new();
    for factor in factor_names(points) {
        let separates = pairs(points).any(|((a, x_of_a), (b, x_of_b))| {
            let is_same_series = needed.iter().all(|other| a[other] == b[other]);
            x_of_a == x_of_b && is_same_series && a[factor] != b[factor]
        });
        if factor != x && (factor == "scene" || separates) {
            needed.push(factor.clone());
        }
    }
    needed
}

/// Returns the factors that a plot over a metric needs: the ones that do not change the metric.
fn for_metric(points: &[PointAtX]) -> Vec<String> {
    let is_needed = |factor: &&String| {
        let differ_in_it_alone = |((a, _), (b, _)): &(&PointAtX, &PointAtX)| {
            a.iter()
                .all(|(name, level)| (b[name] == *level) != (name == *factor))
        };
        let mut differing = pairs(points).filter(differ_in_it_alone).peekable();
        let has_levels = differing.peek().is_some();
        *factor == "scene"
            || has_levels && differing.all(|((_, x_of_a), (_, x_of_b))| x_of_a == x_of_b)
    };
    factor_names(points).filter(is_needed).cloned().collect()
}

/// Returns the names of all factors, in the order of the points' values.
fn factor_names<'a>(points: &[PointAtX<'a>]) -> impl Iterator<Item = &'a String> {
    points
        .first()
        .into_iter()
        .flat_map(|(point, _)| point.keys())
}

/// Returns all pairs of two different items.
fn pairs<T>(all: &[T]) -> impl Iterator<Item = (&T, &T)> {
    let rest = |i: usize| &all[i + 1..];
    (0..all.len()).flat_map(move |i| rest(i).iter().map(move |b| (&all[i], b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(values: Value) -> Map<String, Value> {
        values.as_object().unwrap().clone()
    }

    #[test]
    fn levels_that_change_together_are_one_series() {
        let all: Vec<_> = [("a", 1, "64x64"), ("a", 2, "90x90"), ("b", 1, "64x64")]
            .map(|(scene, threads, size)| {
                point(json!({ "scene": scene, "threads": threads, "image_size": size }))
            })
            .into();
        let points: Vec<PointAtX> = all.iter().map(|of| (of, of["threads"].clone())).collect();
        assert_eq!(for_factor("threads", &points), ["scene"]);
    }

    #[test]
    fn crossed_factors_distinguish_series() {
        let mut all = Vec::new();
        for (threads, size) in [(1, "s"), (2, "m")] {
            for tile in [8, 16] {
                all.push(point(
                    json!({ "scene": "a", "tile_size": tile, "threads": threads, "image_size": size }),
                ));
            }
        }
        let points: Vec<PointAtX> = all.iter().map(|of| (of, of["tile_size"].clone())).collect();
        // The image size changes with the threads: one of the two is enough.
        assert_eq!(for_factor("tile_size", &points), ["scene", "threads"]);
    }

    #[test]
    fn over_a_metric_only_factors_that_do_not_change_it_distinguish_series() {
        let mut all = Vec::new();
        for (objects, bytes) in [(10, 1e3), (100, 1e4)] {
            for cost in ["time", "counters"] {
                all.push((
                    point(json!({ "scene": "a", "objects": objects, "cost": cost })),
                    json!(bytes),
                ));
            }
        }
        let points: Vec<PointAtX> = all.iter().map(|(of, x)| (of, x.clone())).collect();
        assert_eq!(for_metric(&points), ["scene", "cost"]);
    }
}
