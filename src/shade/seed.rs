//! The model of the course's NumPy code, kept for comparison with it.
//!
//! It differs from the standard model: only the highlight has the light's color,
//! and only the diffuse light the surface's; normals are not flipped toward the
//! ray; V points to the camera even after a bounce; a shadow ray ignores the
//! object that it leaves and does not end at its light; a point that no light
//! reaches is black, without ambient light, and ends the path; new rays start
//! 1e-4 off the surface, along its normal.

use glam::Vec3;

use super::blinn_phong::{Reflected, reflected};
use super::{LightSample, Shaded};
use crate::accel::ShadowRay;
use crate::geometry::Ray;
use crate::light::Illumination;
use crate::material::Material;
use crate::trace::SurfacePoint;

/// Distance of the origin of new rays from the surface, in world units.
const OFFSET: f32 = 1e-4;

pub(super) fn light_sample(light: Illumination, point: &SurfacePoint) -> LightSample {
    LightSample {
        light,
        shadow: ShadowRay {
            ray: leaving(point, light.direction),
            t_max: f32::INFINITY,
            ignored: Some(point.object),
        },
    }
}

pub(super) fn shade(
    material: &Material,
    ambient: Vec3,
    eye: Vec3,
    ray: &Ray,
    point: &SurfacePoint,
    lights: impl Iterator<Item = Illumination>,
) -> Shaded {
    let to_camera = (eye - point.position).normalize_or_zero();
    let normal = point.outward(point.normal);
    let mut color = material.ambient * ambient;
    let mut is_lit = false;
    for light in lights {
        is_lit = true;
        let Reflected { diffuse, highlight } =
            reflected(material, point.color, normal, &light, to_camera);
        color += diffuse + highlight * light.radiance;
    }
    if !is_lit {
        return Shaded {
            color: Vec3::ZERO,
            reflected: None,
        };
    }
    let reflected =
        (material.reflection > 0.0).then(|| leaving(point, point.mirrored(ray.direction)));
    Shaded { color, reflected }
}

fn leaving(point: &SurfacePoint, direction: Vec3) -> Ray {
    Ray {
        origin: point.position + OFFSET * point.outward(point.geometric_normal),
        direction,
    }
}
