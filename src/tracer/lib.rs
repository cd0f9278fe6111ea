//! A ray -> a hit, a color and what they cost.

pub mod cost;
pub mod accel;
pub mod trace;
pub mod shade;
