//! The standard model: Blinn and Phong's with shadows, and mirrored rays.
//!
//! Whitted, "An Improved Illumination Model for Shaded Display", CACM 23(6),
//! 1980. V points back along the ray, a shadow ends at its light, and a point
//! in the shadow keeps its ambient light.

use glam::Vec3;

use super::{Shaded, blinn_phong};
use crate::cost::Probe;
use crate::geometry::Ray;
use crate::scene::Scene;
use crate::trace::{SurfacePoint, Tracer};

pub(super) fn shade<P: Probe>(
    scene: &Scene,
    tracer: &Tracer,
    ray: &Ray,
    point: &SurfacePoint,
    probe: &mut P,
) -> Shaded {
    let material = scene.material(point.material);
    let base = material.color.color_at(point.position);
    let mut color = material.ambient * scene.shading.ambient * base;
    for light in &scene.lights {
        let light = light.illuminate(point.position);
        // A light behind the surface is in the surface's own shadow.
        if point.normal.dot(light.direction) <= 0.0 || light.radiance == Vec3::ZERO {
            continue;
        }
        let shadow = Ray::leaving(point.position, point.normal, light.direction);
        if !tracer.is_shadowed(&shadow, light.distance, None, probe) {
            color += blinn_phong::reflected(material, base, point.normal, &light, -ray.direction);
        }
    }
    let mirrored = (material.reflection > 0.0).then(|| {
        let direction = ray.direction.reflect(point.normal).normalize();
        let ray = Ray::leaving(point.position, point.normal, direction);
        (ray, material.reflection)
    });
    Shaded { color, mirrored }
}
