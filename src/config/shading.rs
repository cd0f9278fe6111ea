//! The `shading` section.

use glam::Vec3;
use serde::{Deserialize, Deserializer};

use crate::color::Transfer;
use crate::text;
use crate::yaml;

/// The shading model and its parameters.
///
/// ```
/// # use raycost::config::Shading;
/// let shading: Shading = raycost::yaml::from_str("
/// { model: blinn_phong, ambient: 0.1, max_depth: 4 }
/// ").unwrap();
/// # assert_eq!(shading.max_depth, 4);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Shading {
    /// The model.
    pub model: ShadingModel,
    /// The ambient light, a color or a gray; 0.05 if not given.
    #[serde(deserialize_with = "yaml::radiance")]
    pub ambient: Vec3,
    /// Most reflections along a path, 0 to 255; 8 if not given.
    #[serde(deserialize_with = "depth")]
    pub max_depth: u8,
}

/// A shading model.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, clap::ValueEnum)]
#[value(rename_all = "snake_case")]
pub enum ShadingModel {
    /// Blinn-Phong with shadows and Whitted's recursive reflection.
    #[default]
    BlinnPhong,
    /// The model of the course's NumPy code, for comparison with it.
    Seed,
}

impl ShadingModel {
    /// The transfer function of pictures, unless the film has one: none for the
    /// seed's, whose pictures have none.
    pub fn transfer(self) -> Transfer {
        match self {
            Self::BlinnPhong => Transfer::Srgb,
            Self::Seed => Transfer::Linear,
        }
    }

    /// The greatest value of a channel of a sample, to which brighter ones are
    /// limited before the mean is taken: infinity, but 1 for the seed's.
    pub fn sample_limit(self) -> f32 {
        match self {
            Self::BlinnPhong => f32::INFINITY,
            Self::Seed => 1.0,
        }
    }
}

impl<'de> Deserialize<'de> for ShadingModel {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        text::keyword(d)
    }
}

fn depth<'de, D: Deserializer<'de>>(d: D) -> Result<u8, D::Error> {
    yaml::whole(d, 0..=u8::MAX)
}

impl Default for Shading {
    fn default() -> Self {
        Self {
            model: ShadingModel::default(),
            ambient: Vec3::splat(0.05),
            max_depth: 8,
        }
    }
}
