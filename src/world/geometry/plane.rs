//! Infinite planes.

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::located::{Described, Located, located};
use super::sampled::{Sampled, Seen, SurfaceSample};
use super::surface::{parameters_of, rounding_of, rounding_of_plane, vector};
use super::{Aabb, Intersectable, N_PARAMETERS, Patch, Project, Ray, RayTest, Transform};
use crate::values;
use math::simd::{Real, Vector};

/// Minimum |cos| of the angle between a ray and the normal: other rays miss the plane.
pub const MIN_COS: f32 = 1e-6;

/// The points of an infinite plane.
///
/// ```
/// # use raycost_world::geometry::{Located, Plane};
/// let floor: Located<Plane> = scene::yaml::from_str("{ point: [0, -0.5, 0], normal: [0, 1, 0] }").unwrap();
/// # assert_eq!(floor.geometry.normal.y, 1.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// One of its points.
    pub point: Vec3,
    /// The unit normal.
    pub normal: Vec3,
}

#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PlaneKeys {
    /// One of its points.
    #[serde(with = "values::Point")]
    point: DVec3,
    /// The normal.
    #[serde(with = "values::Direction")]
    normal: Vec3,
}

impl Described for Plane {
    type Keys = PlaneKeys;

    fn from_keys(PlaneKeys { point, normal }: PlaneKeys) -> Result<Located<Self>, &'static str> {
        Ok(located([point]).map(|[point]| Self { point, normal }))
    }
}

impl Plane {
    /// Returns [`hits`](RayTest::hits) of this plane with a ray per lane.
    #[inline(always)]
    pub fn hits_of_lanes<R: Real>(&self, origin: Vector<R>, direction: Vector<R>) -> R {
        let mut parameters = [origin.x.splat(0.0); N_PARAMETERS];
        for (lanes, number) in parameters.iter_mut().zip(self.parameters()) {
            *lanes = lanes.splat(number);
        }
        Self::hits(&parameters, origin, direction)
    }
}

impl RayTest for Plane {
    #[inline(always)]
    fn hits<R: Real>(parameters: &[R; N_PARAMETERS], origin: Vector<R>, direction: Vector<R>) -> R {
        let (point, normal) = (vector(parameters, 0), vector(parameters, 3));
        let cos = direction.dot(normal);
        let t = (point - origin).dot(normal) / cos;
        R::select(cos.splat(MIN_COS).le(cos.abs()), t, cos.splat(0.0))
    }
}

impl Intersectable for Plane {
    #[inline(always)]
    fn intersect(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        self.first_hit(ray, t_max)
    }

    fn bounds(&self) -> Aabb {
        Aabb::ALL
    }

    fn transformed(&self, transform: &Transform) -> Option<Self> {
        Some(Self {
            point: transform.world_point(self.point),
            normal: transform.world_normal(self.normal),
        })
    }

    fn patch(&self) -> Option<Patch> {
        None
    }
}

impl Project for Plane {
    #[inline(always)]
    fn parameters(&self) -> [f32; N_PARAMETERS] {
        parameters_of(&[self.point, self.normal])
    }

    #[inline(always)]
    fn project_onto<R: Real>(
        parameters: &[R; N_PARAMETERS],
        near: Vector<R>,
    ) -> (Vector<R>, Vector<R>) {
        let (point, normal) = (vector(parameters, 0), vector(parameters, 3));
        let above = (near - point).dot(normal);
        (near - normal * above, normal)
    }

    #[inline(always)]
    fn rounding<R: Real>(parameters: &[R; N_PARAMETERS], point: Vector<R>) -> R {
        let [x, y, z, ..] = *parameters;
        rounding_of(&[x, y, z, point.x, point.y, point.z])
    }

    #[inline(always)]
    fn rounding_along<R: Real>(parameters: &[R; N_PARAMETERS], at: [Vector<R>; 2]) -> R {
        rounding_of_plane(vector(parameters, 0), at)
    }
}

/// The area is infinite, so the surface is never sampled.
impl Sampled for Plane {
    #[inline(always)]
    fn area<R: Real>(parameters: &[R; N_PARAMETERS]) -> R {
        parameters[0].splat(f32::INFINITY)
    }

    #[inline(always)]
    fn sample<R: Real>(
        parameters: &[R; N_PARAMETERS],
        from: Vector<R>,
        [u, _]: [R; 2],
    ) -> SurfaceSample<R> {
        let (point, normal) = Self::project_onto(parameters, from);
        Seen::new(point, normal, from).by_area(u.splat(f32::INFINITY))
    }

    #[inline(always)]
    fn density<R: Real>(_: &[R; N_PARAMETERS], _: Vector<R>, seen: &Seen<R>) -> R {
        seen.cos.splat(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_hit_a_plane_from_both_sides_and_miss_it_along_it() {
        let floor = Plane {
            point: Vec3::new(7.0, -0.5, 3.0),
            normal: Vec3::Y,
        };
        let ray = |y: f32, direction| Ray {
            origin: Vec3::new(0.0, y, 0.0),
            direction,
        };
        assert_eq!(floor.intersect(&ray(1.0, -Vec3::Y), 9.0), Some(1.5));
        assert_eq!(floor.intersect(&ray(-2.0, Vec3::Y), 9.0), Some(1.5));
        assert_eq!(floor.intersect(&ray(1.0, Vec3::Y), 9.0), None);
        assert_eq!(floor.intersect(&ray(1.0, Vec3::X), 9.0), None);
    }
}
