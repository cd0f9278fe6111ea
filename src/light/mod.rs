//! Lights: a point → where its light comes from.
//!
//! Each kind is one file. To add a light, write its file, its `mod` line and
//! its arms in [`Light`].

mod directional;
mod falloff;
mod point;

use glam::Vec3;
use serde::Deserialize;

pub use directional::DirectionalLight;
pub use falloff::Falloff;
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

/// The light that reaches a point from one light, if nothing stands between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Illumination {
    /// From the point to the light, a unit vector.
    pub direction: Vec3,
    /// How far the light is; infinite for a directional one.
    pub distance: f32,
    /// What arrives, each channel at least 0.
    pub radiance: Vec3,
}

impl Light {
    /// The light at `point`.
    pub fn illuminate(&self, point: Vec3) -> Illumination {
        match self {
            Self::Point(light) => light.illuminate(point),
            Self::Directional(light) => light.illuminate(),
        }
    }
}
