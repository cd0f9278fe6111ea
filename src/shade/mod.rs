//! Surface points → colour and the ray to follow next.
//!
//! Both models shade a point to its own light and at most one mirrored ray, so
//! that a path is a loop: colour += weight * own light, weight *= reflection.

mod blinn_phong;
mod seed;
mod standard;

use glam::Vec3;

use crate::config::ShadingModel;
use crate::cost::{Probe, RayKind};
use crate::geometry::Ray;
use crate::scene::Scene;
use crate::trace::{SurfacePoint, Tracer};

/// Colours what rays meet.
#[derive(Debug, Clone, Copy)]
pub struct Shader<'a> {
    scene: &'a Scene,
    tracer: Tracer<'a>,
}

/// What one point of a path gives.
struct Shaded {
    /// Its own light.
    color: Vec3,
    /// The ray to follow and the share of its light; none ends the path.
    mirrored: Option<(Ray, f32)>,
}

impl<'a> Shader<'a> {
    /// Colours the scene that `tracer` follows rays through.
    pub fn new(scene: &'a Scene, tracer: Tracer<'a>) -> Self {
        Self { scene, tracer }
    }

    /// The light that comes along a camera ray, given what the ray met; each
    /// channel at least 0, not yet limited to 1.
    pub fn radiance<P: Probe>(
        &self,
        camera_ray: &Ray,
        first: Option<&SurfacePoint>,
        probe: &mut P,
    ) -> Vec3 {
        let mut color = Vec3::ZERO;
        let mut weight = 1.0;
        let mut ray = *camera_ray;
        let mut met = first.copied();
        for depth in 1.. {
            let Some(point) = met else {
                color += weight * self.scene.background.color(ray.direction);
                break;
            };
            let shaded = self.shade(camera_ray, &ray, &point, probe);
            color += weight * shaded.color;
            let Some((mirrored, share)) = shaded.mirrored else {
                break;
            };
            if depth > u32::from(self.scene.shading.max_depth) {
                break;
            }
            probe.bounce(depth);
            met = self.tracer.trace(&mirrored, RayKind::Reflection, probe);
            ray = mirrored;
            weight *= share;
        }
        color
    }

    fn shade<P: Probe>(
        &self,
        camera_ray: &Ray,
        ray: &Ray,
        point: &SurfacePoint,
        probe: &mut P,
    ) -> Shaded {
        match self.scene.shading.model {
            ShadingModel::BlinnPhong => {
                standard::shade(self.scene, &self.tracer, ray, point, probe)
            }
            ShadingModel::Seed => {
                seed::shade(self.scene, &self.tracer, camera_ray, ray, point, probe)
            }
        }
    }
}
