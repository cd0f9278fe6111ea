//! Surface points → radiance and the next rays.
//!
//! This module traces no rays, so that rays traced one by one and rays in streams share the same
//! shading. [`Shader::light_samples`] returns the lights that may reach a point with their shadow
//! rays. Given the unoccluded ones, [`Shader::shade`] returns the radiance that the point adds to
//! its path, and the rays that continue it: none, a reflected one, or, at the surface of a clear
//! medium, a reflected and a refracted one. [`WaveShader`] does the same for many points at once.
//! Both use the formulas of the shading models, which are written once, for one point and for lanes
//! of points.

mod blinn_phong;
mod fresnel;
mod media;
mod eye_media;
mod path;
mod paths;
mod numbers;
mod model;
mod bsdf;
mod seed;
mod standard;
mod path_tracing;
mod occlusion;
mod models;
mod emission;
mod interfaces;
mod arriving_light;
mod cast_shadows;
mod add_light;
mod end_paths;
mod fog;
mod scatter;
mod wave;
mod surface_data;
mod formulas;

use glam::Vec3;

use crate::accel::ShadowRay;
use crate::trace::SurfacePoint;
use math::sampling::{Dimension, Sampler};
use math::simd::{Simd, Vector};
use media::{Interface, Media};
use scatter::scattered_kind;
use world::camera::RayCone;
use world::geometry::Ray;
use world::light::Illumination;
use world::material::Material;
use world::scene::Scene;

pub use add_light::Eyes;
pub use cast_shadows::ShadowWave;
pub use eye_media::EyeMedia;
pub use formulas::{
    Crossing, NextRay, PassageFormula, PathFormulas, PathRules, ShadowFormula, SurfaceKind,
    SurfaceRules,
};
pub use numbers::{SampleId, SampleIds};
pub use path::PathRay;
pub use paths::PathWave;
pub use wave::{PathStarts, WaveShader};

/// Shades the points that rays hit.
#[derive(Debug, Clone, Copy)]
pub struct Shader<'a> {
    scene: &'a Scene,
    formulas: PathFormulas<'a>,
    rules: PathRules,
}

/// Light from one source that may reach a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightSample {
    /// The illumination if the shadow ray is unoccluded.
    pub light: Illumination<f32>,
    /// Index of the light: lights of the scene file come first, then surfaces that emit light.
    pub index: u32,
    /// The ray from the point to the light.
    pub shadow: ShadowRay,
}

impl<'a> Shader<'a> {
    /// Creates a shader of the scene, whose samples have these numbers.
    pub fn new(scene: &'a Scene, sampler: Sampler) -> Self {
        let formulas = PathFormulas::new(scene, sampler);
        Self {
            scene,
            rules: formulas.rules(),
            formulas,
        }
    }

