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
use crate::cost::RayKind;
use crate::trace::{ShadingPoint, SurfacePoint};
use bsdf::{Boundary, Bsdf, by_kind};
use emission::{Arrival, emitted};
use fresnel::{mirrored_share, split_at};
use math::sampling::Sampler;
use math::simd::{Simd, Vector};
use media::Interface;
use model::{Bounce, Model};
use models::by_model;
use numbers::PointNumbers;
use scatter::{Continuation, scattered_kind};
use world::camera::RayCone;
use world::geometry::{Ray, Seen};
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
    sampler: Sampler,
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
        Self { scene, sampler }
    }

    /// Returns the formulas that follow the paths of this shader, whose camera rays have this
    /// footprint.
    pub fn formulas(&self, cone: Option<RayCone>) -> PathFormulas<'a> {
        PathFormulas::new(self.scene, self.sampler, cone)
    }

    /// Creates a shader of waves for this instruction set.
    pub fn wave_shader(&self, simd: Simd) -> WaveShader<'a> {
        WaveShader::new(self.scene, self.sampler, simd)
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
        (0..self.n_light_samples(path, point)).filter_map(move |i| {
            by_model!(self.scene, |model| self.light_sample(model, i, path, point))
        })
    }

    /// Returns the number of light samples at a point.
    fn n_light_samples(&self, path: &PathRay, point: &SurfacePoint) -> usize {
        let material = self.scene.material(point.material);
        if !scatters_light(material, point) {
            return 0;
        }
        let max_depth = self.scene.shading.max_depth.into();
        let lights = &self.scene.lights;
        by_model!(self.scene, |model| if model.is_lit(material) {
            model.n_light_samples(lights, path.depth, max_depth)
        } else {
            0
        })
    }

    /// Returns light sample `i` at a point, or `None` if it cannot arrive.
    fn light_sample<M: Model>(
        &self,
        model: M,
        i: usize,
        path: &PathRay,
        point: &SurfacePoint,
    ) -> Option<LightSample> {
        let at = point.shading();
        let material = self.scene.material(point.material);
        // Sample the light, and weaken it by the media on the way.
        let lights = &self.scene.lights;
        let (light, index) = match lights.plain(i) {
            Some(light) => (light.illuminate(at.position), i as f32),
            None => {
                let numbers = self.numbers(path).light(lights, i);
                let (light, index) = lights.illuminate(i, &at.lit(), &numbers);
                (self.weakened_by_media(light, path, point), index)
            }
        };
        // Cast a shadow ray if the light may arrive.
        let direction = light.direction;
        model
            .may_arrive(material, &at, &light)
            .then(|| LightSample {
                light,
                index: index as u32,
                shadow: ShadowRay {
                    ray: departing(model, &at, direction),
                    t_max: model.end(&light),
                    ignored: M::IGNORES_OWN_OBJECT.then_some(point.object),
                },
            })
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

    /// Returns the random numbers of the point that a ray hits.
    fn numbers(&self, path: &PathRay) -> PointNumbers<u32> {
        PointNumbers::new(self.sampler, path.id, path.depth)
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
        by_model!(self.scene, |model| self
            .shade_by(model, eye, path, point, lights, next))
    }

    /// Shades a point, as [`shade`](Self::shade) does, by a model.
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
        let scatters = scatters_light(material, point);
        // Ambient and emitted light.
        let mut color = Vector::from(Vec3::ZERO);
        if scatters {
            color = model.ambient(material, self.scene.shading.ambient, at.color);
        }
        if material.emits() {
            color = color + self.emission(path, point);
        }
        // The light samples that arrive.
        let boundary = scattering_boundary(self.interface(path, point).as_ref());
        let mut is_lit = !M::NEEDS_LIGHT;
        for light in lights {
            is_lit = true;
            color = color + model.reflected(material, &boundary, &at, &light, to_viewer);
        }
        if !is_lit {
            return Vec3::ZERO;
        }
        // The light that is left at the viewer, of the surface and of what is behind it.
        let (arriving, gained) = self.weakened(path, point.distance);
        let met = arriving.weakened_by(point.opacity);
        // The rays that continue the path.
        if scatters && path.depth < u32::from(self.scene.shading.max_depth) {
            match M::BOUNCE {
                Bounce::None => {}
                Bounce::Mirrored => self.continue_path(model, &met, point, next),
                Bounce::Scattered => next.extend(self.scattered(&met, point)),
            }
        }
        if point.opacity < 1.0 {
            let ray = departing(model, &point.shading(), direction);
            let share = Vec3::splat(1.0 - point.opacity);
            let passing = arriving.continued(RayKind::Refraction, ray, share);
            next.extend(Some(passing).filter(PathRay::has_weight));
        }
        met.weight * Vec3::from(color) + gained
    }

    /// Returns the light that the point emits toward the ray, weighted.
    fn emission(&self, path: &PathRay, point: &SurfacePoint) -> Vector<f32> {
        let at = point.shading();
        let emitted = emitted(self.scene.material(point.material), &at);
        let primitive = &self.scene.primitives[point.primitive as usize];
        let emitter = self.scene.lights.emitter(point.material, primitive.kind());
        let Some((emitter, index)) = emitter.filter(|_| self.scene.scatters_paths()) else {
            return emitted;
        };
        let direction = Vector::from(path.ray.direction);
        let arrival = Arrival {
            from: path.ray.origin.into(),
            density: path.density,
            seen: Seen {
                direction,
                distance: point.distance,
                cos: -at.outward(at.geometric_normal).dot(direction),
            },
            shape: self.scene.parameters(point.placed()),
        };
        emitted * emission::weight(&self.scene.lights, emitter, index, &arrival)
    }

    /// Returns the surface of a medium that a ray has met at a point, or `None` for other surfaces.
    fn interface(&self, path: &PathRay, point: &SurfacePoint) -> Option<Interface> {
        let (all, enters) = (&self.scene.materials, !point.is_flipped);
        let material = self.scene.material(point.material);
        let is_medium = material.kind.medium().is_some();
        is_medium.then(|| path.media.cross(point.material, enters, all))
    }

    /// Returns the ray that continues a path in a direction chosen at random, if any.
    fn scattered(&self, path: &PathRay, point: &SurfacePoint) -> Option<PathRay> {
        let material = self.scene.material(point.material);
        if !material.scatters() {
            return None;
        }
        // Sample a direction.
        let interface = self.interface(path, point);
        let boundary = scattering_boundary(interface.as_ref());
        let arriving = Vector::from(path.ray.direction);
        let continuation = by_kind!(Bsdf::new(material), |of| Continuation::sample(
            of,
            &point.shading(),
            arriving,
            &boundary,
            &self.numbers(path),
            path.weight.into()
        ));
        // Enter the medium behind the surface if the ray is refracted.
        let media = match interface {
            Some(interface) if continuation.is_refracted => interface.behind,
            _ => path.media,
        };
        // Russian roulette: end a path of little weight, and raise the weight of one that survives.
        let index = media.index(&self.scene.materials);
        let (is_alive, weight) = continuation.survive(index, path.depth);
        is_alive.then(|| PathRay {
            ray: Ray {
                origin: continuation.origin.into(),
                direction: continuation.direction.into(),
            },
            kind: scattered_kind(continuation.is_refracted, continuation.is_diffuse),
            depth: path.depth + 1,
            weight: weight.into(),
            media,
            density: continuation.density,
            ..*path
        })
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
        // A mirror reflects the ray.
        let reflected = |share: Vec3| {
            let ray = departing(model, &at, at.mirrored(direction));
            path.continued(RayKind::Reflection, ray, share)
        };
        let Some(interface) = self.interface(path, point) else {
            if material.kind.mirrors() {
                next.push(reflected(mirrored_share(material, &at, direction).into()));
            }
            return;
        };
        // The surface of a medium splits it.
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

    /// Returns the radiance of the background that a ray that hit nothing adds to its path.
    pub fn miss(&self, path: &PathRay) -> Vec3 {
        let ray = [path.ray.origin, path.ray.direction].map(Vector::from);
        let color = emission::weighted_background(self.scene, ray, path.density);
        let (arriving, gained) = self.weakened(path, f32::INFINITY);
        arriving.weight * Vec3::from(color) + gained
    }
}

/// Returns the ray that leaves a point in this direction.
fn departing(model: impl Model, at: &ShadingPoint<f32>, direction: Vector<f32>) -> Ray {
    Ray {
        origin: model.origin(at, direction).into(),
        direction: direction.into(),
    }
}

/// Returns the boundary that scattering needs: the surface of a medium, or any other surface.
fn scattering_boundary(interface: Option<&Interface>) -> Boundary<f32> {
    interface.map_or(Boundary::without_medium(1.0), |of| Boundary {
        eta: of.eta,
        is_visible: of.is_visible,
    })
}

/// Returns true if a point is on a side of its surface that reflects or refracts light.
fn scatters_light(material: &Material, point: &SurfacePoint) -> bool {
    material.two_sided || !point.is_flipped
}
