//! Descriptive statistics of a sample of repeated measurements.

use serde::Serialize;

use super::median;
use crate::sampling::uniform;

/// Number of bootstrap resamples.
const N_RESAMPLES: u64 = 2000;
/// Share of the resamples' medians outside of the confidence interval.
const LEFT_OUT: f64 = 0.05;
/// Standard deviations per median absolute deviation of a normal distribution.
const MAD_TO_SIGMA: f64 = 1.4826;
/// Modified z-scores above this are outliers: Iglewicz and Hoaglin, "How to
/// Detect and Handle Outliers", ASQC 1993.
const OUTLIER: f64 = 3.5;

/// Statistics of one metric over the runs of a point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SampleStatistics {
    /// The number of runs.
    pub n: usize,
    /// Arithmetic mean.
    pub mean: f64,
    /// Standard deviation of the sample, with `n - 1` in the denominator; 0 for one
    /// run.
    pub standard_deviation: f64,
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// [Median](median()).
    pub median: f64,
    /// Median absolute deviation from the median.
    pub mad: f64,
    /// Lower end of the 95 % confidence interval of the median, by bootstrap
    /// percentiles: Efron and Tibshirani, "An Introduction to the Bootstrap", 1993,
    /// section 13.3.
    pub low_95: f64,
    /// Upper end of the interval; see `low_95`.
    pub high_95: f64,
    /// Number of values whose modified z-score is above 3.5.
    pub n_outliers: usize,
}

impl SampleStatistics {
    /// Computes the statistics of the values; `None` without values.
    pub fn from_values(values: &[f64]) -> Option<Self> {
        let median = median(&mut values.to_vec())?;
        let n = values.len();
        let mean = values.iter().sum::<f64>() / n as f64;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        let mad = mad(values, median)?;
        let [low_95, high_95] = confidence_interval(values);
        let outliers = values
            .iter()
            .filter(|value| is_outlier(**value, median, mad));
        Some(Self {
            n,
            mean,
            standard_deviation: (squares / (n as f64 - 1.0).max(1.0)).sqrt(),
            min: values.iter().copied().fold(f64::INFINITY, f64::min),
            max: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            median,
            mad,
            low_95,
            high_95,
            n_outliers: outliers.count(),
        })
    }

    /// Returns true if a value is an outlier: if its modified z-score is above 3.5.
    pub fn is_outlier(&self, value: f64) -> bool {
        is_outlier(value, self.median, self.mad)
    }
}

/// Returns the median absolute deviation from `center`.
fn mad(values: &[f64], center: f64) -> Option<f64> {
    let mut deviations: Vec<f64> = values.iter().map(|value| (value - center).abs()).collect();
    median(&mut deviations)
}

fn is_outlier(value: f64, median: f64, mad: f64) -> bool {
    mad > 0.0 && (value - median).abs() > OUTLIER * MAD_TO_SIGMA * mad
}

/// Returns the percentile interval of the median's bootstrap distribution, for at least one value.
/// The resamples use fixed random numbers, so that equal values give equal intervals.
fn confidence_interval(values: &[f64]) -> [f64; 2] {
    let n = values.len() as u64;
    let resample = |resample: u64| {
        let pick = |i: u64| {
            let [u, ..] = uniform([resample, i, n]);
            values[(f64::from(u) * n as f64) as usize]
        };
        median(&mut (0..n).map(pick).collect::<Vec<_>>())
    };
    let mut medians: Vec<f64> = (0..N_RESAMPLES).filter_map(resample).collect();
    medians.sort_by(f64::total_cmp);
    let tail = (LEFT_OUT / 2.0 * N_RESAMPLES as f64) as usize;
    [medians[tail], medians[medians.len() - 1 - tail]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_sample_has_its_statistics() {
        let statistics =
            SampleStatistics::from_values(&[2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]).unwrap();
        assert_eq!((statistics.n, statistics.mean), (8, 5.0));
        assert!((statistics.standard_deviation - (32.0_f64 / 7.0).sqrt()).abs() < 1e-12);
        assert_eq!((statistics.min, statistics.max), (2.0, 9.0));
        assert_eq!((statistics.median, statistics.mad), (4.5, 0.5));
        assert!((2.0..=4.5).contains(&statistics.low_95));
        assert!((4.5..=9.0).contains(&statistics.high_95));
        assert_eq!(SampleStatistics::from_values(&[]), None);
    }

    #[test]
    fn one_value_has_no_deviation() {
        let one = SampleStatistics::from_values(&[3.0]).unwrap();
        assert_eq!((one.standard_deviation, one.mad), (0.0, 0.0));
        assert_eq!([one.low_95, one.median, one.high_95], [3.0; 3]);
    }

    #[test]
    fn outliers_are_counted_and_not_removed() {
        let values = [10.0, 10.1, 9.9, 10.0, 10.2, 30.0];
        let statistics = SampleStatistics::from_values(&values).unwrap();
        assert_eq!((statistics.n, statistics.n_outliers), (6, 1));
        assert!(statistics.is_outlier(30.0) && !statistics.is_outlier(10.2));
        assert_eq!(statistics.max, 30.0);
    }

    /// The interval of a normal sample covers the true median about as often as claimed: for 15
    /// values it ends at the fourth or fifth value from each side, which cover it in 96 and 88 of
    /// 100 cases.
    #[test]
    fn the_interval_covers() {
        let normal = |study: u64, i: u64| {
            let [a, b, c, d] = uniform([study, i, 77]);
            let [e, f, g, h] = uniform([study, i, 78]);
            let [j, k, l, m] = uniform([study, i, 79]);
            f64::from(a + b + c + d + e + f + g + h + j + k + l + m) - 6.0
        };
        let covers = |study: &u64| {
            let values: Vec<f64> = (0..15).map(|i| normal(*study, i)).collect();
            let statistics = SampleStatistics::from_values(&values).unwrap();
            statistics.low_95 <= 0.0 && 0.0 <= statistics.high_95
        };
        let n_covering = (0..200).filter(covers).count();
        assert!((170..=199).contains(&n_covering), "{n_covering} of 200");
    }
}
