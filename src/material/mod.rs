//! Materials: what a surface does to light.

mod texture;

use serde::Deserialize;

pub use texture::{Axes, Checker, Rounding, Texture};

use crate::yaml;

/// One of the scene file's `materials`, for Blinn and Phong's model.
///
/// ```
/// # use raycost::material::Material;
/// let mirror: Material = raycost::yaml::from_str("
/// color: \"#c0c8d0\"   # or [r, g, b], one grey, { checker: … }
/// ambient: 1          # share of the ambient light, 0 to 1
/// diffuse: 0.4        # 0 to 1
/// specular: 0.6       # 0 to 1
/// exponent: 80        # size of the highlight: larger is sharper
/// reflection: 0.5     # share of the mirrored ray, 0 to 1
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "a material such as { color: [1, 0, 0] }"
)]
pub struct Material {
    /// The colour of its diffuse light.
    pub color: Texture,
    /// Share of the scene's ambient light, 0 to 1; 1 if not given.
    #[serde(deserialize_with = "yaml::fraction", default = "one")]
    pub ambient: f32,
    /// Share of diffuse light, 0 to 1; 1 if not given.
    #[serde(deserialize_with = "yaml::fraction", default = "one")]
    pub diffuse: f32,
    /// Strength of the highlight, 0 to 1; none if not given.
    #[serde(deserialize_with = "yaml::fraction", default)]
    pub specular: f32,
    /// Exponent of the highlight, at least 0; 50 if not given.
    #[serde(deserialize_with = "yaml::non_negative", default = "fifty")]
    pub exponent: f32,
    /// Share of the mirrored ray's light, 0 to 1; none if not given.
    #[serde(deserialize_with = "yaml::fraction", default)]
    pub reflection: f32,
}

fn one() -> f32 {
    1.0
}

fn fifty() -> f32 {
    50.0
}
