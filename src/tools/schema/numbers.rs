//! The ranges of numbers that the parser accepts.

use serde_json::{Value, json};

/// Whole numbers that are tried, besides those up to 40, and their negatives.
const WHOLE: [u64; 20] = [
    50,
    64,
    100,
    128,
    180,
    200,
    254,
    255,
    256,
    257,
    360,
    1000,
    1024,
    4096,
    10_000,
    65_535,
    65_537,
    1_000_000,
    4_000_000_000,
    1_000_000_000_000_000,
];
/// Numbers that are tried, and their negatives.
const REAL: [f64; 27] = [
    1e-30, 1e-16, 1e-15, 1e-12, 1e-9, 1e-6, 1e-4, 1e-3, 0.01, 0.1, 0.25, 0.5, 0.75, 1.5, 2.5, 9.5,
    31.5, 99.5, 179.5, 300.5, 1000.5, 10_000.5, 1e6, 1e9, 1e12, 1e15, 1e16,
];

/// Returns a schema of the numbers that `accepts` accepts, and samples of them, or `None` if it
/// accepts none. Ranges are found by bisection between numbers that are tried.
pub(super) fn explore(accepts: &mut dyn FnMut(Value) -> bool) -> Option<(Value, Vec<f64>)> {
    let mut whole: Vec<i128> = (0..=40).chain(WHOLE.map(i128::from)).collect();
    whole.push(u64::MAX.into());
    whole.extend(
        whole
            .clone()
            .into_iter()
            .filter(|n| (1..=1_000_000).contains(n))
            .map(|n| -n),
    );
    whole.sort_unstable();
    let mut real: Vec<f64> = REAL
        .into_iter()
        .chain(REAL.map(|x| -x))
        .chain([0.0])
        .collect();
    real.extend([1e30, -1e30]);
    real.sort_by(f64::total_cmp);
    let ranges_of_reals = ranges(&real, &mut |x| accepts(json!(x)), &between_reals);
    if !ranges_of_reals.is_empty() {
        let samples = samples(&ranges_of_reals);
        let ranges = ranges_of_reals.into_iter().map(|[from, to]| {
            let mut range = json!({ "type": "number" });
            if from > -1e30 {
                range["minimum"] = short(from);
            }
            if to < 1e30 {
                range["maximum"] = short(to);
            }
            range
        });
        return Some((any_of(ranges.collect()), samples));
    }
    let as_json = |n: i128| u64::try_from(n).map_or_else(|_| json!(n as i64), |n| json!(n));
    let ranges = ranges(&whole, &mut |n| accepts(as_json(n)), &between_integers);
    let bounds: Vec<[f64; 2]> = ranges.iter().map(|range| range.map(|n| n as f64)).collect();
    let schemas = ranges.iter().map(|&[from, to]| {
        if from == to {
            json!({ "const": as_json(from) })
        } else {
            json!({ "type": "integer", "minimum": as_json(from), "maximum": as_json(to) })
        }
    });
    let schemas: Vec<Value> = schemas.collect();
    (!schemas.is_empty()).then(|| (any_of(schemas), samples(&bounds)))
}

/// Returns a schema that accepts any of several.
pub(super) fn any_of(schemas: Vec<Value>) -> Value {
    let flat = schemas.into_iter().flat_map(|schema| match schema {
        Value::Object(mut parts) if parts.len() == 1 && parts.contains_key("anyOf") => {
            match parts.remove("anyOf") {
                Some(Value::Array(schemas)) => schemas,
                _ => Vec::new(),
            }
        }
        other => vec![other],
    });
    let mut flat: Vec<Value> = flat.collect();
    if flat.len() == 1 {
        flat.remove(0)
    } else {
        json!({ "anyOf": flat })
    }
}

