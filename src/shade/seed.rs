//! The model of the course's NumPy code, kept for comparison with it.
//!
//! Its quirks: the light's color is in the highlight alone, the surface's in
//! the diffuse light alone; normals are those of planes and spheres as given,
//! also where the ray comes from the other side; V points to the camera even
//! after a bounce; a shadow ray skips the object that it leaves and does not
//! end at its light; a point in the shadow (of all lights, where there are
//! several) gives nothing, not even ambient light, and ends the path; new rays
//! start 1e-4 off the surface, along its normal.

use glam::Vec3;

use super::blinn_phong::{Reflected, reflected};
use super::{LightSample, Shaded};
use crate::accel::ShadowRay;
use crate::geometry::Ray;
use crate::light::Illumination;
use crate::material::Material;
use crate::trace::SurfacePoint;

/// How far off the surface new rays start, in world units.
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
            mirrored: None,
        };
    }
    let mirrored =
        (material.reflection > 0.0).then(|| leaving(point, point.mirrored(ray.direction)));
    Shaded { color, mirrored }
}

fn leaving(point: &SurfacePoint, direction: Vec3) -> Ray {
    Ray {
        origin: point.position + OFFSET * point.outward(point.geometric_normal),
        direction,
    }
}
