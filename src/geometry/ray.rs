//! A ray.

use glam::Vec3;

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
        let side = normal * direction.dot(normal).signum();
        let offset = |p: f32, n: f32| {
            if p.abs() < 1.0 / 32.0 {
                return p + n / 65536.0;
            }
            let ulps = (256.0 * n) as i32;
            f32::from_bits((p.to_bits() as i32 + if p < 0.0 { -ulps } else { ulps }) as u32)
        };
        Self {
            origin: Vec3::new(
                offset(position.x, side.x),
                offset(position.y, side.y),
                offset(position.z, side.z),
            ),
            direction,
        }
    }
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
