//! Flat disks.

use std::f32::consts::PI;

use glam::{DVec3, Vec3, Vec3Swizzles};
use serde::{Deserialize, Serialize};

use super::located::{Described, Located, located};
use super::sampled::{Sampled, Seen, SurfaceSample};
use super::surface::{parameters_of, vector};
use super::{Aabb, Intersectable, N_PARAMETERS, Patch, Plane, Project, Ray, RayTest, Transform};
use crate::values;
use math::sampling::disk;
use math::simd::{Real, Vector};

/// The points of a plane within a distance of a center.
///
/// ```
/// # use raycost_world::geometry::{Located, Disk};
/// let disk: Located<Disk> = scene::yaml::from_str("
/// { center: [0, 0, 2], normal: [0, 1, -1], radius: 0.5 }
/// ").unwrap();
/// # assert_eq!(disk.geometry.radius, 0.5);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disk {
    /// The center.
    pub center: Vec3,
    /// The unit normal.
    pub normal: Vec3,
    /// The radius, greater than 0.
    pub radius: f32,
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct DiskKeys {
    /// The center.
    #[serde(with = "values::Point")]
    center: DVec3,
    /// The normal.
    #[serde(with = "values::Direction")]
    normal: Vec3,
    /// The radius, greater than 0.
    #[serde(with = "values::Positive")]
    radius: f32,
}

impl Described for Disk {
    type Keys = DiskKeys;

    fn from_keys(keys: DiskKeys) -> Result<Located<Self>, &'static str> {
        let DiskKeys {
            center,
            normal,
            radius,
        } = keys;
        Ok(located([center]).map(|[center]| Self {
            center,
            normal,
            radius,
        }))
    }
}

impl RayTest for Disk {
    #[inline(always)]
    fn hits<R: Real>(parameters: &[R; N_PARAMETERS], origin: Vector<R>, direction: Vector<R>) -> R {
        let t = Plane::hits(parameters, origin, direction);
        let from_center = (origin + direction * t) - vector(parameters, 0);
        let radius = parameters[6];
        let hits = from_center.dot(from_center).le(radius * radius);
        R::select(hits, t, t.splat(0.0))
    }
}

/// Returns the extent along each axis of a unit circle with this unit normal: the sine of the angle
/// between the axis and the normal.
pub(super) fn circle_extent(normal: Vec3) -> Vec3 {
    let squared = normal * normal;
    (squared.yzx() + squared.zxy()).map(f32::sqrt)
}

impl Intersectable for Disk {
    #[inline]
    fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        self.first_hit(ray, t_max)
    }

    fn bounds(&self) -> Aabb {
        let extent = self.radius * circle_extent(self.normal);
        Aabb {
            min: self.center - extent,
            max: self.center + extent,
        }
    }

    fn transformed(&self, transform: &Transform) -> Option<Self> {
        Some(Self {
            center: transform.world_point(self.center),
            normal: transform.world_normal(self.normal),
            radius: self.radius * transform.uniform_scale()?,
        })
    }

    fn patch(&self) -> Option<Patch> {
        Some(Patch::disk(self.center, self.normal, self.radius))
    }
}

impl Project for Disk {
    #[inline(always)]
    fn parameters(&self) -> [f32; N_PARAMETERS] {
        let mut parameters = parameters_of(&[self.center, self.normal]);
        parameters[6] = self.radius;
        parameters
    }

    #[inline(always)]
    fn project_onto<R: Real>(
        parameters: &[R; N_PARAMETERS],
        near: Vector<R>,
    ) -> (Vector<R>, Vector<R>) {
        Plane::project_onto(parameters, near)
    }

    #[inline(always)]
    fn rounding<R: Real>(parameters: &[R; N_PARAMETERS], point: Vector<R>) -> R {
        Plane::rounding(parameters, point)
    }

    #[inline(always)]
    fn rounding_along<R: Real>(parameters: &[R; N_PARAMETERS], at: [Vector<R>; 2]) -> R {
        Plane::rounding_along(parameters, at)
    }
}

impl Sampled for Disk {
    #[inline(always)]
    fn area<R: Real>(parameters: &[R; N_PARAMETERS]) -> R {
        area(parameters[6])
    }

    #[inline(always)]
    fn sample<R: Real>(
        parameters: &[R; N_PARAMETERS],
        from: Vector<R>,
        numbers: [R; 2],
    ) -> SurfaceSample<R> {
        let (center, normal) = (vector(parameters, 0), vector(parameters, 3));
        let radius = parameters[6];
        let [x, y] = disk(numbers);
        let [u, v] = normal.orthonormal_pair();
        let point = center + u * (radius * x) + v * (radius * y);
        Seen::new(point, normal, from).by_area(area(radius))
    }
}

#[inline(always)]
fn area<R: Real>(radius: R) -> R {
    radius.splat(PI) * radius * radius
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_of_a_disk_that_hardly_slopes_has_its_height() {
        let [slope, radius] = [1e-4, 2.0];
        let (center, normal) = (Vec3::ZERO, Vec3::new(slope, 1.0, 0.0));
        let bounds = Disk {
            center,
            normal,
            radius,
        }
        .bounds();
        assert_eq!(bounds.max, Vec3::new(radius, slope * radius, radius));
    }

    #[test]
    fn a_disk_ends_at_its_radius() {
        let disk = Disk {
            center: Vec3::Z,
            normal: Vec3::Z,
            radius: 0.5,
        };
        let at_x = |x: f32| Ray {
            origin: Vec3::new(x, 0.0, 0.0),
            direction: Vec3::Z,
        };
        assert_eq!(disk.intersect(&at_x(0.49), 9.0), Some(1.0));
        assert_eq!(disk.intersect(&at_x(0.51), 9.0), None);
        assert_eq!(disk.bounds().max, Vec3::new(0.5, 0.5, 1.0));
    }
}
