//! The `acceleration` section.

use std::fmt;

use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Visitor};

/// How the nearest hit of a ray is found.
///
/// ```
/// # use raycost::config::{Acceleration, Quality};
/// let careful: Acceleration = raycost::yaml::from_str("{ quality: high }").unwrap();
/// let plain: Acceleration = raycost::yaml::from_str("bvh").unwrap();
/// # assert_eq!(careful, Acceleration::Bvh(Quality::High));
/// # assert_eq!(plain, Acceleration::default());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Acceleration {
    /// A bounding volume hierarchy over all shapes but planes.
    Bvh(Quality),
    /// Every shape against every ray: the truth to compare with.
    BruteForce,
}

/// What a hierarchy may take to build. All find the same hits.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, serde::Serialize)]
#[serde(rename_all = "snake_case", expecting = "`fast`, `balanced` or `high`")]
pub enum Quality {
    /// Boxes around whole primitives: least time and memory to build.
    Fast,
    /// The triangles that fill their boxes worst are cut beforehand: up to
    /// twice the time of `fast`.
    #[default]
    Balanced,
    /// Triangles are cut wherever that saves tests: some fifteen times the time
    /// of `fast`, and half more memory.
    High,
}

/// The word of the scene file.
impl fmt::Display for Quality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Fast => "fast",
            Self::Balanced => "balanced",
            Self::High => "high",
        })
    }
}

/// An [`Acceleration`] by one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, serde::Serialize, clap::ValueEnum)]
#[serde(
    rename_all = "snake_case",
    expecting = "`fast`, `balanced`, `high` or `brute_force`"
)]
#[value(rename_all = "snake_case")]
pub enum Structure {
    /// A BVH of this quality
    Fast,
    /// A BVH of this quality
    Balanced,
    /// A BVH of this quality
    High,
    /// Every shape against every ray
    BruteForce,
}

impl From<Structure> for Acceleration {
    fn from(structure: Structure) -> Self {
        match structure {
            Structure::Fast => Self::Bvh(Quality::Fast),
            Structure::Balanced => Self::Bvh(Quality::Balanced),
            Structure::High => Self::Bvh(Quality::High),
            Structure::BruteForce => Self::BruteForce,
        }
    }
}

const EXPECTED: &str = "`bvh`, `brute_force` or { quality: … }";

/// A hierarchy of balanced quality.
impl Default for Acceleration {
    fn default() -> Self {
        Self::Bvh(Quality::default())
    }
}

impl<'de> Deserialize<'de> for Acceleration {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(AccelerationVisitor)
    }
}

struct AccelerationVisitor;

impl<'de> Visitor<'de> for AccelerationVisitor {
    type Value = Acceleration;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(EXPECTED)
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Acceleration, E> {
        match word {
            "bvh" => Ok(Acceleration::default()),
            "brute_force" => Ok(Acceleration::BruteForce),
            _ => {
                let message = format!("unknown variant `{word}`, expected {EXPECTED}");
                Err(E::custom(message))
            }
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Acceleration, A::Error> {
        let Bvh { quality } = Bvh::deserialize(MapAccessDeserializer::new(map))?;
        Ok(Acceleration::Bvh(quality))
    }
}

/// The mapping that stands for a hierarchy.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Bvh {
    quality: Quality,
}
