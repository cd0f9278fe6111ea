//! The point light.

use glam::{DAffine3, DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::falloff::Falloff;
use super::illumination::{Illumination, MAX_RADIANCE};
use crate::geometry::RenderSpace;
use crate::values;
use math::simd::{Real, Vector};

/// A light that shines from one point in all directions.
///
/// ```
/// # use raycost_world::light::Light;
/// let light: Light = scene::yaml::from_str("
/// point: { position: [5, 5, -10], color: [1, 0.9, 0.8], intensity: 60, falloff: inverse_square }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PointLight {
    /// The position.
    #[serde(with = "values::Point")]
    pub position: DVec3,
    /// The color; white by default.
    #[serde(with = "values::Radiance", default = "values::white")]
    pub color: Vec3,
    /// A factor on the color, at least 0; 1 by default.
    #[serde(with = "values::Intensity", default = "values::one")]
    pub intensity: f32,
    /// The falloff with the distance; none by default.
    #[serde(default)]
    pub falloff: Falloff,
}

impl PointLight {
    pub(super) fn mean_radiance(&self, radius: f32) -> Vec3 {
        self.radiance(radius).into()
    }

    /// Returns the radiance of a white surface that faces the light at this distance.
    #[inline(always)]
    fn radiance<R: Real>(&self, distance: R) -> Vector<R> {
        let brightest = MAX_RADIANCE / self.color.max_element().max(1.0);
        let intensity = distance.splat(self.intensity) * self.falloff.factor(distance);
        Vector::splat(distance, self.color) * intensity.min(distance.splat(brightest))
    }

    pub(super) fn position(&self) -> Option<DVec3> {
        Some(self.position)
    }

    pub(super) fn in_space(&self, space: &RenderSpace) -> Self {
        Self {
            position: space.point(self.position).as_dvec3(),
            intensity: space.times_length(self.falloff.power(), self.intensity),
            ..*self
        }
    }

    pub(super) fn placed(&self, world_from_object: &DAffine3, factor: f32) -> Option<Self> {
        let scale = world_from_object.matrix3.determinant().abs().cbrt();
        let factor = factor * scale.powi(self.falloff.power()) as f32;
        Some(Self {
            position: world_from_object.transform_point3(self.position),
            intensity: (self.intensity * factor).min(f32::MAX),
            ..*self
        })
    }

    #[inline(always)]
    pub(super) fn illuminate<R: Real>(&self, point: Vector<R>) -> Illumination<R> {
        let to_light = Vector::splat(point.x, self.position.as_vec3()) - point;
        let distance = to_light.length();
        Illumination {
            direction: to_light / distance.max(distance.splat(f32::MIN_POSITIVE)),
            distance,
            radiance: self.radiance(distance),
            density: distance.splat(f32::INFINITY),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_falloffs_halve_and_quarter_at_twice_the_distance() {
        let at = |falloff, distance| {
            let light = PointLight {
                position: DVec3::Y * distance,
                color: Vec3::ONE,
                intensity: 3.0,
                falloff,
            };
            light.illuminate(Vec3::ZERO.into()).radiance.x
        };
        assert_eq!(at(Falloff::None, 2.0), 3.0);
        assert_eq!(at(Falloff::Inverse, 2.0), 1.5);
        assert_eq!(at(Falloff::InverseSquare, 2.0), 0.75);
    }
}
