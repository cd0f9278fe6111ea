//! Numbers as they stand in a text.

/// "1.2 to 1.4", with a unit behind it, or one number where both are the same.
pub fn range(values: impl Iterator<Item = Option<f64>>, unit: &str) -> Option<String> {
    let values: Vec<f64> = values.collect::<Option<_>>()?;
    let least = values.iter().copied().reduce(f64::min)?;
    let most = values.iter().copied().reduce(f64::max)?;
    let [least, most] = [least, most].map(digits);
    let range = if least == most {
        least
    } else {
        format!("{least} to {most}")
    };
    Some(format!("{range} {unit}").trim_end().to_owned())
}

/// Two digits that count, three from 100 on.
pub fn digits(value: f64) -> String {
    let n_decimals = match value.abs() {
        0.0..0.1 => 3,
        ..1.0 => 2,
        ..10.0 => 1,
        _ => 0,
    };
    format!("{value:.n_decimals$}")
}

/// "a, b and c".
pub fn listed(items: &[String]) -> String {
    match items {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        _ => items.concat(),
    }
}
