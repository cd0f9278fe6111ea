//! One light of a scene.

use super::emitter::{Emitter, luminance, luminance_of_lanes as of_lanes};
use super::environment::EnvironmentLight;
use crate::background::Sun;
use crate::geometry::Aabb;
use crate::light::{Illumination, Light, LitPoint};
use math::sampling::hemisphere;
use math::simd::{Real, Vector};

/// Minimum arrival: a light from which less arrives is chosen as if this much did.
const LEAST_ARRIVAL: f32 = 1e-20;

/// A source of light.
#[derive(Debug, Clone)]
pub(super) enum LightSource {
    Light(Light),
    Emitter(Box<Emitter>),
    Environment(Box<EnvironmentLight>),
    Sun(Sun),
    /// The space around a point, up to a distance.
    Surroundings(f32),
}

/// The random numbers that sample the light at a point.
#[derive(Debug, Clone, Copy)]
pub struct LightNumbers<R> {
    /// Choose one of the lights.
    pub source: [R; 2],
    /// Choose one of the shapes of a light.
    pub shape: [R; 2],
    /// Choose the point of a shape.
    pub point: [R; 2],
}

impl LightSource {
    /// Returns true if it has more than one shape.
    pub(super) fn has_shapes(&self) -> bool {
        matches!(self, Self::Emitter(emitter) if emitter.n_shapes() > 1)
    }

    #[inline(always)]
    pub(super) fn illuminate<R: Real>(
        &self,
        at: &LitPoint<R>,
        numbers: &LightNumbers<R>,
    ) -> Illumination<R> {
        match self {
            Self::Surroundings(distance) => surroundings(at.normal, *distance, numbers.point),
            Self::Light(light) => light.illuminate(at.position),
            Self::Emitter(emitter) => emitter.illuminate(at, numbers.shape, numbers.point),
            Self::Environment(environment) => environment.illuminate(numbers.point),
            Self::Sun(sun) => sun.illuminate(numbers.point),
        }
    }

    /// Estimates the light that would arrive at a point if nothing were in the way: the luminance
    /// of a white surface that faces the light, greater than 0.
    #[inline(always)]
    pub(super) fn arrival<R: Real>(&self, point: Vector<R>) -> R {
        let like = point.x;
        let estimate = match self {
            Self::Surroundings(_) => like.splat(1.0),
            Self::Light(light) => of_lanes(light.illuminate(point).radiance),
            Self::Emitter(emitter) => emitter.arrival(point),
            Self::Environment(environment) => like.splat(environment.mean_luminance()),
            Self::Sun(sun) => like.splat(luminance(sun.white_radiance())),
        };
        estimate.max(like.splat(LEAST_ARRIVAL))
    }

    /// Returns the power that a sphere around the scene receives; of a light with a place, from
    /// there, as if the light were in the middle.
    pub(super) fn power(&self, scene: &Aabb) -> f64 {
        let radius = (0.5 * (scene.max - scene.min).length()).max(1e-6);
        let radiance = match self {
            Self::Surroundings(_) => return 0.0,
            Self::Emitter(emitter) => return emitter.power(),
            Self::Environment(environment) => return environment.power(radius),
            Self::Sun(sun) => 0.25 * luminance(sun.white_radiance()),
            Self::Light(light) => luminance(light.mean_radiance(radius)),
        };
        let pi = std::f64::consts::PI;
        4.0 * pi * pi * f64::from(radius).powi(2) * f64::from(radiance)
    }
}

/// Samples white light of radiance 1 from the directions around a normal, in proportion to their
/// cosine, from this distance if nothing is nearer.
#[inline(always)]
fn surroundings<R: Real>(normal: Vector<R>, distance: f32, numbers: [R; 2]) -> Illumination<R> {
    let [x, y, cos] = hemisphere(numbers);
    Illumination {
        direction: normal.around([x, y, cos]).normalize(),
        distance: cos.splat(distance),
        radiance: Vector::splat(cos, glam::Vec3::ONE),
        density: cos * cos.splat(std::f32::consts::FRAC_1_PI),
    }
}
