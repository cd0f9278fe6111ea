//! Descriptive statistics of a sample of repeated measurements.

use serde::Serialize;

use super::median_interval::MedianInterval;
use math::statistics::median;

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
    /// The 95 % confidence interval of the median; `None` for fewer than six values.
    #[serde(flatten)]
    pub interval: Option<MedianInterval>,
    /// Number of values whose modified z-score is above 3.5.
    pub n_outliers: usize,
}

impl SampleStatistics {
    /// Computes the statistics of the values; `None` without values.
    pub fn from_values(values: &[f64]) -> Option<Self> {
        let mut sorted = values.to_vec();
        let median = median(&mut sorted)?;
        sorted.sort_by(f64::total_cmp);
        let n = values.len();
        let mean = values.iter().sum::<f64>() / n as f64;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        let mad = median_deviation(values, median)?;
        let outliers = values
            .iter()
            .filter(|value| is_outlier(**value, median, mad));
        Some(Self {
            n,
            mean,
            standard_deviation: (squares / (n as f64 - 1.0).max(1.0)).sqrt(),
            min: sorted[0],
            max: sorted[n - 1],
            median,
            mad,
            interval: MedianInterval::from_sorted(&sorted),
            n_outliers: outliers.count(),
        })
    }

    /// Returns the ends of the confidence interval or, for fewer than six values, the smallest and
    /// the largest one.
    pub fn spread(&self) -> [f64; 2] {
        self.interval.map_or([self.min, self.max], |interval| {
            [interval.low_95, interval.high_95]
        })
    }

    /// Returns the probability that the [`spread`](Self::spread) covers the true median; 0 for one
    /// value.
    pub fn coverage(&self) -> f64 {
        let of_range = 1.0 - 2.0 * 0.5_f64.powi(self.n as i32);
        self.interval.map_or(of_range, |interval| interval.coverage)
    }

    /// Returns true if a value is an outlier: if its modified z-score is above 3.5.
    pub fn is_outlier(&self, value: f64) -> bool {
        is_outlier(value, self.median, self.mad)
    }
}

/// Returns the median absolute deviation from `center`.
fn median_deviation(values: &[f64], center: f64) -> Option<f64> {
    let mut deviations: Vec<f64> = values.iter().map(|value| (value - center).abs()).collect();
    median(&mut deviations)
}

fn is_outlier(value: f64, median: f64, mad: f64) -> bool {
    mad > 0.0 && (value - median).abs() > OUTLIER * MAD_TO_SIGMA * mad
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
        assert_eq!(statistics.spread(), [2.0, 9.0]);
        assert!((statistics.coverage() - 0.992).abs() < 1e-3);
        assert_eq!(SampleStatistics::from_values(&[]), None);
    }

    #[test]
    fn one_value_has_no_deviation() {
        let one = SampleStatistics::from_values(&[3.0]).unwrap();
        assert_eq!((one.standard_deviation, one.mad), (0.0, 0.0));
        assert_eq!((one.spread(), one.interval), ([3.0; 2], None));
        assert_eq!(one.coverage(), 0.0);
    }

    #[test]
    fn outliers_are_counted_and_not_removed() {
        let values = [10.0, 10.1, 9.9, 10.0, 10.2, 30.0];
        let statistics = SampleStatistics::from_values(&values).unwrap();
        assert_eq!((statistics.n, statistics.n_outliers), (6, 1));
        assert!(statistics.is_outlier(30.0) && !statistics.is_outlier(10.2));
        assert_eq!(statistics.max, 30.0);
    }
}
