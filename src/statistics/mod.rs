//! Whether two samples of a measurement differ by more than noise, and by how
//! much.
//!
//! Ranks alone are used: an interrupted run is one high rank, however long it
//! took, and no shape of the noise is assumed.

mod rank_sum;
mod ratio;

pub use rank_sum::mann_whitney_p;
pub use ratio::{CONFIDENCE, Ratio};
