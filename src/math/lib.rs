//! Numbers: SIMD lanes, sampling, optics and statistics. No scene, no file.
//!
//! In: numbers, one or a lane of eight or sixteen. Out: numbers, the same bits on every
//! instruction set.
//!
//! Read [`simd`] first: the formulas of all later crates are generic over its lanes.
//! [`sampling`] has random numbers by key, pixel filters and distributions, [`optics`]
//! Fresnel's equations and rough surfaces. [`statistics`] stands by itself: studies and
//! summaries use it.

pub mod simd;
pub mod sampling;
pub mod optics;
pub mod statistics;
