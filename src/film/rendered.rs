//! Rendered pixels that are to be written to the film.

use glam::Vec3;

use crate::cost::Counters;
use crate::trace::SurfacePoint;

/// Pixels of a tile and their cost, row by row.
#[derive(Debug, Clone, Copy)]
pub struct Rendered<'a> {
    /// The images of the pixels.
    pub pixels: &'a [Pixel],
    /// The counters of the pixels, if they were counted.
    pub counters: Option<&'a Counters>,
    /// The times of the pixels; empty if they were not measured.
    pub times: &'a [PixelTime],
    /// Time in which pixels were rendered that count for nothing, in nanoseconds.
    pub warm_up_ns: f64,
}

/// The color and the surface of one pixel.
#[derive(Debug, Clone, Copy, Default)]
pub struct Pixel {
    /// Mean color of the samples, not clamped.
    pub color: Vec3,
    /// The surface point that the camera ray of the center sample hit.
    pub surface: Option<SurfacePoint>,
    /// The size of the pixel there, in world units.
    pub footprint: f32,
}

/// One measured time of a pixel.
#[derive(Debug, Clone, Copy, Default)]
pub struct PixelTime {
    /// The time in nanoseconds.
    pub ns: f32,
    /// Whether the thread lost its CPU meanwhile or in the pixel before, as far as
    /// the system reports it: then the time is not that of the pixel alone.
    pub is_rejected: bool,
}
