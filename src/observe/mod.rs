//! Pixel → the tree of its rays, every step of theirs included.
//!
//! A third way to render a pixel, beside rays one by one and rays in streams,
//! with the same rays, hits and counters. It is slow and hides nothing: what
//! each ray met, which nodes and primitives it came across, how long it took
//! and what it brought to the pixel.

mod tree;
mod observer;
mod many;

pub use many::{ObservedPixel, TooManyRays};
pub use observer::Observer;
pub use tree::{RayTree, TracedRay};
