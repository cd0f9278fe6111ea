//! What a sample of measurements says, whether two of them differ by more than
//! noise, and by how much.
//!
//! Comparisons use ranks alone: an interrupted run is one high rank, however
//! long it took, and no shape of the noise is assumed.

mod rank_sum;
mod ratio;
mod sample;

pub use rank_sum::mann_whitney_p;
pub use ratio::{CONFIDENCE, Ratio};
pub use sample::SampleStatistics;
