//! The standard model: Blinn-Phong with shadows and reflected rays.
//!
//! Whitted, "An Improved Illumination Model for Shaded Display", CACM 23(6),
//! 1980. V points to the origin of the ray, shadow rays end at their lights, and
//! a point in shadow keeps its ambient light.

use glam::Vec3;

use super::blinn_phong::{Reflected, reflected};
use super::{LightSample, Shaded};
use crate::accel::ShadowRay;
use crate::geometry::Ray;
use crate::light::Illumination;
use crate::material::Material;
use crate::trace::SurfacePoint;

/// Returns `None` for a light behind the surface, which shadows itself.
pub(super) fn light_sample(light: Illumination, point: &SurfacePoint) -> Option<LightSample> {
    let may_reach = point.is_faced_by(light.direction) && light.radiance != Vec3::ZERO;
    may_reach.then(|| LightSample {
        light,
        shadow: ShadowRay {
            ray: Ray::leaving(point.position, point.geometric_normal, light.direction),
            t_max: light.distance,
            ignored: None,
        },
    })
}

pub(super) fn shade(
    material: &Material,
    ambient: Vec3,
    ray: &Ray,
    point: &SurfacePoint,
    lights: impl Iterator<Item = Illumination>,
) -> Shaded {
    let mut color = material.ambient * ambient * point.color;
    for light in lights {
        let Reflected { diffuse, highlight } =
            reflected(material, point.color, point.normal, &light, -ray.direction);
        color += (diffuse + highlight) * light.radiance;
    }
    let reflected = (material.reflection > 0.0).then(|| {
        let direction = point.mirrored(ray.direction);
        Ray::leaving(point.position, point.geometric_normal, direction)
    });
    Shaded { color, reflected }
}
