//! Lights: a point → the light that arrives there.
//!
//! Each kind of light has one file. To add a light, write its file, its `mod` line and
//! its arms in [`Light`].

mod default;
mod directional;
mod falloff;
mod illumination;
mod point;

use glam::Vec3;
use serde::Deserialize;

pub use directional::DirectionalLight;
pub use falloff::Falloff;
pub use illumination::Illumination;
pub use point::PointLight;

/// One of the scene file's `lights`.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(
    rename_all = "snake_case",
    expecting = "a light such as { point: { … } }"
)]
pub enum Light {
    /// A light at a point.
    Point(PointLight),
    /// A light infinitely far away.
    Directional(DirectionalLight),
}

impl Light {
    /// The light that arrives at `point` unless it is occluded.
    pub fn illuminate(&self, point: Vec3) -> Illumination {
        match self {
            Self::Point(light) => light.illuminate(point),
            Self::Directional(light) => light.illuminate(),
        }
    }
}
