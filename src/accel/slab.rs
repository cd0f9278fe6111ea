//! The test of a ray against axis-aligned boxes.

use glam::Vec3;

use crate::geometry::{Aabb, Ray};

/// What a ray's tests against many boxes have in common.
///
/// The boxes grow by a margin that is larger than the rounding of any
/// primitive's own test, so that a box never hides a hit that brute force
/// finds: 1e-6 of the largest coordinate of the ray's origin and the boxes.
/// Growing costs nothing a box: it moves the origin, once for the lower planes
/// and once for the upper ones.
pub(super) struct Slabs {
    origin_lower: Vec3,
    origin_upper: Vec3,
    inverse_direction: Vec3,
}

impl Slabs {
    /// For tests against boxes inside `scene`.
    pub(super) fn new(ray: &Ray, scene: &Aabb) -> Self {
        let largest = scene.min.abs().max(scene.max.abs()).max(ray.origin.abs());
        let margin = 1e-6 * largest.max_element();
        Self {
            origin_lower: ray.origin + margin,
            origin_upper: ray.origin - margin,
            inverse_direction: ray.direction.recip(),
        }
    }

    /// Where the ray enters the box, at least 0; `None` if it misses the box
    /// or enters it beyond `t_max`.
    #[inline]
    pub(super) fn enter(&self, bounds: &Aabb, t_max: f32) -> Option<f32> {
        let lower = (bounds.min - self.origin_lower) * self.inverse_direction;
        let upper = (bounds.max - self.origin_upper) * self.inverse_direction;
        // f32's own min and max pass over the NaN of 0 * infinity, which only a
        // ray one margin outside the box has.
        let near = |axis: usize| lower[axis].min(upper[axis]);
        let far = |axis: usize| lower[axis].max(upper[axis]);
        let enter = near(0).max(near(1)).max(near(2)).max(0.0);
        let exit = far(0).min(far(1)).min(far(2)).min(t_max);
        (enter <= exit).then_some(enter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Aabb = Aabb {
        min: Vec3::ZERO,
        max: Vec3::ONE,
    };

    fn enter(origin: [f32; 3], direction: [f32; 3], t_max: f32) -> Option<f32> {
        let ray = Ray {
            origin: origin.into(),
            direction: direction.into(),
        };
        Slabs::new(&ray, &UNIT).enter(&UNIT, t_max)
    }

    #[test]
    fn rays_enter_hit_boxes_and_miss_others() {
        let t = enter([0.5, 0.5, -2.0], [0.0, 0.0, 1.0], 9.0).unwrap();
        assert!((t - 2.0).abs() < 1e-4);
        assert_eq!(enter([0.5, 0.5, 0.5], [0.0, -1.0, 0.0], 9.0), Some(0.0));
        assert_eq!(enter([0.5, 0.5, -2.0], [0.0, 0.0, 1.0], 1.5), None);
        assert_eq!(enter([0.5, 0.5, -2.0], [0.0, 0.0, -1.0], 9.0), None);
        assert_eq!(enter([1.5, 0.5, -2.0], [0.0, 0.0, 1.0], 9.0), None);
    }

    #[test]
    fn rays_in_a_face_enter_the_box() {
        for x in [0.0, 1.0] {
            assert!(enter([x, 0.5, -2.0], [0.0, 0.0, 1.0], 9.0).is_some());
            assert!(enter([x, 0.5, -2.0], [-0.0, 0.0, 1.0], 9.0).is_some());
        }
    }
}
