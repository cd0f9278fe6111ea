//! A ray → a hit, a color, and their cost: the kernels.
//!
//! In: a [`Scene`](world::scene::Scene), and rays one by one or as streams. Out: hits, surface
//! points, radiance and the next rays; a probe counts the work where one is given.
//!
//! Read [`cost`], the counters and the clock; [`accel`], the hierarchy, its builds and its
//! traversals, beside brute force, to which the tests compare them; [`trace`], from hits to surface
//! points; and [`shade`], from surface points to light.

pub mod cost;
pub mod accel;
pub mod trace;
pub mod shade;
