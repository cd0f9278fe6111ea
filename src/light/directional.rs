//! The light that comes from one direction.

use glam::Vec3;
use serde::Deserialize;

use super::Illumination;
use crate::yaml;

/// A light infinitely far away, such as the sun.
///
/// ```
/// # use raycost::light::Light;
/// let sun: Light = raycost::yaml::from_str("
/// directional: { direction: [-1, -2, 1], color: [1, 1, 0.9], intensity: 0.8 }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DirectionalLight {
    /// Where its light goes, a unit vector; the file may give any length but zero.
    #[serde(deserialize_with = "yaml::direction")]
    pub direction: Vec3,
    /// Its colour, each channel at least 0; white if not given.
    #[serde(deserialize_with = "yaml::radiance", default = "white")]
    pub color: Vec3,
    /// A factor on the colour, at least 0; 1 if not given.
    #[serde(deserialize_with = "yaml::non_negative", default = "one")]
    pub intensity: f32,
}

impl DirectionalLight {
    pub(super) fn illuminate(&self) -> Illumination {
        Illumination {
            direction: -self.direction,
            distance: f32::INFINITY,
            radiance: self.color * self.intensity,
        }
    }
}

/// The colour of a light whose file names none.
pub(super) fn white() -> Vec3 {
    Vec3::ONE
}

/// The intensity of a light whose file names none.
pub(super) fn one() -> f32 {
    1.0
}