/// Returns different numbers of the ranges.
fn samples(ranges: &[[f64; 2]]) -> Vec<f64> {
    let nice = [
        1.0, 2.0, 3.0, 5.0, 7.0, 4.0, 8.0, 6.0, 0.5, 0.25, 0.75, 10.0, 30.0,
    ];
    let is_inside = |x: &f64| ranges.iter().any(|[from, to]| (*from..=*to).contains(x));
    let inside: Vec<f64> = nice.into_iter().filter(is_inside).collect();
    match inside.as_slice() {
        [] => vec![ranges[0][1]],
        _ => inside,
    }
}

/// Returns the ranges of accepted numbers among sorted ones, and the numbers between them.
fn ranges<N: Copy + PartialEq>(
    tried: &[N],
    accepts: &mut dyn FnMut(N) -> bool,
    between: &dyn Fn(N, N) -> Option<N>,
) -> Vec<[N; 2]> {
    let mut found: Vec<[N; 2]> = Vec::new();
    let mut last: Option<(N, bool)> = None;
    for &number in tried {
        let is_accepted = accepts(number);
        match last {
            Some((before, true)) if !is_accepted => {
                let end = bisect(before, number, accepts, between);
                if let Some(range) = found.last_mut() {
                    range[1] = end;
                }
            }
            Some((before, false)) if is_accepted => {
                let start = bisect(number, before, accepts, between);
                found.push([start, number]);
            }
            None if is_accepted => found.push([number, number]),
            _ => {}
        }
        if let Some(range) = found.last_mut().filter(|_| is_accepted) {
            range[1] = number;
        }
        last = Some((number, is_accepted));
    }
    found
}

/// Returns the accepted number that is nearest to the refused one.
fn bisect<N: Copy>(
    mut accepted: N,
    mut refused: N,
    accepts: &mut dyn FnMut(N) -> bool,
    between: &dyn Fn(N, N) -> Option<N>,
) -> N {
    while let Some(middle) = between(accepted, refused) {
        if accepts(middle) {
            accepted = middle;
        } else {
            refused = middle;
        }
    }
    accepted
}

fn between_integers(a: i128, b: i128) -> Option<i128> {
    let middle = (a + b).div_euclid(2);
    (middle != a && middle != b).then_some(middle)
}

/// Returns the number in the middle of all 64-bit numbers between two.
fn between_reals(a: f64, b: f64) -> Option<f64> {
    // Numbers have the same order as these integers.
    let order = |x: f64| {
        let bits = x.to_bits() as i64;
        if bits < 0 { i64::MIN - bits } else { bits }
    };
    let middle = between_integers(order(a).into(), order(b).into())? as i64;
    let bits = if middle < 0 {
        i64::MIN - middle
    } else {
        middle
    };
    Some(f64::from_bits(bits as u64))
}

/// Returns a number without a fraction as an integer.
pub(super) fn short(x: f64) -> Value {
    if x.fract() == 0.0 && x.abs() <= 1e15 {
        json!(x as i64)
    } else {
        json!(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_found_to_the_last_bit() {
        let number = |value: &Value| value.as_f64().unwrap();
        let mut in_two = |value: Value| {
            let x = number(&value);
            (1e-6..=1e6).contains(&x.abs())
        };
        let (schema, _) = explore(&mut in_two).unwrap();
        let expected = json!({ "anyOf": [
            { "type": "number", "minimum": -1_000_000, "maximum": -1e-6 },
            { "type": "number", "minimum": 1e-6, "maximum": 1_000_000 },
        ] });
        assert_eq!(schema, expected);
        let mut whole = |value: Value| {
            value
                .as_u64()
                .is_some_and(|n| n == 0 || (3..=32).contains(&n))
        };
        let (schema, samples) = explore(&mut whole).unwrap();
        let expected = json!({ "anyOf": [
            { "const": 0 },
            { "type": "integer", "minimum": 3, "maximum": 32 },
        ] });
        assert_eq!((schema, samples[0]), (expected, 3.0));
        let mut any = |_: Value| true;
        assert_eq!(explore(&mut any).unwrap().0, json!({ "type": "number" }));
        assert_eq!(explore(&mut |_| false), None);
    }
}
