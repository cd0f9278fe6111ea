//! The spot light.

use glam::{DAffine3, DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::falloff::Falloff;
use super::illumination::Illumination;
use super::point::PointLight;
use crate::geometry::RenderSpace;
use crate::kinds;
use crate::values::{self, Number};
use math::simd::{Real, Vector};

/// A light that shines from one point into a cone.
///
/// ```
/// # use raycost_world::light::Light;
/// let light: Light = scene::yaml::from_str("
/// spot: { position: [0, 5, 0], target: [0, 0, 0], angle_deg: 40, soft_edge: 0.2, intensity: 60, falloff: inverse_square }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(try_from = "SpotKeys", into = "SpotKeys")]
pub struct SpotLight {
    /// The light in the middle of the cone.
    light: PointLight,
    /// A point on the axis, in world space.
    target: DVec3,
    /// The angle of the cone in degrees, from edge to edge.
    angle_deg: f32,
    /// The outer fraction of the angle, in which the light fades.
    soft_edge: f32,
    /// The unit vector along the middle of the cone.
    axis: Vec3,
    /// The cosines at the edge of the cone and where the light begins to fade.
    cosines: [f32; 2],
}

#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct SpotKeys {
    /// The position.
    #[serde(with = "values::Point")]
    position: DVec3,
    /// A point in the middle of the cone.
    #[serde(with = "values::Point")]
    target: DVec3,
    /// The angle of the cone in degrees, from edge to edge.
    #[serde(with = "ConeAngle")]
    angle_deg: f32,
    /// The outer fraction of the angle, in which the light fades, 0 to 1; 0.1 by default.
    #[serde(with = "values::Fraction", default = "soft_edge")]
    soft_edge: f32,
    /// The color; white by default.
    #[serde(with = "values::Radiance", default = "values::white")]
    color: Vec3,
    /// A factor on the color, at least 0; 1 by default.
    #[serde(with = "values::Intensity", default = "values::one")]
    intensity: f32,
    /// The falloff with the distance; none by default.
    #[serde(default)]
    falloff: Falloff,
}

kinds! {
    // From the least number above 0.
    ConeAngle: f32 = Number {
        expected: "an angle greater than 0 and at most 180",
        ranges: &[[5e-324, 180.0]],
    };
}

fn soft_edge() -> f32 {
    0.1
}

impl TryFrom<SpotKeys> for SpotLight {
    type Error = &'static str;

    fn try_from(keys: SpotKeys) -> Result<Self, Self::Error> {
        let axis = (keys.target - keys.position)
            .try_normalize()
            .ok_or("cannot shine at its own position, expected another `target`")?
            .as_vec3();
        let half_angle = 0.5 * f64::from(keys.angle_deg).to_radians();
        let full_light = half_angle * (1.0 - f64::from(keys.soft_edge));
        let light = PointLight {
            position: keys.position,
            color: keys.color,
            intensity: keys.intensity,
            falloff: keys.falloff,
        };
        Ok(Self {
            target: keys.target,
            angle_deg: keys.angle_deg,
            soft_edge: keys.soft_edge,
            ..Self::new(light, axis, [half_angle, full_light])
        })
    }
}

impl From<SpotLight> for SpotKeys {
    fn from(spot: SpotLight) -> Self {
        let PointLight {
            position,
            color,
            intensity,
            falloff,
        } = spot.light;
        Self {
            position,
            target: spot.target,
            angle_deg: spot.angle_deg,
            soft_edge: spot.soft_edge,
            color,
            intensity,
            falloff,
        }
    }
}

impl SpotLight {
    /// Creates the light of a cone around a unit vector; `angles` are those from the axis to the
    /// edge and to where the light begins to fade, in radians.
    pub fn new(light: PointLight, axis: Vec3, angles: [f64; 2]) -> Self {
        let [edge, full] = angles;
        Self {
            light,
            target: light.position + axis.as_dvec3(),
            angle_deg: (2.0 * edge).to_degrees() as f32,
            soft_edge: (1.0 - full / edge) as f32,
            axis,
            cosines: angles.map(|angle| angle.cos() as f32),
        }
    }

