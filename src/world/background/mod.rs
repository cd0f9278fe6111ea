//! The background: the radiance that rays without a hit receive, by direction.
//!
//! Each kind of background has one file. To add one, write its file, its `mod` line, and its arms
//! below.

mod environment_map;
mod gradient;
mod sky;
mod sun;

use glam::Vec3;
use serde::{Deserialize, Serialize};

pub use environment_map::EnvironmentMap;
pub use gradient::Gradient;
pub use sky::Sky;
pub use sun::Sun;

use crate::values::{ColorOr, ColorPattern, RadianceOr};
use math::simd::{Real, Vector};

/// The `background` section.
///
/// ```
/// # use raycost_world::background::Background;
/// let sky: Background = scene::yaml::from_str("
/// gradient: { bottom: [0.9, 0.9, 1], top: [0.3, 0.5, 0.9] }
/// ").unwrap();
/// let gray: Background = scene::yaml::from_str("0.2").unwrap();
/// # assert_eq!(gray.color(glam::Vec3::Y.into()), glam::Vec3::splat(0.2).into());
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(from = "RadianceOr<BackgroundPattern>", rename_all = "snake_case")]
pub enum Background {
    /// One or two colors.
    Gradient(Gradient),
    /// A picture.
    EnvironmentMap(EnvironmentMap),
    /// A clear sky.
    Sky(Box<Sky>),
}

/// A background other than one color.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
enum BackgroundPattern {
    /// Two colors, linear in the height of the direction.
    Gradient(Gradient),
    /// A picture of everything around the scene.
    EnvironmentMap(EnvironmentMap),
    /// A clear sky by day with its sun, and a ground below the horizon.
    Sky(Box<Sky>),
}

/// Black.
impl Default for Background {
    fn default() -> Self {
        Self::Gradient(Gradient::uniform(Vec3::ZERO))
    }
}

impl ColorPattern for BackgroundPattern {}

impl From<RadianceOr<BackgroundPattern>> for Background {
    fn from(RadianceOr(found): RadianceOr<BackgroundPattern>) -> Self {
        match found {
            ColorOr::Color(color) => Self::Gradient(Gradient::uniform(color)),
            ColorOr::Other(BackgroundPattern::Gradient(gradient)) => Self::Gradient(gradient),
            ColorOr::Other(BackgroundPattern::EnvironmentMap(map)) => Self::EnvironmentMap(map),
            ColorOr::Other(BackgroundPattern::Sky(sky)) => Self::Sky(sky),
        }
    }
}

impl Background {
    /// Returns the radiance from a direction, a unit vector.
    #[inline(always)]
    pub fn color<R: Real>(&self, direction: Vector<R>) -> Vector<R> {
        let color = self.without_sun(direction);
        match self.sun() {
            None => color,
            Some(sun) => color + sun.radiance(direction),
        }
    }

    /// Returns the radiance without the sun's.
    #[inline(always)]
    pub fn without_sun<R: Real>(&self, direction: Vector<R>) -> Vector<R> {
        match self {
            Self::Gradient(gradient) => gradient.color(direction),
            Self::EnvironmentMap(map) => map.radiance(direction),
            Self::Sky(sky) => sky.map.radiance(direction),
        }
    }

    /// Returns the picture if there is one.
    pub fn environment_map(&self) -> Option<&EnvironmentMap> {
        match self {
            Self::Gradient(_) => None,
            Self::EnvironmentMap(map) => Some(map),
            Self::Sky(sky) => Some(&sky.map),
        }
    }

    /// Returns the sun if there is one.
    pub fn sun(&self) -> Option<&Sun> {
        match self {
            Self::Sky(sky) => Some(&sky.sun),
            Self::Gradient(_) | Self::EnvironmentMap(_) => None,
        }
    }
}
