//! Pixels on their way into the film.

use glam::Vec3;

use crate::cost::Counters;
use crate::trace::SurfacePoint;

/// Pixels of a tile and what they cost, row by row.
#[derive(Debug, Clone, Copy)]
pub struct Rendered<'a> {
    /// What is seen.
    pub pixels: &'a [Pixel],
    /// The counters of each pixel, if there are any.
    pub counters: Option<&'a Counters>,
    /// The time of each pixel; empty where it was not measured.
    pub times: &'a [PixelTime],
}

/// What is seen in one pixel.
#[derive(Debug, Clone, Copy, Default)]
pub struct Pixel {
    /// Mean colour of the samples, not yet limited to 1.
    pub color: Vec3,
    /// What the middle sample's camera ray met.
    pub surface: Option<SurfacePoint>,
    /// World-space size of the pixel there.
    pub footprint: f32,
}

/// One measured time of a pixel.
#[derive(Debug, Clone, Copy, Default)]
pub struct PixelTime {
    /// In nanoseconds.
    pub ns: f32,
    /// Whether the thread changed its CPU meanwhile: not a time of the pixel
    /// alone.
    pub is_rejected: bool,
}
