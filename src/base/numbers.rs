//! Numbers formatted for people, and parsed.

use std::time::Duration;

/// Formats a count: `1,234,567`.
pub fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut grouped = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}

/// Formats a count with its noun: `1 light`, `2 lights`, `10,000 spheres`.
pub fn counted(n: u64, noun: &str) -> String {
    let plural = if n == 1 { "" } else { "s" };
    format!("{} {noun}{plural}", count(n))
}

/// Capitalizes the first letter: `Primitive tests` for `primitive tests`.
pub fn capitalized(words: &str) -> String {
    let mut chars = words.chars();
    let first = chars.next().map(|first| first.to_ascii_uppercase());
    first.into_iter().chain(chars).collect()
}

/// Formats a size: `512 B`, `1.5 MB`; in powers of ten, as disks are sold.
pub fn bytes(n: u64) -> String {
    scaled(n as f64, 1e3, &["B", "kB", "MB", "GB", "TB", "PB", "EB"])
}

/// Formats two sizes of memory in the largest unit that shows which one is larger, and neither as
/// none: `3.1 GiB` and `2.9 GiB`, or `20.0 KiB` and `12.5 KiB`.
pub fn memory_sizes(sizes: [u64; 2]) -> [String; 2] {
    let units = [("GiB", 30), ("MiB", 20), ("KiB", 10)].into_iter();
    let in_unit = |(unit, power)| {
        sizes.map(|n| format!("{:.1} {unit}", n as f64 / f64::from(1_u32 << power)))
    };
    let shows = |text: &str, n: u64| n == 0 || !text.starts_with("0.0");
    let is_fine = |[a, b]: &[String; 2]| a != b && shows(a, sizes[0]) && shows(b, sizes[1]);
    let apart = units.map(in_unit).find(is_fine);
    apart.unwrap_or_else(|| sizes.map(|n| format!("{} bytes", count(n))))
}

/// Formats a duration: `850 ns`, `1.25 ms`, `3.1 s`.
pub fn duration(elapsed: Duration) -> String {
    let seconds = elapsed.as_secs_f64();
    if seconds >= 100.0 {
        return format!("{seconds:.0} s");
    }
    scaled(elapsed.as_nanos() as f64, 1e3, &["ns", "µs", "ms", "s"])
}

/// Reads a duration such as `90s`, `30m`, `1.5h` or `2d`: a number above 0 and its unit.
///
/// # Errors
/// The expected form.
pub fn parse_duration(text: &str) -> Result<Duration, String> {
    const UNITS: [(&str, f64); 5] = [
        ("ms", 1e-3),
        ("s", 1.0),
        ("m", 60.0),
        ("h", 3600.0),
        ("d", 86_400.0),
    ];
    let text = text.trim();
    let digits = text
        .find(|c: char| c.is_ascii_alphabetic())
        .unwrap_or(text.len());
    let (number, unit) = text.split_at(digits);
    let unit = UNITS.iter().find(|(name, _)| *name == unit);
    let number = number.trim().parse::<f64>().ok().filter(|&n| n > 0.0);
    let seconds = unit.zip(number).map(|((_, seconds), n)| n * seconds);
    let duration = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    duration.ok_or_else(|| "expected a duration such as 90s, 30m or 1.5h".to_owned())
}

