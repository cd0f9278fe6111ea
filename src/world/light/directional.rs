//! The light from one direction.

use glam::{DAffine3, DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::illumination::{Illumination, MAX_RADIANCE};
use crate::geometry::RenderSpace;
use crate::values;
use math::simd::{Real, Vector};

/// A light infinitely far away, such as the sun.
///
/// ```
/// # use raycost_world::light::Light;
/// let sun: Light = scene::yaml::from_str("
/// directional: { direction: [-1, -2, 1], color: [1, 1, 0.9], intensity: 0.8 }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct DirectionalLight {
    /// The direction in which the light travels.
    #[serde(with = "values::Direction")]
    pub direction: Vec3,
    /// The color; white by default.
    #[serde(with = "values::Radiance", default = "values::white")]
    pub color: Vec3,
    /// A factor on the color, at least 0; 1 by default.
    #[serde(with = "values::Intensity", default = "values::one")]
    pub intensity: f32,
}

impl DirectionalLight {
    /// The sphere receives the light of its cross section, a quarter of its area.
    pub(super) fn mean_radiance(&self, _: f32) -> Vec3 {
        0.25 * self.radiance()
    }

    fn radiance(&self) -> Vec3 {
        (self.color * self.intensity).min(Vec3::splat(MAX_RADIANCE))
    }

    pub(super) fn position(&self) -> Option<DVec3> {
        None
    }

    pub(super) fn in_space(&self, _: &RenderSpace) -> Self {
        *self
    }

    pub(super) fn placed(&self, world_from_object: &DAffine3, factor: f32) -> Option<Self> {
        let direction = world_from_object.transform_vector3(self.direction.as_dvec3());
        Some(Self {
            direction: direction.try_normalize()?.as_vec3(),
            intensity: (self.intensity * factor).min(f32::MAX),
            ..*self
        })
    }

    #[inline(always)]
    pub(super) fn illuminate<R: Real>(&self, point: Vector<R>) -> Illumination<R> {
        Illumination {
            direction: Vector::splat(point.x, -self.direction),
            distance: point.x.splat(f32::INFINITY),
            radiance: Vector::splat(point.x, self.radiance()),
            density: point.x.splat(f32::INFINITY),
        }
    }
}
