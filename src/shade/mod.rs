//! Surface points → radiance and the next rays.
//!
//! This module traces no rays, so that rays traced one by one and rays in
//! streams share the same shading. [`Shader::light_samples`] returns the lights
//! that may reach a point with their shadow rays. Given the unoccluded ones,
//! [`Shader::shade`] adds the radiance of the point to the path and returns the
//! reflected ray that continues it.

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

/// Shades the points that rays hit.
#[derive(Debug, Clone, Copy)]
pub struct Shader<'a> {
    scene: &'a Scene,
}

/// Light from one source that may reach a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightSample {
    /// The illumination if the shadow ray is unoccluded.
    pub light: Illumination,
    /// From the point to the light.
    pub shadow: ShadowRay,
}

/// The result of shading a point.
struct Shaded {
    /// The radiance that it reflects directly from lights.
    color: Vec3,
    /// The reflected ray; `None` ends the path.
    reflected: Option<Ray>,
}

impl<'a> Shader<'a> {
    /// Creates a shader of the scene.
    pub fn new(scene: &'a Scene) -> Self {
        Self { scene }
    }

    /// Returns the lights that may reach the point, in the order of the scene file.
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

    /// Adds the radiance of `point`, hit by the path's `ray`, to the path.
    /// `lights` are the unoccluded light samples of the point, in their order.
    /// Returns the ray that continues the path, or `None` at its end.
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
        let reflected = shaded.reflected?;
        let may_bounce = path.depth < u32::from(self.scene.shading.max_depth);
        may_bounce.then(|| {
            path.bounce(material.reflection);
            reflected
        })
    }

    /// Adds the radiance of the background along the path's `ray`, which hit
    /// nothing.
    pub fn miss(&self, path: &mut Path, ray: &Ray) {
        path.add(self.scene.background.color(ray.direction));
    }
}