    /// The smoothstep lets half of the light of its range of cosines pass.
    pub(super) fn mean_radiance(&self, radius: f32) -> Vec3 {
        let [edge, full] = self.cosines;
        self.light.mean_radiance(radius) * (0.5 - 0.25 * (edge + full))
    }

    pub(super) fn position(&self) -> Option<DVec3> {
        self.light.position()
    }

    pub(super) fn in_space(&self, space: &RenderSpace) -> Self {
        Self {
            light: self.light.in_space(space),
            ..*self
        }
    }

    pub(super) fn placed(&self, world_from_object: &DAffine3, factor: f32) -> Option<Self> {
        let axis = world_from_object.transform_vector3(self.axis.as_dvec3());
        Some(Self {
            light: self.light.placed(world_from_object, factor)?,
            target: world_from_object.transform_point3(self.target),
            axis: axis.try_normalize()?.as_vec3(),
            ..*self
        })
    }

    /// Fades the light toward the edge by a smoothstep in the cosine of the angle.
    #[inline(always)]
    pub(super) fn illuminate<R: Real>(&self, point: Vector<R>) -> Illumination<R> {
        let light = self.light.illuminate(point);
        let (zero, one) = (light.distance.splat(0.0), light.distance.splat(1.0));
        let [edge, full] = self.cosines;
        let cos = -light.direction.dot(Vector::splat(zero, self.axis));
        let width = one.splat((full - edge).max(f32::MIN_POSITIVE));
        let inside = ((cos - one.splat(edge)) / width).max(zero).min(one);
        let share = inside * inside * (one.splat(3.0) - one.splat(2.0) * inside);
        Illumination {
            radiance: light.radiance * share,
            ..light
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_over_a_sphere_is_that_of_its_points() {
        for keys in [
            "target: [3, 1, 2], angle_deg: 50, soft_edge: 0.7",
            "target: [0, -1, 0], angle_deg: 180, soft_edge: 0",
        ] {
            let text = format!(
                "{{ position: [1, 1, 1], {keys}, color: [1, 0.5, 2], falloff: inverse_square }}"
            );
            let light: SpotLight = scene::yaml::from_str(&text).unwrap();
            let n = 40_000_u16;
            let mut mean = Vec3::ZERO;
            for i in 0..n {
                // Fibonacci's spiral: the points are uniform on the sphere.
                let z = 1.0 - (2.0 * f32::from(i) + 1.0) / f32::from(n);
                let (sin, cos) = (f32::from(i) * 2.399_963_3).sin_cos();
                let ring = (1.0 - z * z).sqrt();
                let point = Vec3::ONE + 2.0 * Vec3::new(cos * ring, sin * ring, z);
                mean += Vec3::from(light.illuminate(point.into()).radiance) / f32::from(n);
            }
            let found = light.mean_radiance(2.0);
            assert!((found - mean).abs().max_element() < 1e-3, "{found} {mean}");
        }
    }

    #[test]
    fn the_light_fades_at_the_edge_of_the_cone() {
        let at = |soft_edge: f32, angle: f32| {
            let text = format!(
                "{{ position: [0, 0, 0], target: [0, 0, 1], angle_deg: 60, \
                 soft_edge: {soft_edge}, intensity: 2 }}"
            );
            let light: SpotLight = scene::yaml::from_str(&text).unwrap();
            let (sin, cos) = angle.to_radians().sin_cos();
            light.illuminate(Vec3::new(sin, 0.0, cos).into()).radiance.x
        };
        assert_eq!(
            [0.0, 29.9, 30.1, 90.0, 180.0].map(|angle| at(0.0, angle)),
            [2.0, 2.0, 0.0, 0.0, 0.0]
        );
        assert_eq!(
            [0.0, 14.9, 30.1].map(|angle| at(0.5, angle)),
            [2.0, 2.0, 0.0]
        );
        assert!(at(0.5, 20.0) < 2.0 && at(0.5, 25.0) < at(0.5, 20.0) && at(0.5, 29.0) > 0.0);
    }
}
