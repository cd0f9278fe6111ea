//! A ray.

use glam::Vec3;

use crate::simd::{Integer, Real, Vector};

/// A half-line: the points `origin + t * direction` with `t > 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Its start point.
    pub origin: Vec3,
    /// Its direction: of unit length in world space, so that `t` is a distance
    /// there; of any length in object space, so that `t` is the same there.
    pub direction: Vec3,
}

impl Ray {
    /// The point at parameter `t`.
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + t * self.direction
    }

    /// The ray in `direction` from the surface point `position` with unit
    /// normal `normal`. Its origin is offset from the surface toward the side of
    /// the direction, so that it does not hit the surface again.
    ///
    /// The offset is 256 units in the last place of each coordinate, or 1/65536
    /// near the origin of space: Wächter and Binder, "A Fast and Robust Method
    /// for Avoiding Self-Intersection", Ray Tracing Gems (2019), chapter 6.
    pub fn leaving(position: Vec3, normal: Vec3, direction: Vec3) -> Self {
        let origin = leaving(position.into(), normal.into(), direction.into());
        Self {
            origin: origin.into(),
            direction,
        }
    }
}

/// The origin of [`Ray::leaving`], for one ray or for lanes of rays.
#[inline(always)]
pub fn leaving<R: Real>(position: Vector<R>, normal: Vector<R>, direction: Vector<R>) -> Vector<R> {
    let side = normal.flip_sign_by(direction.dot(normal));
    Vector {
        x: offset(position.x, side.x),
        y: offset(position.y, side.y),
        z: offset(position.z, side.z),
    }
}

/// A coordinate `p`, offset along the normal's coordinate `n`.
#[inline(always)]
fn offset<R: Real>(p: R, n: R) -> R {
    let near_zero = p + n * p.splat(1.0 / 65536.0);
    let ulps = (p.splat(256.0) * n).flip_sign_by(p).to_integer();
    let far = R::from_integer_bits(p.to_integer_bits().plus(ulps));
    R::select(p.abs().lt(p.splat(1.0 / 32.0)), near_zero, far)
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
                let ray = Ray::leaving(position, normal, sign * normal);
                assert!((ray.origin - position).dot(normal) * sign > 0.0);
                assert!((ray.origin - position).length() < 1e-4 * scale.max(1.0));
            }
        }
    }
}
