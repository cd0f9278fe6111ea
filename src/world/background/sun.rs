//! The sun as a disk.

use std::f32::consts::{FRAC_1_PI, PI};

use glam::Vec3;

use crate::light::Illumination;
use math::sampling::disk;
use math::simd::{Real, Vector};

/// A disk of light infinitely far away, as large as the sun seen from Earth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sun {
    /// The direction to the center, a unit vector.
    direction: Vec3,
    /// The radiance, uniform over the disk.
    radiance: Vec3,
}

/// The sine of the angle from the center to the edge: 0.2666 degrees, the mean over a year.
const SINE: f32 = 0.004_653;

impl Sun {
    /// Creates the sun in a direction, a unit vector; `of_white` is the radiance of a white surface
    /// that faces it.
    pub(super) fn new(direction: Vec3, of_white: Vec3) -> Self {
        Self {
            direction,
            radiance: of_white / (SINE * SINE),
        }
    }

    /// Returns the radiance of a white surface that faces it.
    pub fn white_radiance(&self) -> Vec3 {
        self.radiance * (SINE * SINE)
    }

    /// Returns the radiance from a direction, a unit vector.
    #[inline(always)]
    pub fn radiance<R: Real>(&self, direction: Vector<R>) -> Vector<R> {
        let like = direction.x;
        let radiance = Vector::splat(like, self.radiance);
        let none = Vector::splat(like, Vec3::ZERO);
        Vector::select(self.is_hit(direction), radiance, none)
    }

    /// Samples a direction to the sun with two numbers in [0, 1), uniformly over the disk, and
    /// returns the light that arrives from it at any point, unless it is occluded.
    #[inline(always)]
    pub fn illuminate<R: Real>(&self, numbers: [R; 2]) -> Illumination<R> {
        let [x, y] = disk(numbers);
        let (one, sine) = (x.splat(1.0), x.splat(SINE));
        let (x, y) = (x * sine, y * sine);
        let cos = (one - x * x - y * y).sqrt();
        let density = density(cos);
        Illumination {
            direction: Vector::splat(x, self.direction).around([x, y, cos]),
            distance: x.splat(f32::INFINITY),
            radiance: Vector::splat(x, self.radiance) * (x.splat(FRAC_1_PI) / density),
            density,
        }
    }

    /// Returns the probability density of a direction, per steradian.
    #[inline(always)]
    pub fn density<R: Real>(&self, direction: Vector<R>) -> R {
        let cos = direction.dot(Vector::splat(direction.x, self.direction));
        R::select(self.is_hit(direction), density(cos), cos.splat(0.0))
    }

    #[inline(always)]
    fn is_hit<R: Real>(&self, direction: Vector<R>) -> R::Mask {
        let axis = Vector::splat(direction.x, self.direction);
        // The cosine itself would be too coarse.
        let across = direction.cross(axis);
        let zero = direction.x.splat(0.0);
        let square = zero.splat(SINE * SINE);
        across.dot(across).lt(square) & zero.lt(direction.dot(axis))
    }
}

/// Returns the density at this cosine from the center, per steradian.
#[inline(always)]
fn density<R: Real>(cos: R) -> R {
    cos * cos.splat(1.0 / (PI * SINE * SINE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_that_are_chosen_hit_the_disk() {
        let sun = Sun::new(Vec3::new(0.6, 0.64, -0.48), Vec3::new(1.0, 0.5, 0.25));
        let n = 100_u16;
        let mut of_white = Vec3::ZERO;
        for i in 0..n * n {
            let numbers = [i / n, i % n].map(|k| (f32::from(k) + 0.5) / f32::from(n));
            let light = sun.illuminate(numbers);
            of_white += Vec3::from(light.radiance) / f32::from(n * n);
            let found = sun.density(light.direction);
            assert!((found / light.density - 1.0).abs() < 1e-5, "{found}");
            assert_eq!(Vec3::from(sun.radiance(light.direction)), sun.radiance);
        }
        assert!(
            of_white.abs_diff_eq(sun.white_radiance(), 1e-4),
            "{of_white}"
        );
        let beside = Vec3::new(0.6, 0.65, -0.48).normalize();
        assert_eq!(Vec3::from(sun.radiance(beside.into())), Vec3::ZERO);
        assert_eq!(sun.density(Vector::from(-sun.direction)), 0.0);
    }
}
