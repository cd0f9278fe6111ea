//! Times and their confidence intervals on the terminal.

use std::time::Duration;

use base::numbers::duration;
use tools::study::SampleStatistics;

/// Returns a time in milliseconds in the unit that suits it.
pub(super) fn shown_ms(ms: f64) -> String {
    duration(Duration::from_secs_f64(ms / 1e3))
}

/// Returns the confidence interval of a time in milliseconds, or how to get one.
pub(super) fn interval_of(statistics: &SampleStatistics) -> String {
    statistics
        .interval
        .map_or("needs 6 runs".to_owned(), |interval| {
            let [low, high] = [interval.low_95, interval.high_95].map(shown_ms);
            format!("[{low}, {high}]")
        })
}
