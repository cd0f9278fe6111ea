//! The space in which rays are traced.

use glam::{DAffine3, DVec3, Vec3};

/// The map between world space and render space, in which a scene is of size one and near the
/// origin, so that the 24 digits of its coordinates go as far as they can: a translation and
/// a power of two. All arithmetic of 32 bits happens there.
///
/// The `renderFromWorld` of Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th
/// edition, section 5.1, which scales nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderSpace {
    /// The point of world space that is its origin.
    origin: DVec3,
    /// World units in its unit: a power of two.
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

/// The distance of the world's origin, in sizes of what is seen, up to which it stays the
/// origin, so that coordinates that are short in decimals stay exact.
const NEAR: f64 = 16.0;

impl RenderSpace {
    /// The space of a scene of a size whose digits matter most at the point `focus`, within a
    /// length `detail` around it. Lengths that are not positive numbers count as 1.
    ///
    /// A scene that is scaled by a power of two, with all else that has a length, has the same
    /// coordinates there, bit for bit.
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

    /// Whether its origin is that of world space: 32 bits then have digits enough there, too.
    pub fn is_centered(&self) -> bool {
        self.origin == DVec3::ZERO
    }

    /// World units in its unit: a power of two.
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// The map from world space.
    pub fn render_from_world(&self) -> DAffine3 {
        DAffine3::from_scale(DVec3::splat(1.0 / self.unit))
            * DAffine3::from_translation(-self.origin)
    }

    /// A point of world space.
    pub fn point(&self, in_world: DVec3) -> Vec3 {
        ((in_world - self.origin) / self.unit).as_vec3()
    }

    /// A length of world space.
    pub fn length(&self, in_world: f32) -> f32 {
        self.times_length(1, in_world)
    }

    /// A number of world space that is multiplied by a power of a length: -1 for an absorption,
    /// 2 for the intensity of a light that falls off with the square of the distance.
    pub fn times_length(&self, power: i32, in_world: f32) -> f32 {
        (f64::from(in_world) / self.unit.powi(power)) as f32
    }

    /// The origin of world space, which patterns repeat from: where one has a period in world
    /// space, the nearest point that a number of whole periods separates from it.
    pub fn world_origin(&self, period: Option<f64>) -> Vec3 {
        let from_here = -self.origin;
        let nearest = match period {
            Some(period) => from_here - period * (from_here / period).round(),
            None => from_here,
        };
        (nearest / self.unit).as_vec3()
    }

    /// The point of world space that is a point of this one.
    pub fn world_point(&self, point: Vec3) -> DVec3 {
        self.origin + self.unit * point.as_dvec3()
    }

    /// The coordinates of a point of world space for people: with the digits that 32 bits have
    /// where these have enough.
    pub fn legible(&self, in_world: DVec3) -> [f64; 3] {
        let short = |x: f64| (x as f32).to_string().parse().unwrap_or(x);
        let numbers = in_world.to_array();
        if self.is_centered() {
            numbers.map(short)
        } else {
            numbers
        }
    }

    /// The length in world space of a length in this one.
    pub fn world_length(&self, length: f32) -> f32 {
        (f64::from(length) * self.unit) as f32
    }
}

/// The power of two next below a length, within the range of numbers of 32 bits; 1 for what
/// is not a positive number.
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
