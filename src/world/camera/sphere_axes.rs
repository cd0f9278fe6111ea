//! Directions as longitudes and latitudes.

use glam::Vec3;

use math::simd::{Real, Vector, cos_sin};

/// The axes of a sphere of directions: orthonormal vectors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphereAxes {
    /// The direction at longitude and latitude 0.
    pub(super) forward: Vec3,
    /// The direction a quarter turn to the east.
    pub(super) right: Vec3,
    /// The direction of the north pole.
    pub(super) up: Vec3,
}

impl SphereAxes {
    /// Returns the unit direction at pixel coordinates (x, y) of a map of this size.
    #[inline(always)]
    pub(super) fn direction<R: Real>(
        &self,
        [x, y]: [R; 2],
        [width, height]: [u32; 2],
    ) -> Vector<R> {
        let half = x.splat(0.5);
        let longitude = (x + half) / x.splat(width as f32) - half;
        let [cos_longitude, sin_longitude] = cos_sin(longitude);
        let [cos_latitude, sin_latitude] = cos_sin(latitude(y, height));
        let around = Vector::splat(x, self.forward) * cos_longitude
            + Vector::splat(x, self.right) * sin_longitude;
        around * cos_latitude + Vector::splat(x, self.up) * sin_latitude
    }
}

/// Returns the side of a square with the solid angle of a pixel of row `y`, relative to a pixel at
/// the horizon, in a map of this height.
#[inline(always)]
pub(super) fn shrinkage<R: Real>(y: R, height: u32) -> R {
    let [cosine, _] = cos_sin(latitude(y, height));
    cosine.sqrt()
}

/// Returns the latitude of a row in turns, from 1/4 to -1/4.
#[inline(always)]
fn latitude<R: Real>(y: R, height: u32) -> R {
    y.splat(0.25) - (y + y.splat(0.5)) / y.splat(2.0 * height as f32)
}
