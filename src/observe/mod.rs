//! Pixel → the tree of its rays, with every step of their traversals.
//!
//! A third way to render a pixel, besides single rays and streams of rays, with
//! the same rays, hits and counters. It is slow and records everything: what
//! each ray hit, which nodes and primitives it was tested against, how long it
//! took and how much it contributed to the pixel.

mod tree;
mod observer;
mod many;

pub use many::{ObservedPixel, TooManyRays};
pub use observer::Observer;
pub use tree::{RayTree, TracedRay};