/// Reads a size of memory such as `500M`, `4G` or `1.5 GiB`: a number above 0 and its unit. `K`,
/// `M`, `G` and `T` are powers of 1024, like `KiB` to `TiB`; `kB`, `MB`, `GB` and `TB` are powers
/// of 1000.
///
/// # Errors
/// The expected form.
pub fn parse_bytes(text: &str) -> Result<u64, String> {
    let text = text.trim();
    let digits = text
        .find(|c: char| c.is_ascii_alphabetic())
        .unwrap_or(text.len());
    let (number, unit) = text.split_at(digits);
    let exponent = |letter: &str| {
        ["K", "M", "G", "T"]
            .iter()
            .position(|known| *known == letter)
    };
    let unit = unit.to_ascii_uppercase();
    let (letter, base) = match unit.strip_suffix("IB") {
        Some(letter) => (letter, 1024.0),
        None => match unit.strip_suffix('B') {
            Some(letter) => (letter, 1000.0),
            None => (&*unit, 1024.0),
        },
    };
    let factor = exponent(letter).map(|exponent| f64::powi(base, exponent as i32 + 1));
    let number = number.trim().parse::<f64>().ok().filter(|&n| n > 0.0);
    let n_bytes = factor.zip(number).map(|(factor, n)| n * factor);
    let n_bytes = n_bytes.filter(|n| (1.0..1e18).contains(n));
    n_bytes
        .map(|n| n as u64)
        .ok_or_else(|| "expected a size such as 500M or 4G".to_owned())
}

/// Converts to milliseconds, rounded to a thousandth.
pub fn milliseconds(elapsed: Duration) -> f64 {
    (elapsed.as_secs_f64() * 1e6).round() / 1e3
}

/// Formats three digits and the unit that fits.
fn scaled(value: f64, step: f64, units: &[&str]) -> String {
    let mut value = value;
    let mut unit = 0;
    while value >= 999.5 && unit + 1 < units.len() {
        value /= step;
        unit += 1;
    }
    let decimals = match value {
        v if v >= 99.95 || v.fract() == 0.0 => 0,
        v if v >= 9.995 => 1,
        _ => 2,
    };
    format!("{value:.decimals$} {}", units[unit])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_grouped() {
        assert_eq!(
            [0, 999, 1000, 1234567].map(count),
            ["0", "999", "1,000", "1,234,567"]
        );
    }

    #[test]
    fn units_fit() {
        assert_eq!(bytes(512), "512 B");
        assert_eq!(bytes(1_500_000), "1.50 MB");
        for (sizes, shown) in [
            ([5 << 30, 3 << 30], ["5.0 GiB", "3.0 GiB"]),
            ([20 << 10, 25 << 9], ["20.0 KiB", "12.5 KiB"]),
            ([60 << 20, 20 << 20], ["60.0 MiB", "20.0 MiB"]),
            ([12 << 20, 0], ["12.0 MiB", "0.0 MiB"]),
            (
                [(1 << 30) + (3 << 20), 1 << 30],
                ["1027.0 MiB", "1024.0 MiB"],
            ),
            ([1025, 1024], ["1,025 bytes", "1,024 bytes"]),
        ] {
            assert_eq!(memory_sizes(sizes), shown);
        }
        for (text, seconds) in [
            ("90s", 90.0),
            ("30m", 1800.0),
            ("1.5h", 5400.0),
            ("250 ms", 0.25),
        ] {
            assert_eq!(parse_duration(text), Ok(Duration::from_secs_f64(seconds)));
        }
        for wrong in [
            "", "30", "m", "-1s", "0s", "nan s", "inf s", "1e300d", "1 week", "1m30s",
        ] {
            assert!(parse_duration(wrong).is_err(), "{wrong}");
        }
        let sizes = [
            ("4G", 4 << 30),
            ("1.5 GiB", 3 << 29),
            ("500mb", 500_000_000),
            ("64k", 1 << 16),
        ];
        for (text, n_bytes) in sizes {
            assert_eq!(parse_bytes(text), Ok(n_bytes), "{text}");
        }
        for wrong in [
            "", "4", "G", "-1G", "0M", "nan G", "1e300T", "4 X", "iB", "4B",
        ] {
            assert!(parse_bytes(wrong).is_err(), "{wrong}");
        }
        assert_eq!(duration(Duration::from_nanos(60)), "60 ns");
        assert_eq!(duration(Duration::from_micros(1250)), "1.25 ms");
        assert_eq!(duration(Duration::from_secs(250)), "250 s");
        assert_eq!(duration(Duration::from_nanos(999_600)), "1.00 ms");
    }
}
