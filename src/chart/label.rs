//! Formats values with engineering units and without trailing zeros.

/// The suffixes of a unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Suffixes and their size in the values' unit, smallest first.
    suffixes: [(&'static str, f64); 4],
}

impl Unit {
    /// Returns units of time for "ns", and powers of 1000 for all others.
    pub fn named(name: &str) -> Self {
        let suffixes = match name {
            "ns" => [(" ns", 1.0), (" µs", 1e3), (" ms", 1e6), (" s", 1e9)],
            _ => [("", 1.0), (" k", 1e3), (" M", 1e6), (" G", 1e9)],
        };
        Self { suffixes }
    }

    /// Formats `value` with `n_digits` significant digits: "500 ns", "1.5 µs", "−20 ns", "0".
    pub fn label(&self, value: f64, n_digits: usize) -> String {
        match value {
            0.0 => "0".to_owned(),
            ..0.0 => format!("−{}", self.size_label(-value, n_digits)),
            _ => self.size_label(value, n_digits),
        }
    }

    /// Formats a positive number.
    fn size_label(&self, value: f64, n_digits: usize) -> String {
        let exponential = format!("{:.*e}", n_digits - 1, value);
        let rounded: f64 = exponential.parse().unwrap_or(value);
        let [smallest, .., largest] = self.suffixes;
        let fitting = self
            .suffixes
            .iter()
            .rev()
            .find(|(_, size)| rounded >= *size);
        let (suffix, size) = fitting.copied().unwrap_or(smallest);
        let number = rounded / size;
        if number < 1e-3 || number >= 1e4 && size == largest.1 {
            return format!("{number:e}{suffix}");
        }
        let n_integer_digits = number.log10().floor() as i32 + 1;
        let n_decimals = (n_digits as i32 - n_integer_digits).max(0) as usize;
        let fixed = format!("{number:.n_decimals$}");
        let trimmed = if n_decimals > 0 {
            fixed.trim_end_matches('0').trim_end_matches('.')
        } else {
            &fixed
        };
        format!("{trimmed}{suffix}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_written_in_the_unit_that_fits() {
        let table = [
            (1.0, "1 ns"),
            (0.5, "0.5 ns"),
            (500.0, "500 ns"),
            (999.7, "1 µs"),
            (2e3, "2 µs"),
            (1234.0, "1.23 µs"),
            (0.30000000000000004, "0.3 ns"),
            (5e4, "50 µs"),
            (1e6, "1 ms"),
            (2.5e9, "2.5 s"),
            (1.2e12, "1200 s"),
            (3e20, "3e11 s"),
            (2e-9, "2e-9 ns"),
            (0.0, "0"),
            (-1500.0, "−1.5 µs"),
        ];
        for (value, expected) in table {
            assert_eq!(Unit::named("ns").label(value, 3), expected);
        }
    }

    #[test]
    fn counts_are_written_in_thousands() {
        let table = [
            (7.0, "7"),
            (512.0, "512"),
            (2e3, "2 k"),
            (1e6, "1 M"),
            (12_345.0, "12.3 k"),
        ];
        for (value, expected) in table {
            assert_eq!(Unit::named("node visits").label(value, 3), expected);
        }
    }
}
