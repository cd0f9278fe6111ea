//! Formats values with engineering units and without trailing zeros.

/// Formats a number with at most six digits, three decimals and an SI prefix: "0.05", "65.536 k",
/// "1.5 M".
pub fn short_number(value: f64) -> String {
    COUNT.label_within(value, 6, 3)
}

/// Formats a number with three digits and an SI prefix: "0.05", "65.5 k".
pub fn rounded_number(value: f64) -> String {
    COUNT.label(value, 3)
}

/// The suffixes of a unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// The suffixes and their size in the values' unit, smallest first.
    suffixes: &'static [(&'static str, f64)],
}

const TIME: Unit = Unit {
    suffixes: &[(" ns", 1.0), (" µs", 1e3), (" ms", 1e6), (" s", 1e9)],
};

const COUNT: Unit = Unit {
    suffixes: &[
        ("", 1.0),
        (" k", 1e3),
        (" M", 1e6),
        (" G", 1e9),
        (" T", 1e12),
    ],
};

impl Unit {
    /// Returns units of time for "ns", and powers of 1000 for all others.
    pub fn from_name(name: &str) -> Self {
        match name {
            "ns" => TIME,
            _ => COUNT,
        }
    }

    /// Formats `value` with `n_digits` significant digits: "500 ns", "1.5 µs", "−20 ns", "0".
    pub fn label(&self, value: f64, n_digits: usize) -> String {
        self.label_within(value, n_digits, usize::MAX)
    }

    /// Formats `value` with `n_digits` significant digits and at most `max_decimals` decimals.
    fn label_within(&self, value: f64, n_digits: usize, max_decimals: usize) -> String {
        match value {
            0.0 => "0".to_owned(),
            ..0.0 => format!("−{}", self.size_label(-value, n_digits, max_decimals)),
            _ => self.size_label(value, n_digits, max_decimals),
        }
    }

    /// Formats a positive number.
    fn size_label(&self, value: f64, n_digits: usize, max_decimals: usize) -> String {
        let exponential = format!("{:.*e}", n_digits - 1, value);
        let rounded: f64 = exponential.parse().unwrap_or(value);
        let fitting = self.suffixes.iter().rfind(|(_, size)| rounded >= *size);
        let (suffix, size) = fitting.copied().unwrap_or(self.suffixes[0]);
        let number = rounded / size;
        if !(1e-3..1e4).contains(&number) {
            return format!("{number:e}{suffix}");
        }
        let n_integer_digits = number.log10().floor() as i32 + 1;
        let n_decimals = (n_digits as i32 - n_integer_digits).max(0) as usize;
        let n_decimals = n_decimals.min(max_decimals);
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
            assert_eq!(Unit::from_name("ns").label(value, 3), expected);
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
            assert_eq!(Unit::from_name("node visits").label(value, 3), expected);
        }
    }

    #[test]
    fn short_numbers_have_at_most_three_decimals() {
        let table = [
            (0.0, "0"),
            (0.05, "0.05"),
            (7.0, "7"),
            (999.0, "999"),
            (1500.0, "1.5 k"),
            (65_536.0, "65.536 k"),
            (1_048_576.0, "1.049 M"),
            (2e12, "2 T"),
            (3.0 * 1e-4, "3e-4"),
        ];
        for (value, expected) in table {
            assert_eq!(short_number(value), expected);
        }
    }
}
