//! Spheres.

use std::f32::consts::PI;

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::located::{Described, Located, located};
use super::sampled::{Sampled, Seen, SurfaceSample, on_unit_sphere};
use super::sphere_equation::{SphereEquation, squared_length};
use super::surface::{parameters_of, vector};
use super::{Aabb, Intersectable, N_PARAMETERS, Patch, Project, Ray, RayTest, Transform};
use crate::values;
use math::simd::{Mask, Real, Vector, cos_sin};

/// The points at a distance from a center.
///
/// ```
/// # use raycost_world::geometry::{Located, Sphere};
/// let sphere: Located<Sphere> = scene::yaml::from_str("{ center: [0, 1, 3], radius: 1 }").unwrap();
/// # assert_eq!(sphere.geometry.radius, 1.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// The center.
    pub center: Vec3,
    /// The radius, greater than 0.
    pub radius: f32,
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SphereKeys {
    /// The center.
    #[serde(with = "values::Point")]
    center: DVec3,
    /// The radius, greater than 0.
    #[serde(with = "values::Positive")]
    radius: f32,
}

impl Described for Sphere {
    type Keys = SphereKeys;

    fn from_keys(SphereKeys { center, radius }: SphereKeys) -> Result<Located<Self>, &'static str> {
        Ok(located([center]).map(|[center]| Self { center, radius }))
    }
}

impl RayTest for Sphere {
    /// Intersects at the first root of the [`SphereEquation`].
    #[inline(always)]
    fn hits<R: Real>(parameters: &[R; N_PARAMETERS], origin: Vector<R>, direction: Vector<R>) -> R {
        let (to_center, radius) = (vector(parameters, 0) - origin, parameters[3]);
        let a = squared_length(direction);
        let equation = SphereEquation::new(to_center, radius * radius, direction, a);
        let hits = equation.hits();
        // Most single rays miss, and the roots take the most time.
        if hits.none() {
            return radius.splat(0.0);
        }
        R::select(hits, equation.first(), radius.splat(0.0))
    }
}

impl Intersectable for Sphere {
    #[inline]
    fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        self.first_hit(ray, t_max)
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

impl Sampled for Sphere {
    #[inline(always)]
    fn area<R: Real>(parameters: &[R; N_PARAMETERS]) -> R {
        area(parameters[3])
    }

    /// Samples the cone of directions that hit the sphere uniformly: Pharr, Jakob and Humphreys,
    /// "Physically Based Rendering", 4th edition, section 6.2.4. From inside, samples the surface
    /// uniformly.
    #[inline(always)]
    fn sample<R: Real>(
        parameters: &[R; N_PARAMETERS],
        from: Vector<R>,
        numbers: [R; 2],
    ) -> SurfaceSample<R> {
        let (center, radius) = (vector(parameters, 0), parameters[3]);
        let cone = DirectionCone::around(center, radius, from);
        let outside = cone.sample(radius, numbers);
        if cone.is_outside.all() {
            return outside;
        }
        let normal = on_unit_sphere(numbers);
        let inside = Seen::new(center + normal * radius, normal, from).by_area(area(radius));
        SurfaceSample {
            seen: Seen::select(cone.is_outside, outside.seen, inside.seen),
            density: R::select(cone.is_outside, outside.density, inside.density),
        }
    }

    #[inline(always)]
    fn density<R: Real>(parameters: &[R; N_PARAMETERS], from: Vector<R>, seen: &Seen<R>) -> R {
        let (center, radius) = (vector(parameters, 0), parameters[3]);
        let cone = DirectionCone::around(center, radius, from);
        let inside = seen.density_by_area(area(radius));
        R::select(cone.is_outside, cone.density(), inside)
    }
}

/// Returns the area of a sphere.
#[inline(always)]
fn area<R: Real>(radius: R) -> R {
    radius.splat(4.0 * PI) * radius * radius
}

/// The directions from a point to a sphere.
struct DirectionCone<R: Real> {
    /// The direction to the center.
    axis: Vector<R>,
    /// The distance of the center.
    distance: R,
    /// 1 minus the cosine of the cone's half angle.
    height: R,
    /// True if the point is outside of the sphere.
    is_outside: R::Mask,
}

impl<R: Real> DirectionCone<R> {
    #[inline(always)]
    fn around(center: Vector<R>, radius: R, from: Vector<R>) -> Self {
        let (zero, one) = (radius.splat(0.0), radius.splat(1.0));
        let to_center = center - from;
        let distance = to_center.length();
        let sine = radius / distance;
        let cos = (one - sine * sine).max(zero).sqrt();
        let up = Vector::splat(radius, Vec3::Z);
        Self {
            axis: to_center.normalize_or(up),
            distance,
            // Avoids cancellation for small spheres.
            height: sine * sine / (one + cos),
            is_outside: sine.lt(radius.splat(0.999_999)),
        }
    }

    #[inline(always)]
    fn density(&self) -> R {
        let one = self.height.splat(1.0);
        one / (self.height.splat(2.0 * PI) * self.height)
    }

    #[inline(always)]
    fn sample(&self, radius: R, [u, v]: [R; 2]) -> SurfaceSample<R> {
        let (zero, one, two) = (u.splat(0.0), u.splat(1.0), u.splat(2.0));
        let depth = u * self.height;
        let sin2 = depth * (two - depth);
        let (cos, sin) = (one - depth, sin2.sqrt());
        let [x, y] = cos_sin(v);
        let direction = self.axis.around([sin * x, sin * y, cos]).normalize();
        // The sine and cosine at the surface, in the triangle with the center.
        let sine_there = self.distance * sin / radius;
        let cos_there = (one - sine_there * sine_there).max(zero).sqrt();
        SurfaceSample {
            seen: Seen {
                direction,
                distance: self.distance * cos - radius * cos_there,
                cos: cos_there,
            },
            density: self.density(),
        }
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
