//! Statistics of measurements: order statistics, the comparison of two samples, the fit of a linear model, and sums.
//!
//! Comparisons use only ranks: an interrupted run is one high rank, however long it took, and no
//! distribution of the noise is assumed.

mod histogram;
mod least_squares;
mod order;
mod rank_sum;
mod ratio;
mod spearman;
mod sum;

pub use histogram::{Histogram, value_past};
pub use least_squares::non_negative_least_squares;
pub use order::{median, upper_median};
pub use rank_sum::mann_whitney_p;
pub use ratio::{CONFIDENCE, Ratio};
pub use spearman::spearman;
pub use sum::sum;
