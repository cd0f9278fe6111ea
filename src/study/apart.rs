//! Which factors distinguish the series of a plot.

use serde_json::{Map, Value, json};

use super::Row;

/// The factors that a plot of `metric` over `x` needs, so that no series has two
/// points at one place: the scene always, the others where they need to.
///
/// Where `x` is a factor, another one that changes with it alone, as the size of
/// a picture with the number of threads, belongs to the same series. Where `x`
/// was measured, so does each factor that `x` depends on: a series leads from one
/// of its levels to the next.
pub(super) fn factors(x: &str, metric: &str, rows: &[Row]) -> Vec<String> {
    let of_metric = || rows.iter().filter(|row| row.metric == metric);
    let is_factor = of_metric().any(|row| row.point.contains_key(x));
    let x_of = |row: &Row| {
        let measured = |other: &&Row| other.metric == x && other.point == row.point;
        let median = |row: &Row| json!(row.statistics.median);
        row.point
            .get(x)
            .cloned()
            .or_else(|| rows.iter().find(measured).map(median))
    };
    let points: Vec<Point> = of_metric()
        .filter_map(|row| Some((&row.point, x_of(row)?)))
        .collect();
    if is_factor {
        besides_factor(x, &points)
    } else {
        besides_measured(&points)
    }
}

/// The levels of all factors, and where that lies along the lower axis.
type Point<'a> = (&'a Map<String, Value>, Value);

fn besides_factor(x: &str, points: &[Point]) -> Vec<String> {
    let mut apart: Vec<String> = Vec::new();
    for factor in names(points) {
        let is_needed = pairs(points).any(|((a, x_of_a), (b, x_of_b))| {
            let is_same = apart.iter().all(|other| a[other] == b[other]);
            x_of_a == x_of_b && is_same && a[factor] != b[factor]
        });
        if factor != x && (factor == "scene" || is_needed) {
            apart.push(factor.clone());
        }
    }
    apart
}

fn besides_measured(points: &[Point]) -> Vec<String> {
    let is_apart = |factor: &&String| {
        let differ_in_it = |((a, _), (b, _)): &(&Point, &Point)| {
            a.iter()
                .all(|(name, level)| (b[name] == *level) != (name == *factor))
        };
        let mut alike = pairs(points).filter(differ_in_it).peekable();
        let has_levels = alike.peek().is_some();
        *factor == "scene" || has_levels && alike.all(|((_, x_of_a), (_, x_of_b))| x_of_a == x_of_b)
    };
    names(points).filter(is_apart).cloned().collect()
}

/// All factors, in their order.
fn names<'a>(points: &[Point<'a>]) -> impl Iterator<Item = &'a String> {
    points
        .first()
        .into_iter()
        .flat_map(|(point, _)| point.keys())
}

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
        let points: Vec<Point> = all.iter().map(|of| (of, of["threads"].clone())).collect();
        assert_eq!(besides_factor("threads", &points), ["scene"]);
    }

    #[test]
    fn factors_that_are_crossed_are_several() {
        let mut all = Vec::new();
        for (threads, size) in [(1, "s"), (2, "m")] {
            for tile in [8, 16] {
                all.push(point(
                    json!({ "scene": "a", "tile_size": tile, "threads": threads, "image_size": size }),
                ));
            }
        }
        let points: Vec<Point> = all.iter().map(|of| (of, of["tile_size"].clone())).collect();
        // The second one tells nothing that the first one does not.
        assert_eq!(besides_factor("tile_size", &points), ["scene", "threads"]);
    }

    #[test]
    fn a_measured_place_keeps_those_that_do_not_change_it() {
        let mut all = Vec::new();
        for (objects, bytes) in [(10, 1e3), (100, 1e4)] {
            for cost in ["time", "counters"] {
                all.push((
                    point(json!({ "scene": "a", "objects": objects, "cost": cost })),
                    json!(bytes),
                ));
            }
        }
        let points: Vec<Point> = all.iter().map(|(of, x)| (of, x.clone())).collect();
        assert_eq!(besides_measured(&points), ["scene", "cost"]);
    }
}