    /// Returns the formulas that follow the paths of this shader, whose camera rays have this
    /// footprint.
    pub fn formulas(&self, cone: Option<RayCone>) -> PathFormulas<'a> {
        self.formulas.with_cone(cone)
    }

    /// Creates a shader of waves for this instruction set.
    pub fn wave_shader(&self, simd: Simd) -> WaveShader<'a> {
        WaveShader::new(self.scene, self.formulas.sampler, simd)
    }

    /// Returns true if shadow rays decide which lights reach a point.
    pub fn casts_shadows(&self) -> bool {
        self.scene.shading.shadows
    }

    /// Returns the lights that may reach the point, hit by a ray of a path, in the order of the
    /// scene file.
    pub fn light_samples(
        &self,
        path: &PathRay,
        point: &SurfacePoint,
    ) -> impl Iterator<Item = LightSample> {
        (0..self.n_light_samples(path, point))
            .filter_map(move |i| self.light_sample(i, path, point))
    }

    /// Returns the number of light samples at a point.
    fn n_light_samples(&self, path: &PathRay, point: &SurfacePoint) -> usize {
        let (rules, material) = (&self.rules, self.material(point));
        let is_lit = self.formulas.surface(material).is_lit;
        let scatters = self.formulas.scatters(material, &point.shading());
        if is_lit && scatters && (rules.lights_last_points || path.depth < rules.max_depth) {
            rules.n_lights
        } else {
            0
        }
    }

    /// Returns light sample `i` at a point, or `None` if it cannot arrive.
    fn light_sample(&self, i: usize, path: &PathRay, point: &SurfacePoint) -> Option<LightSample> {
        let at = point.shading();
        // Sample the light, and weaken it by the media on the way.
        let (light, index) = self.formulas.light(i, &at, self.numbers(path));
        let light = self.weakened_by_media(light, path, point);
        // Cast a shadow ray if the light may arrive.
        let shadow = self.formulas.shadow(self.material(point), &at, &light);
        shadow.may_arrive.then(|| LightSample {
            light,
            index: index as u32,
            shadow: ShadowRay {
                ray: Ray {
                    origin: shadow.origin.into(),
                    direction: light.direction.into(),
                },
                t_max: shadow.end,
                ignored: (self.rules.ignores_own_object).then_some(point.object),
            },
        })
    }

    fn material(&self, point: &SurfacePoint) -> &'a Material {
        self.scene.material(point.material)
    }

    /// Returns the light of a sample weakened by the media between it and the point that a ray
    /// hits.
    fn weakened_by_media(
        &self,
        light: Illumination<f32>,
        path: &PathRay,
        point: &SurfacePoint,
    ) -> Illumination<f32> {
        if !self.scene.weakens_lights() {
            return light;
        }
        let is_behind = point.shading().is_backed_by(light.direction);
        let crossed = is_behind.then(|| self.interface(path, point)).flatten();
        let media = crossed.map_or(path.media, |interface| interface.behind);
        let left = media.transmittance(light.distance, &self.scene.materials);
        Illumination {
            radiance: light.radiance.times(left.into()),
            ..light
        }
    }

    /// Returns the numbers of a path's pixel and sample, and of the first dimension of the point that
    /// its ray hits.
    fn numbers(&self, path: &PathRay) -> [u32; 3] {
        let Dimension(dimension) = Dimension::after_bounces(path.depth, 0);
        [path.id.pixel, path.id.sample, dimension]
    }

    /// Returns the radiance that `point`, hit by a ray of a path from `eye`, adds to the path;
    /// appends the rays that continue it to `next`. `lights` are the unoccluded light samples of
    /// the point, in their order.
    pub fn shade(
        &self,
        eye: Vec3,
        path: &PathRay,
        point: &SurfacePoint,
        lights: impl Iterator<Item = Illumination<f32>>,
        next: &mut Vec<PathRay>,
    ) -> Vec3 {
        let (at, direction) = (point.shading(), path.ray.direction.into());
        // Ambient and emitted light.
        let class = self.scene.class(point.primitive);
        let ray = [path.ray.origin.into(), direction];
        let hit = [point.distance, path.density];
        let parameters = || self.scene.parameters(point.placed());
        let mut color = self.formulas.own_light(class, &at, ray, hit, parameters);
        // The light samples that arrive.
        let (crossing, behind) = self.crossing(path, point);
        let (material, rays) = (self.material(point), [eye.into(), direction]);
        let mut is_lit = !self.rules.needs_light;
        for light in lights {
            is_lit = true;
            let formulas = &self.formulas;
            color = color + formulas.reflected(material, &at, &light, rays, &crossing);
        }
        if !is_lit {
            return Vec3::ZERO;
        }
        // The light that is left at the viewer, and the rays that continue the path.
        let (arriving, gained) = self.weakened(path, point.distance);
        let rays = self.next_rays(&arriving, point, &crossing);
        next.extend(rays.into_iter().flatten().map(|ray| PathRay {
            ray: Ray {
                origin: ray.origin.into(),
                direction: ray.direction.into(),
            },
            kind: scattered_kind(ray.is_refracted, ray.is_diffuse),
            depth: path.depth + 1,
            weight: ray.weight.into(),
            media: if ray.is_refracted { behind } else { path.media },
            density: ray.density,
            ..arriving
        }));
        let weight = Vector::from(arriving.weight) * point.opacity;
        Vec3::from(color.times(weight)) + gained
    }

    /// Returns the rays that continue a path from a point.
    fn next_rays(
        &self,
        path: &PathRay,
        point: &SurfacePoint,
        crossing: &Crossing<f32>,
    ) -> [Option<NextRay<f32>>; 2] {
        let (material, at) = (self.material(point), point.shading());
        let of_path = [path.ray.direction, path.weight].map(Vector::from);
        let surface = self.formulas.surface(material);
        let may_bounce = surface.continues && path.depth < self.rules.max_depth;
        let alive = |ray: NextRay<f32>| ray.is_alive.then_some(ray);
        if self.rules.splits {
            let opacity = point.opacity;
            let [reflected, other] = self
                .formulas
                .split(material, &at, of_path, opacity, crossing);
            let reflected = Some(reflected).filter(|_| may_bounce);
            let other = Some(other).filter(|_| may_bounce || surface.is_veil);
            return [reflected, other].map(|ray| ray.and_then(alive));
        }
        if !may_bounce {
            return [None, None];
        }
        let is_late = path.depth >= self.rules.late_depth;
        let numbers = self.numbers(path);
        let ray = (self.formulas).next(material, &at, of_path, numbers, crossing, is_late);
        [alive(ray), None]
    }

    /// Returns the surface of a medium that a ray has met at a point, or `None` for other surfaces.
    fn interface(&self, path: &PathRay, point: &SurfacePoint) -> Option<Interface> {
        let (all, enters) = (&self.scene.materials, !point.is_flipped);
        let material = self.scene.material(point.material);
        let is_medium = material.kind.medium().is_some();
        is_medium.then(|| path.media.cross(point.material, enters, all))
    }

    /// Returns the surface that a ray has met at a point, as the media on both sides make it, and the
    /// media behind it.
    fn crossing(&self, path: &PathRay, point: &SurfacePoint) -> (Crossing<f32>, Media) {
        let index = |media: &Media| media.index(&self.scene.materials);
        let here = index(&path.media);
        let Some(interface) = self.interface(path, point) else {
            let crossing = Crossing {
                eta: 1.0,
                is_visible: false,
                indices: [here; 2],
            };
            return (crossing, path.media);
        };
        let crossing = Crossing {
            eta: interface.eta,
            is_visible: interface.is_visible,
            indices: [here, index(&interface.behind)],
        };
        (crossing, interface.behind)
    }

    /// Attenuates `path` over `distance` and adds `distance` to its length. Returns it with the
    /// light that it gains on the way.
    fn weakened(&self, path: &PathRay, distance: f32) -> (PathRay, Vec3) {
        let mut weight = path.weight * path.media.transmittance(distance, &self.scene.materials);
        let mut gained = Vec3::ZERO;
        if let Some(fog) = self.scene.fading_fog().filter(|_| path.media.is_none()) {
            let ray = [path.ray.origin, path.ray.direction].map(Vector::from);
            let (transmittance, light) = fog.fade(ray, distance);
            gained = weight * Vec3::from(light);
            weight *= transmittance;
        }
        let arriving = PathRay {
            weight,
            length: path.length + distance,
            ..*path
        };
        (arriving, gained)
    }

    /// Returns the radiance of the background that a ray that hit nothing adds to its path.
    pub fn miss(&self, path: &PathRay) -> Vec3 {
        let ray = [path.ray.origin, path.ray.direction].map(Vector::from);
        let color = self.formulas.background(ray, path.density);
        let (arriving, gained) = self.weakened(path, f32::INFINITY);
        arriving.weight * Vec3::from(color) + gained
    }
}
