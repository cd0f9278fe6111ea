//! The footer: the kind of scale, and the number of pixels outside of it.

use super::label::Unit;
use super::range::{Range, Scale};

/// Returns a line such as "Logarithmic scale; 2 pixels above 9.81 µs, up to 412 µs".
pub fn line(unit_name: &str, range: &Range) -> String {
    let unit = Unit::named(unit_name);
    let label = |value: f64| unit.label(value, 3);
    let scale = match range.scale {
        Scale::Logarithmic => "Logarithmic scale",
        Scale::Linear => "Red: more, blue: less; linear scale",
    };
    let mut parts = vec![match unit_name {
        "ns" => scale.to_owned(),
        other => format!("{scale} of {other}"),
    }];
    if range.n_above > 0 {
        let (end, extreme) = (label(range.high), label(range.max.into()));
        parts.push(format!(
            "{} above {end}, up to {extreme}",
            pixels(range.n_above)
        ));
    }
    if range.n_below > 0 {
        let (end, extreme) = (label(range.low), label(range.min.into()));
        parts.push(format!(
            "{} below {end}, down to {extreme}",
            pixels(range.n_below)
        ));
    }
    if range.n_undrawable > 0 {
        parts.push(format!(
            "gray: {} without a value",
            pixels(range.n_undrawable)
        ));
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
            ..Range::of(&[100.0, 2e4])
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
