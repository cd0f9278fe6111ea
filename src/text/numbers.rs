//! Numbers as people read them.

use std::path::Path;
use std::time::Duration;

use super::terminal::one_line;

/// `1,234,567`
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

/// `1 light`, `2 lights`, `10,000 spheres`.
pub fn counted(n: u64, noun: &str) -> String {
    let plural = if n == 1 { "" } else { "s" };
    format!("{} {noun}{plural}", count(n))
}

/// `Primitive tests` for `primitive tests`.
pub(crate) fn capitalized(words: &str) -> String {
    let mut chars = words.chars();
    let first = chars.next().map(|first| first.to_ascii_uppercase());
    first.into_iter().chain(chars).collect()
}

/// `512 B`, `1.5 MB`; powers of ten, as disks are sold.
pub fn bytes(n: u64) -> String {
    scaled(n as f64, 1e3, &["B", "kB", "MB", "GB", "TB", "PB", "EB"])
}

/// `850 ns`, `1.25 ms`, `3.1 s`.
pub fn duration(elapsed: Duration) -> String {
    let seconds = elapsed.as_secs_f64();
    if seconds >= 100.0 {
        return format!("{seconds:.0} s");
    }
    scaled(elapsed.as_nanos() as f64, 1e3, &["ns", "µs", "ms", "s"])
}

/// The path as one word for a shell.
pub(crate) fn shell_word(path: &Path) -> String {
    let text = one_line(&path.to_string_lossy()).into_owned();
    let plain = |c: char| c.is_alphanumeric() || "/._-+:@%".contains(c);
    if text.chars().all(plain) {
        text
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}

/// Converts to milliseconds, rounded to a thousandth.
pub(crate) fn milliseconds(elapsed: Duration) -> f64 {
    (elapsed.as_secs_f64() * 1e6).round() / 1e3
}

/// Three digits and the unit that fits.
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
        assert_eq!(duration(Duration::from_nanos(60)), "60 ns");
        assert_eq!(duration(Duration::from_micros(1250)), "1.25 ms");
        assert_eq!(duration(Duration::from_secs(250)), "250 s");
        assert_eq!(duration(Duration::from_nanos(999_600)), "1.00 ms");
    }
}
