//! The confidence interval of a median: two of the measured values.
//!
//! No distribution of the noise is assumed: each value lies below the true median with probability
//! 1/2, so that the number of values below it is binomial. Hahn and Meeker, "Statistical
//! Intervals", 1991, section 5.2.

use serde::Serialize;

/// Minimum probability that the interval covers the true median.
const COVERAGE: f64 = 0.95;

/// The smallest interval between the k-th smallest and the k-th largest value that covers the true
/// median with a probability of at least 95 %.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MedianInterval {
    /// Lower end.
    pub low_95: f64,
    /// Upper end.
    pub high_95: f64,
    /// Probability that the interval covers the true median: 0.961 for 9 values.
    pub coverage: f64,
}

impl MedianInterval {
    /// Returns the interval of values in ascending order; `None` for fewer than six, which even
    /// their whole range covers in less than 95 % of cases.
    pub fn from_sorted(values: &[f64]) -> Option<Self> {
        let n = values.len();
        // The probability that exactly k values lie below the true median, as a logarithm: 2⁻ⁿ
        // would be 0 for many values. `outside`: that at most k do.
        let mut log_probability = -(n as f64) * std::f64::consts::LN_2;
        let mut outside = log_probability.exp();
        let mut found = None;
        for k in 0..n / 2 {
            let coverage = 1.0 - 2.0 * outside;
            if coverage < COVERAGE {
                break;
            }
            found = Some(Self {
                low_95: values[k],
                high_95: values[n - 1 - k],
                coverage,
            });
            log_probability += ((n - k) as f64 / (k + 1) as f64).ln();
            outside += log_probability.exp();
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use math::sampling::uniform;

    /// The ranks, from 1, and coverages of the tables in Hahn and Meeker and in Le Boudec,
    /// "Performance Evaluation of Computer and Communication Systems", 2010, table A.1.
    #[test]
    fn ranks_are_those_of_published_tables() {
        let interval = |n: u32| {
            let values: Vec<f64> = (1..=n).map(f64::from).collect();
            MedianInterval::from_sorted(&values)
        };
        assert!((0..6).all(|n| interval(n).is_none()));
        for (n, low, high, coverage) in [
            (6, 1.0, 6.0, 0.969),
            (7, 1.0, 7.0, 0.984),
            (9, 2.0, 8.0, 0.961),
            (15, 4.0, 12.0, 0.965),
            (30, 10.0, 21.0, 0.957),
            (70, 27.0, 44.0, 0.959),
        ] {
            let found = interval(n).unwrap();
            assert_eq!((found.low_95, found.high_95), (low, high), "{n} values");
            assert!((found.coverage - coverage).abs() < 6e-4, "{found:?}");
        }
        // 2⁻ⁿ is smaller than the smallest number here.
        let many = interval(2000).unwrap();
        assert!((0.95..0.955).contains(&many.coverage), "{many:?}");
    }

    /// Intervals of samples of a skewed distribution cover its median as often as they claim.
    #[test]
    fn the_interval_covers_as_often_as_it_says() {
        const N_STUDIES: u64 = 4000;
        let covers = |study: &u64| {
            let pick = |i: u64| {
                let [u, ..] = uniform([*study, i, 77]);
                -f64::from(1.0 - u).ln()
            };
            let mut values: Vec<f64> = (0..9).map(pick).collect();
            values.sort_by(f64::total_cmp);
            let found = MedianInterval::from_sorted(&values).unwrap();
            let median = std::f64::consts::LN_2;
            found.low_95 <= median && median <= found.high_95
        };
        let share = (0..N_STUDIES).filter(covers).count() as f64 / N_STUDIES as f64;
        // Three standard errors around 0.961.
        assert!((0.952..0.970).contains(&share), "{share}");
    }
}
