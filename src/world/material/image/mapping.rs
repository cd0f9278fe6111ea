//! Mappings of pictures onto surfaces.

use std::fmt;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserialize, Deserializer, Error, MapAccess, Visitor};

use super::planar::Planar;
use super::spherical::Spherical;
use super::triplanar::Triplanar;
#[cfg(feature = "schema")]
use crate::values::{Either, expected};
use base::{Keyword, keywords};

/// The mapping of a picture onto a surface.
///
/// ```
/// # use raycost_world::material::Mapping;
/// let wall: Mapping = scene::yaml::from_str("
/// planar: { right: [1, 0, 0], up: [0, 1, 0], origin: [-2, 0, 0] }
/// ").unwrap();
/// let floor: Mapping = scene::yaml::from_str("planar").unwrap();
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "Either<MappingWord, MappingKeys>", transform = expected::<Self>))]
#[serde(rename_all = "snake_case")]
pub enum Mapping {
    /// By the texture coordinates of a mesh.
    #[default]
    Uv,
    /// Projected onto a plane.
    Planar(Planar),
    /// Projected onto a sphere, as a map of longitudes and latitudes.
    Spherical(Spherical),
    /// Projected along all three axes of world space, weighted by how close the normal is to each
    /// axis.
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
        /// Projected along all three axes of world space, weighted by how close the normal is to
        /// each axis.
        Triplanar = "triplanar",
    }
}

/// The mappings with keys.
#[derive(serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
enum MappingKeys {
    /// Projected along an axis.
    Planar(Planar),
    /// Around a center, by longitude and latitude.
    Spherical(Spherical),
}

const EXPECTED: &str =
    "`uv`, `planar`, `spherical`, `triplanar`, { planar: … } or { spherical: … }";

impl<'de> Deserialize<'de> for Mapping {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(MappingVisitor)
    }
}

struct MappingVisitor;

impl<'de> Visitor<'de> for MappingVisitor {
    type Value = Mapping;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(EXPECTED)
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Mapping, E> {
        let known = MappingWord::from_name(word);
        let unknown = || E::custom(format!("unknown variant `{word}`, expected {EXPECTED}"));
        Ok(match known.ok_or_else(unknown)? {
            MappingWord::Uv => Mapping::Uv,
            MappingWord::Planar => Mapping::Planar(Planar::default()),
            MappingWord::Spherical => Mapping::Spherical(Spherical::default()),
            MappingWord::Triplanar => Mapping::Triplanar(Triplanar::default()),
        })
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Mapping, A::Error> {
        let keys = MappingKeys::deserialize(MapAccessDeserializer::new(map))?;
        Ok(match keys {
            MappingKeys::Planar(plane) => Mapping::Planar(plane),
            MappingKeys::Spherical(sphere) => Mapping::Spherical(sphere),
        })
    }
}
