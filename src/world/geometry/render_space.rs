//! The space in which rays are traced.

use glam::{DAffine3, DVec3, Vec3};

/// The map between world space and render space, in which the scene has about unit size and is near
/// the origin, so that its 24-bit coordinates are as precise as possible: a translation and a power
/// of two. All 32-bit arithmetic happens there.
///
/// The `renderFromWorld` of Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th edition,
/// section 5.1, which does not scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderSpace {
    /// The origin of render space, in world space.
    origin: DVec3,
    /// World units per unit of render space: a power of two.
    unit: f64,
}

/// World space itself.
impl Default for RenderSpace {
    fn default() -> Self {
        Self {
            origin: DVec3::ZERO,
            unit: 1.0,
        }
    }
}

/// The distance of the world's origin, in sizes of the view, up to which it stays the origin, so
/// that short decimal coordinates stay exact.
const NEAR: f64 = 16.0;

impl RenderSpace {
    /// Creates the space of a scene of a size whose digits matter most at the point `focus`, within
    /// a length `detail` around it. Lengths that are not positive numbers count as 1.
    ///
    /// If a scene and all of its lengths are scaled by a power of two, its coordinates in render
    /// space are the same, bit for bit.
    pub fn new(size: f64, focus: DVec3, detail: f64) -> Self {
        let grid = power_of_two(detail);
        let is_near = focus.abs().max_element() <= NEAR * grid;
        Self {
            origin: if is_near {
                DVec3::ZERO
            } else {
                grid * (focus / grid).round()
            },
            unit: power_of_two(size),
        }
    }

    /// Returns true if its origin is world space's, where 32 bits are then precise enough too.
    pub fn is_centered(&self) -> bool {
        self.origin == DVec3::ZERO
    }

    /// Returns the number of world units per unit: a power of two.
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// Returns the map from world space.
    pub fn render_from_world(&self) -> DAffine3 {
        DAffine3::from_scale(DVec3::splat(1.0 / self.unit))
            * DAffine3::from_translation(-self.origin)
    }

    /// Converts a point from world space.
    pub fn point(&self, in_world: DVec3) -> Vec3 {
        ((in_world - self.origin) / self.unit).as_vec3()
    }

    /// Converts a length from world space.
    pub fn length(&self, in_world: f32) -> f32 {
        self.times_length(1, in_world)
    }

    /// Converts a number proportional to a power of a length from world space: -1 for an
    /// absorption, 2 for the intensity of a light that falls off with the square of the distance.
    pub fn times_length(&self, power: i32, in_world: f32) -> f32 {
        (f64::from(in_world) / self.unit.powi(power)) as f32
    }

    /// Returns the origin of world space, from which patterns repeat; for patterns with a period in
    /// world space, the nearest point that is a whole number of periods away from it.
    pub fn world_origin(&self, period: Option<f64>) -> Vec3 {
        let from_here = -self.origin;
        let nearest = match period {
            Some(period) => from_here - period * (from_here / period).round(),
            None => from_here,
        };
        (nearest / self.unit).as_vec3()
    }

    /// Converts a point to world space.
    pub fn world_point(&self, point: Vec3) -> DVec3 {
        self.origin + self.unit * point.as_dvec3()
    }

    /// Rounds the coordinates of a point in world space for people: to the digits of 32 bits, where
    /// these are precise enough.
    pub fn legible(&self, in_world: DVec3) -> [f64; 3] {
        let short = |x: f64| (x as f32).to_string().parse().unwrap_or(x);
        let numbers = in_world.to_array();
        if self.is_centered() {
            numbers.map(short)
        } else {
            numbers
        }
    }

    /// Converts a length to world space.
    pub fn world_length(&self, length: f32) -> f32 {
        (f64::from(length) * self.unit) as f32
    }
}

/// Returns the power of two next below a length, within the range of 32-bit numbers; 1 if the
/// length is not a positive number.
fn power_of_two(length: f64) -> f64 {
    if length > 0.0 && length.is_finite() {
        length.log2().floor().clamp(-100.0, 100.0).exp2()
    } else {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_near_the_origin_is_only_scaled() {
        let space = RenderSpace::new(10.0, DVec3::splat(3.0), 10.0);
        assert!(space.is_centered());
        assert_eq!(space.point(DVec3::splat(3.0)), Vec3::splat(0.375));
        assert_eq!(space.length(1.0), 0.125);
        assert_eq!(space.world_point(Vec3::splat(0.375)), DVec3::splat(3.0));
    }

    #[test]
    fn a_scene_far_away_is_moved_to_the_origin_and_back() {
        let far = DVec3::new(3e5, -4e6, 123.456);
        let space = RenderSpace::new(2.5, far, 2.5);
        let point = space.point(far + DVec3::splat(0.3));
        assert!(point.abs().max_element() < 2.0, "{point}");
        assert!(space.world_point(point).distance(far + DVec3::splat(0.3)) < 1e-6);
    }

    #[test]
    fn powers_of_two_change_no_bit() {
        let (focus, point) = (DVec3::new(1e6, 3.3, -7e5), DVec3::new(1e6 + 0.7, 4.1, -7e5));
        let [a, b] = [1.0, 2f64.powi(30)].map(|scale| {
            let space = RenderSpace::new(3.0 * scale, scale * focus, 0.7 * scale);
            space.point(scale * point)
        });
        assert_eq!(a, b);
    }
}
