//! Numbers: SIMD lanes, sampling, optics and statistics. No scene, no file.
//!
//! In: numbers, single or in lanes of eight or sixteen. Out: numbers, bit-identical on every
//! instruction set.
//!
//! Read [`simd`] first: the formulas of all later crates are generic over its lanes. [`sampling`]
//! has random numbers by key, pixel filters and distributions, [`optics`] has Fresnel's equations
//! and rough surfaces. [`statistics`] is independent of the others: studies and summaries use it.

pub mod simd;
pub mod sampling;
pub mod optics;
pub mod statistics;
