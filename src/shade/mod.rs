//! Surface points → colour and the rays to follow next.
//!
//! Nothing here traces a ray, so that the same shading serves rays that are
//! traced one by one and rays in streams. A point tells which lights may reach
//! it, and the shadow ray of each ([`Shader::light_samples`]); given those that
//! do, it gives its light to the path and the mirrored ray that the path goes
//! on with ([`Shader::shade`]).

mod blinn_phong;
mod path;
mod seed;
mod standard;

use glam::Vec3;

use crate::accel::ShadowRay;
use crate::config::ShadingModel;
use crate::geometry::Ray;
use crate::light::Illumination;
use crate::scene::Scene;
use crate::trace::SurfacePoint;

pub use path::Path;

/// Colours what rays meet.
#[derive(Debug, Clone, Copy)]
pub struct Shader<'a> {
    scene: &'a Scene,
}

/// Light from one source, if it reaches the point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightSample {
    /// What arrives unless something is in the shadow ray's way.
    pub light: Illumination,
    /// From the point to the light.
    pub shadow: ShadowRay,
}

/// What one point of a path gives.
struct Shaded {
    /// Its own light.
    color: Vec3,
    /// The mirrored ray; none ends the path.
    mirrored: Option<Ray>,
}

impl<'a> Shader<'a> {
    /// Colours this scene.
    pub fn new(scene: &'a Scene) -> Self {
        Self { scene }
    }

    /// The lights that may reach the point, in the order of the scene file.
    pub fn light_samples(&self, point: &SurfacePoint) -> impl Iterator<Item = LightSample> {
        self.indexed_light_samples(point).map(|(_, sample)| sample)
    }

    /// [`light_samples`](Self::light_samples) with the indices of the lights in the
    /// scene file.
    pub fn indexed_light_samples(
        &self,
        point: &SurfacePoint,
    ) -> impl Iterator<Item = (u32, LightSample)> {
        let model = self.scene.shading.model;
        (0..)
            .zip(&self.scene.lights)
            .filter_map(move |(index, light)| {
                let light = light.illuminate(point.position);
                let sample = match model {
                    ShadingModel::BlinnPhong => standard::light_sample(light, point)?,
                    ShadingModel::Seed => seed::light_sample(light, point),
                };
                Some((index, sample))
            })
    }

    /// Adds the light of the point that the path's `ray` met, lit by those of
    /// its light samples that reach it, in their order; gives the ray that the
    /// path goes on with, if it does.
    pub fn shade(
        &self,
        path: &mut Path,
        ray: &Ray,
        point: &SurfacePoint,
        lights: impl Iterator<Item = Illumination>,
    ) -> Option<Ray> {
        let material = self.scene.material(point.material);
        let ambient = self.scene.shading.ambient;
        let shaded = match self.scene.shading.model {
            ShadingModel::BlinnPhong => standard::shade(material, ambient, ray, point, lights),
            ShadingModel::Seed => seed::shade(material, ambient, path.eye, ray, point, lights),
        };
        path.add(shaded.color);
        let mirrored = shaded.mirrored?;
        let may_bounce = path.depth < u32::from(self.scene.shading.max_depth);
        may_bounce.then(|| {
            path.bounce(material.reflection);
            mirrored
        })
    }

    /// Adds the light that comes along the path's `ray`, which met nothing.
    pub fn miss(&self, path: &mut Path, ray: &Ray) {
        path.add(self.scene.background.color(ray.direction));
    }
}
