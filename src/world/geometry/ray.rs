//! A ray.

use glam::Vec3;

use math::simd::{Real, Vector};

/// A half-line: the points `origin + t * direction` with `t > 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// The start point.
    pub origin: Vec3,
    /// The direction: of unit length in world space, so that `t` is a distance there; of any length
    /// in object space, so that `t` stays the same.
    pub direction: Vec3,
}

impl Ray {
    /// Returns the point at parameter `t`.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + t * self.direction
    }

    /// Returns the ray in `direction` from a surface point with a unit normal. `error` bounds the
    /// distance of the computed point from the surface: the ray starts this far off the surface, on
    /// the side of its direction, so that it does not hit the surface again.
    ///
    /// Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th edition, section 6.8.6.
    #[inline]
    pub fn leaving([position, normal]: [Vec3; 2], error: f32, direction: Vec3) -> Self {
        let origin = leaving([position.into(), normal.into()], error, direction.into());
        Self {
            origin: origin.into(),
            direction,
        }
    }
}

/// Returns the origin of [`Ray::leaving`], for one ray or for lanes of rays.
#[inline(always)]
pub fn leaving<R: Real>(
    [position, normal]: [Vector<R>; 2],
    error: R,
    direction: Vector<R>,
) -> Vector<R> {
    position + normal.flip_sign_by(direction.dot(normal)) * error
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leaving_ray_starts_on_the_side_of_its_direction() {
        for scale in [1e-6, 1.0, 1e6] {
            for sign in [-1.0, 1.0] {
                let position = Vec3::new(0.3, -0.7, 0.2) * scale;
                let normal = Vec3::new(1.0, 2.0, -3.0).normalize();
                let error = 1e-5 * scale;
                let ray = Ray::leaving([position, normal], error, sign * normal);
                let height = (ray.origin - position).dot(normal) * sign;
                assert!((0.9 * error..1.1 * error).contains(&height));
            }
        }
    }
}
