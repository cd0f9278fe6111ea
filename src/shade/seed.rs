//! The model of the course's NumPy code, kept for comparison with it.
//!
//! Its quirks: the ambient light is not coloured by the surface; V points to
//! the camera even after a bounce; a shadow ray skips the object that it
//! leaves and does not end at its light; a point in the shadow (of all lights,
//! where there are several) gives nothing, not even ambient light, and ends
//! the path; new rays start 1e-4 off the surface.

use glam::Vec3;

use super::{Shaded, blinn_phong};
use crate::cost::Probe;
use crate::geometry::Ray;
use crate::scene::Scene;
use crate::trace::{SurfacePoint, Tracer};

/// How far off the surface new rays start, in world units.
const OFFSET: f32 = 1e-4;

pub(super) fn shade<P: Probe>(
    scene: &Scene,
    tracer: &Tracer,
    camera_ray: &Ray,
    ray: &Ray,
    point: &SurfacePoint,
    probe: &mut P,
) -> Shaded {
    let material = scene.material(point.material);
    let base = material.color.color_at(point.position);
    let to_camera = (camera_ray.origin - point.position).normalize_or_zero();
    let origin = point.position + OFFSET * point.normal;
    let mut color = material.ambient * scene.shading.ambient;
    let mut is_lit = false;
    for light in &scene.lights {
        let light = light.illuminate(point.position);
        let shadow = Ray {
            origin,
            direction: light.direction,
        };
        if !tracer.is_shadowed(&shadow, f32::INFINITY, Some(point.object), probe) {
            is_lit = true;
            color += blinn_phong::reflected(material, base, point.normal, &light, to_camera);
        }
    }
    if !is_lit {
        return Shaded {
            color: Vec3::ZERO,
            mirrored: None,
        };
    }
    let mirrored = (material.reflection > 0.0).then(|| {
        let direction = ray.direction.reflect(point.normal).normalize();
        (Ray { origin, direction }, material.reflection)
    });
    Shaded { color, mirrored }
}
