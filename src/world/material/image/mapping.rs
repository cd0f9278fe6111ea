//! Mappings of pictures onto surfaces.

use serde::{Deserialize, Serialize};

use super::planar::Planar;
use super::spherical::Spherical;
use super::triplanar::Triplanar;
use crate::values::{WordChoice, WordOr};
use base::keywords;

/// The mapping of a picture onto a surface.
///
/// ```
/// # use raycost_world::material::Mapping;
/// let wall: Mapping = scene::yaml::from_str("
/// planar: { right: [1, 0, 0], up: [0, 1, 0], origin: [-2, 0, 0] }
/// ").unwrap();
/// let floor: Mapping = scene::yaml::from_str("planar").unwrap();
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(with = "WordOr<MappingWord, MappingKeys>")
)]
#[serde(from = "WordOr<MappingWord, MappingKeys>", rename_all = "snake_case")]
pub enum Mapping {
    /// By the texture coordinates of a mesh.
    #[default]
    Uv,
    /// Projected onto a plane.
    Planar(Planar),
    /// Projected onto a sphere, as a map of longitudes and latitudes.
    Spherical(Spherical),
    /// Projected along x, y and z, each weighted by how close the normal is to it.
    #[serde(untagged)]
    Triplanar(Triplanar),
}

keywords! {
    /// The mappings without keys.
    enum MappingWord {
        /// By the texture coordinates of a mesh.
        Uv = "uv",
        /// Projected onto a plane.
        Planar = "planar",
        /// Projected onto a sphere, as a map of longitudes and latitudes.
        Spherical = "spherical",
        /// Projected along x, y and z, each weighted by how close the normal is to it.
        Triplanar = "triplanar",
    }
}

/// The mappings with keys.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
enum MappingKeys {
    /// Projected along an axis.
    Planar(Planar),
    /// Around a center, by longitude and latitude.
    Spherical(Spherical),
}

impl WordChoice for MappingWord {
    const EXPECTED: &'static str =
        "`uv`, `planar`, `spherical`, `triplanar`, { planar: … } or { spherical: … }";
}

impl From<WordOr<MappingWord, MappingKeys>> for Mapping {
    fn from(found: WordOr<MappingWord, MappingKeys>) -> Self {
        match found {
            WordOr::Word(MappingWord::Uv) => Self::Uv,
            WordOr::Word(MappingWord::Planar) => Self::Planar(Planar::default()),
            WordOr::Word(MappingWord::Spherical) => Self::Spherical(Spherical::default()),
            WordOr::Word(MappingWord::Triplanar) => Self::Triplanar(Triplanar::default()),
            WordOr::Keys(MappingKeys::Planar(plane)) => Self::Planar(plane),
            WordOr::Keys(MappingKeys::Spherical(sphere)) => Self::Spherical(sphere),
        }
    }
}
