//! The footer: the kind of scale, and the number of pixels outside of it.

use super::label::Unit;
use super::range::Range;
use super::ticks::Scale;

/// Returns a line such as "Logarithmic scale; 2 pixels above 9.81 µs, up to 412 µs".
pub fn line(unit_name: &str, range: &Range) -> String {
    let unit = Unit::from_name(unit_name);
    let label = |value: f64| unit.label(value, 3);
    let scale = match range.scale {
        Scale::Logarithmic => "Logarithmic scale",
        Scale::Linear => "Red: more, blue: less; linear scale",
    };
    let mut parts = vec![match unit_name {
        "ns" => scale.to_owned(),
        other => format!("{scale} of {other}"),
    }];
    let above = (range.n_above, range.high, range.max, "above", "up");
    let below = (range.n_below, range.low, range.min, "below", "down");
    for (n, end, extreme, side, direction) in [above, below] {
        if n > 0 {
            let (n, end, extreme) = (pixels(n), label(end), label(extreme.into()));
            parts.push(format!("{n} {side} {end}, {direction} to {extreme}"));
        }
    }
    if range.n_undrawable > 0 {
        let n = pixels(range.n_undrawable);
        parts.push(format!("gray: {n} without a value"));
    }
    parts.join("; ")
}

fn pixels(n: u64) -> String {
    format!("{n} {}", if n == 1 { "pixel" } else { "pixels" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_counts_the_clipped_pixels() {
        let mut range = Range {
            n_undrawable: 0,
            ..Range::spanning(&[100.0, 2e4])
        };
        assert_eq!(line("ns", &range), "Logarithmic scale");
        assert_eq!(line("rays", &range), "Logarithmic scale of rays");
        range = Range {
            max: 4.124e5,
            n_above: 2,
            min: 3.0,
            n_below: 1,
            n_undrawable: 7,
            ..range
        };
        assert_eq!(
            line("ns", &range),
            "Logarithmic scale; 2 pixels above 20 µs, up to 412 µs; 1 pixel below 100 ns, down to \
             3 ns; gray: 7 pixels without a value"
        );
    }
}
