//! Materials: how surfaces reflect light.

mod checker;
mod texture;

use serde::Deserialize;

pub use checker::{Axes, Rounding};
pub use texture::*;

use crate::yaml;

/// One of the scene file's `materials`, for the Blinn-Phong model.
///
/// ```
/// # use raycost::material::Material;
/// let mirror: Material = raycost::yaml::from_str("
/// color: \"#c0c8d0\"   # or [r, g, b], one gray, { checker: … }
/// ambient: 1          # fraction of the ambient light, 0 to 1
/// diffuse: 0.4        # 0 to 1
/// specular: 0.6       # 0 to 1
/// exponent: 80        # size of the highlight: larger is sharper
/// reflection: 0.5     # fraction of the mirrored ray, 0 to 1
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "a material such as { color: [1, 0, 0] }"
)]
pub struct Material {
    /// The color of its diffuse reflection.
    pub color: Texture,
    /// Fraction of the scene's ambient light, 0 to 1; 1 by default.
    #[serde(deserialize_with = "yaml::fraction", default = "one")]
    pub ambient: f32,
    /// Fraction of the diffuse light, 0 to 1; 1 by default.
    #[serde(deserialize_with = "yaml::fraction", default = "one")]
    pub diffuse: f32,
    /// Strength of the highlight, 0 to 1; 0 by default.
    #[serde(deserialize_with = "yaml::fraction", default)]
    pub specular: f32,
    /// Exponent of the highlight, at least 0; 50 by default.
    #[serde(deserialize_with = "yaml::non_negative", default = "fifty")]
    pub exponent: f32,
    /// Fraction of the mirrored ray's light, 0 to 1; 0 by default.
    #[serde(deserialize_with = "yaml::fraction", default)]
    pub reflection: f32,
}

fn one() -> f32 {
    1.0
}

fn fifty() -> f32 {
    50.0
}
