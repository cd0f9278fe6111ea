//! Statistics of measurements: order statistics, the summary of a sample, and the
//! comparison of two samples.
//!
//! Comparisons use ranks alone: an interrupted run is one high rank, however
//! long it took, and no distribution of the noise is assumed.

mod floats;
mod order;
mod rank_sum;
mod ratio;
mod sample;

pub use floats::floats_at;
pub use order::{median, upper_median};
pub use rank_sum::mann_whitney_p;
pub use ratio::{CONFIDENCE, Ratio};
pub use sample::SampleStatistics;
