//! Numbers: SIMD lanes, sampling, optics and statistics.

pub mod simd;
pub mod sampling;
pub mod optics;
pub mod statistics;
