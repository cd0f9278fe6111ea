//! Spheres.

use glam::Vec3;
use serde::Deserialize;

use super::surface::{parameters_of, vector};
use super::{Aabb, Intersectable, N_PARAMETERS, Patch, Project, Ray, Transform};
use crate::simd::{Real, Vector};
use crate::yaml;

/// The points at a distance from a center.
///
/// ```
/// # use raycost::geometry::Sphere;
/// let sphere: Sphere = raycost::yaml::from_str("{ center: [0, 1, 3], radius: 1 }").unwrap();
/// # assert_eq!(sphere.radius, 1.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sphere {
    /// The center.
    #[serde(deserialize_with = "yaml::point")]
    pub center: Vec3,
    /// The radius, greater than 0.
    #[serde(deserialize_with = "yaml::positive")]
    pub radius: f32,
}

impl Intersectable for Sphere {
    /// Haines, Günther and Akenine-Möller, "Precision Improvements for
    /// Ray/Sphere Intersection", Ray Tracing Gems (2019), chapter 7: the
    /// discriminant is computed from the point of the ray nearest to the center,
    /// which avoids cancellation for small and distant spheres.
    #[inline]
    fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        let (c, d) = (self.center - ray.origin, ray.direction);
        let a = d.dot(d);
        let inverse_a = a.recip();
        let b = c.dot(d);
        let r2 = self.radius * self.radius;
        let nearest = c - d * (b * inverse_a);
        let discriminant = r2 - nearest.dot(nearest);
        if discriminant < 0.0 {
            return None;
        }
        let q = b + (a * discriminant).sqrt().copysign(b);
        let (t0, t1) = ((c.dot(c) - r2) / q, q * inverse_a);
        let (near, far) = if t0 < t1 { (t0, t1) } else { (t1, t0) };
        let t = if near > 0.0 { near } else { far };
        (t > 0.0 && t < t_max).then_some(t)
    }

    fn bounds(&self) -> Aabb {
        Aabb {
            min: self.center - self.radius,
            max: self.center + self.radius,
        }
    }

    fn transformed(&self, transform: &Transform) -> Option<Self> {
        Some(Self {
            center: transform.world_point(self.center),
            radius: self.radius * transform.uniform_scale()?,
        })
    }

    fn patch(&self) -> Option<Patch> {
        Some(Patch::Ball {
            center: self.center,
            radius: self.radius,
        })
    }
}

impl Project for Sphere {
    #[inline(always)]
    fn parameters(&self) -> [f32; N_PARAMETERS] {
        let mut parameters = parameters_of(&[self.center]);
        parameters[3] = self.radius;
        parameters
    }

    #[inline(always)]
    fn project_onto<R: Real>(
        parameters: &[R; N_PARAMETERS],
        near: Vector<R>,
    ) -> (Vector<R>, Vector<R>) {
        let (center, radius) = (vector(parameters, 0), parameters[3]);
        let up = Vector::splat(radius, Vec3::Y);
        let normal = (near - center).normalize_or(up);
        (center + normal * radius, normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPHERE: Sphere = Sphere {
        center: Vec3::new(0.0, 0.0, 3.0),
        radius: 1.0,
    };

    fn along_z(z: f32, direction: f32) -> Ray {
        Ray {
            origin: Vec3::new(0.0, 0.0, z),
            direction: Vec3::Z * direction,
        }
    }

    #[test]
    fn a_ray_hits_the_near_side_from_outside_and_the_far_side_from_inside() {
        assert_eq!(SPHERE.intersect(&along_z(0.0, 1.0), 10.0), Some(2.0));
        assert_eq!(SPHERE.intersect(&along_z(3.0, 1.0), 10.0), Some(1.0));
        assert_eq!(SPHERE.intersect(&along_z(5.0, 1.0), 10.0), None);
        assert_eq!(SPHERE.intersect(&along_z(0.0, 1.0), 1.5), None);
    }

    #[test]
    fn t_is_in_units_of_the_direction() {
        assert_eq!(SPHERE.intersect(&along_z(0.0, 4.0), 10.0), Some(0.5));
    }

    #[test]
    fn the_hit_on_a_small_distant_sphere_is_accurate() {
        let small = Sphere {
            center: Vec3::new(0.0, 0.0, 4000.0),
            radius: 0.5,
        };
        let t = small.intersect(&along_z(0.0, 1.0), f32::INFINITY);
        assert!((t.unwrap() - 3999.5).abs() < 1e-3);
    }
}
