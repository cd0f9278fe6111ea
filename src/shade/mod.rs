//! Surface points → radiance and the next rays.
//!
//! This module traces no rays, so that rays traced one by one and rays in
//! streams share the same shading. [`Shader::light_samples`] returns the lights
//! that may reach a point with their shadow rays. Given the unoccluded ones,
//! [`Shader::shade`] returns the radiance that the point adds to its path, and the rays
//! that continue it: none, a reflected one, or, at the surface of a clear medium, a
//! reflected and a refracted one. [`WaveShader`] does the same for many points at once.
//! Both use the formulas of the shading models, which are written once, for one point and
//! for lanes of points.

mod blinn_phong;
mod fresnel;
mod media;
mod model;
mod seed;
mod standard;
mod path;
mod paths;
mod cast_shadows;
mod add_light;
mod end_paths;
mod wave;

use glam::Vec3;

use crate::accel::ShadowRay;
use crate::config::ShadingModel;
use crate::cost::RayKind;
use crate::geometry::Ray;
use crate::light::{Illumination, Light};
use crate::scene::Scene;
use crate::simd::{Simd, Vector};
use crate::trace::{ShadingPoint, SurfacePoint};
use fresnel::{mirrored_share, split_at};
use model::Model;
use seed::Seed;
use standard::Standard;

pub use add_light::Eyes;
pub use cast_shadows::ShadowWave;
pub use path::PathRay;
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
        let is_lit = self.scene.material(point.material).is_lit();
        let lights = if is_lit { &self.scene.lights[..] } else { &[] };
        (0..).zip(lights).filter_map(|(index, light)| {
            let sample = match self.scene.shading.model {
                ShadingModel::BlinnPhong => light_sample(Standard, light, point),
                ShadingModel::Seed => light_sample(Seed, light, point),
            };
            Some((index, sample?))
        })
    }

    /// Returns the radiance that `point`, hit by a ray of a path from `eye`, adds to the
    /// path; appends the rays that continue it to `next`. `lights` are the unoccluded
    /// light samples of the point, in their order.
    pub fn shade(
        &self,
        eye: Vec3,
        path: &PathRay,
        point: &SurfacePoint,
        lights: impl Iterator<Item = Illumination<f32>>,
        next: &mut Vec<PathRay>,
    ) -> Vec3 {
        match self.scene.shading.model {
            ShadingModel::BlinnPhong => self.shade_by(Standard, eye, path, point, lights, next),
            ShadingModel::Seed => self.shade_by(Seed, eye, path, point, lights, next),
        }
    }

    /// [`shade`](Self::shade) by a model.
    fn shade_by<M: Model>(
        &self,
        model: M,
        eye: Vec3,
        path: &PathRay,
        point: &SurfacePoint,
        lights: impl Iterator<Item = Illumination<f32>>,
        next: &mut Vec<PathRay>,
    ) -> Vec3 {
        let material = self.scene.material(point.material);
        let (at, direction) = (point.shading(), path.ray.direction.into());
        let to_viewer = model.to_viewer(&at, eye.into(), direction);
        let mut color = model.ambient(material, self.scene.shading.ambient, at.color);
        let mut is_lit = !M::NEEDS_LIGHT;
        for light in lights {
            is_lit = true;
            color = color + model.reflected(material, &at, &light, to_viewer);
        }
        if !is_lit {
            return Vec3::ZERO;
        }
        let arriving = self.weakened(path, point.distance);
        if path.depth < u32::from(self.scene.shading.max_depth) {
            self.continue_path(model, &arriving, point, next);
        }
        arriving.weight * Vec3::from(color)
    }

    /// The ray with the weight that is left after a distance.
    fn weakened(&self, path: &PathRay, distance: f32) -> PathRay {
        let transmittance = path.media.transmittance(distance, &self.scene.materials);
        PathRay {
            weight: path.weight * transmittance,
            ..*path
        }
    }

    /// Appends the rays that continue a path from a point.
    fn continue_path(
        &self,
        model: impl Model,
        path: &PathRay,
        point: &SurfacePoint,
        next: &mut Vec<PathRay>,
    ) {
        let material = self.scene.material(point.material);
        let (at, direction) = (point.shading(), Vector::from(path.ray.direction));
        let reflected = |share: Vec3| {
            let ray = departing(model, &at, at.mirrored(direction));
            path.continued(RayKind::Reflection, ray, share)
        };
        if material.dielectric.is_none() {
            if material.mirrors() {
                next.push(reflected(mirrored_share(material, &at, direction).into()));
            }
            return;
        }
        let media = path.media;
        let enters = !point.is_flipped;
        let interface = media.cross(point.material, enters, &self.scene.materials);
        let split = split_at(&at, direction, interface.eta, interface.is_visible);
        let refracted = PathRay {
            media: interface.behind,
            ..path.continued(
                RayKind::Refraction,
                departing(model, &at, split.refracted),
                Vec3::splat(1.0 - split.reflectance),
            )
        };
        let both = [reflected(Vec3::splat(split.reflectance)), refracted];
        next.extend(both.into_iter().filter(PathRay::has_weight));
    }

    /// Returns the radiance of the background that a ray which hit nothing adds to its
    /// path.
    pub fn miss(&self, path: &PathRay) -> Vec3 {
        let color = self.scene.background.color(path.ray.direction.into());
        self.weakened(path, f32::INFINITY).weight * Vec3::from(color)
    }
}

/// The ray that leaves a point in this direction.
fn departing(model: impl Model, at: &ShadingPoint<f32>, direction: Vector<f32>) -> Ray {
    Ray {
        origin: model.origin(at, direction).into(),
        direction: direction.into(),
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
