//! Surface points → radiance and the next rays.
//!
//! This module traces no rays, so that rays traced one by one and rays in
//! streams share the same shading. [`Shader::light_samples`] returns the lights
//! that may reach a point with their shadow rays. Given the unoccluded ones,
//! [`Shader::shade`] adds the radiance of the point to the path and returns the
//! reflected ray that continues it. [`WaveShader`] does the same for many points at once.
//! Both use the formulas of the shading models, which are written once, for one point and
//! for lanes of points.

mod blinn_phong;
mod model;
mod seed;
mod standard;
mod path;
mod paths;
mod cast_shadows;
mod add_light;
mod end_paths;
mod wave;

use crate::accel::ShadowRay;
use crate::config::ShadingModel;
use crate::geometry::Ray;
use crate::light::{Illumination, Light};
use crate::scene::Scene;
use crate::simd::{Simd, Vector};
use crate::trace::SurfacePoint;
use model::Model;
use seed::Seed;
use standard::Standard;

pub use add_light::Eyes;
pub use cast_shadows::ShadowWave;
pub use path::Path;
pub use paths::PathWave;
pub use wave::WaveShader;

/// Shades the points that rays hit.
#[derive(Debug, Clone, Copy)]
pub struct Shader<'a> {
    scene: &'a Scene,
}

/// Light from one source that may reach a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightSample {
    /// The illumination if the shadow ray is unoccluded.
    pub light: Illumination<f32>,
    /// From the point to the light.
    pub shadow: ShadowRay,
}

impl<'a> Shader<'a> {
    /// Creates a shader of the scene.
    pub fn new(scene: &'a Scene) -> Self {
        Self { scene }
    }

    /// Creates a shader of waves, by this instruction set.
    pub fn of_waves(&self, simd: Simd) -> WaveShader<'a> {
        WaveShader::new(self.scene, simd)
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
        (0..).zip(&self.scene.lights).filter_map(|(index, light)| {
            let sample = match self.scene.shading.model {
                ShadingModel::BlinnPhong => light_sample(Standard, light, point),
                ShadingModel::Seed => light_sample(Seed, light, point),
            };
            Some((index, sample?))
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
        lights: impl Iterator<Item = Illumination<f32>>,
    ) -> Option<Ray> {
        match self.scene.shading.model {
            ShadingModel::BlinnPhong => self.shade_by(Standard, path, ray, point, lights),
            ShadingModel::Seed => self.shade_by(Seed, path, ray, point, lights),
        }
    }

    /// [`shade`](Self::shade) by a model.
    fn shade_by<M: Model>(
        &self,
        model: M,
        path: &mut Path,
        ray: &Ray,
        point: &SurfacePoint,
        lights: impl Iterator<Item = Illumination<f32>>,
    ) -> Option<Ray> {
        let material = self.scene.material(point.material);
        let (at, direction) = (point.shading(), ray.direction.into());
        let to_viewer = model.to_viewer(&at, path.eye.into(), direction);
        let mut color = model.ambient(material, self.scene.shading.ambient, at.color);
        let mut is_lit = !M::NEEDS_LIGHT;
        for light in lights {
            is_lit = true;
            color = color + model.reflected(material, &at, &light, to_viewer);
        }
        if !is_lit {
            return None;
        }
        path.add(color.into());
        if material.reflection == 0.0 || path.depth >= u32::from(self.scene.shading.max_depth) {
            return None;
        }
        path.bounce(material.reflection);
        let mirrored = at.mirrored(direction);
        Some(Ray {
            origin: model.origin(&at, mirrored).into(),
            direction: mirrored.into(),
        })
    }

    /// Adds the radiance of the background along the path's `ray`, which hit
    /// nothing.
    pub fn miss(&self, path: &mut Path, ray: &Ray) {
        let color = self.scene.background.color(Vector::from(ray.direction));
        path.add(color.into());
    }
}

/// The light from one source at a point; `None` if it cannot arrive.
fn light_sample<M: Model>(model: M, light: &Light, point: &SurfacePoint) -> Option<LightSample> {
    let at = point.shading();
    let light = light.illuminate(at.position);
    let direction = light.direction;
    model.may_arrive(&at, &light).then(|| LightSample {
        light,
        shadow: ShadowRay {
            ray: Ray {
                origin: model.origin(&at, direction).into(),
                direction: direction.into(),
            },
            t_max: model.end(&light),
            ignored: M::IGNORES_OWN_OBJECT.then_some(point.object),
        },
    })
}
