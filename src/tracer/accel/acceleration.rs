//! The choice of the structure, and of its traversal.

use std::fmt;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};

use base::keywords;

/// The structure that finds the nearest hit of a ray.
///
/// ```
/// # use raycost_tracer::accel::{Acceleration, Quality};
/// let careful: Acceleration = scene::yaml::from_str("{ quality: high }").unwrap();
/// let plain: Acceleration = scene::yaml::from_str("bvh").unwrap();
/// # assert_eq!(careful, Acceleration::Bvh(Quality::High));
/// # assert_eq!(plain, Acceleration::default());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "world::values::Either<AccelerationWord, BvhSection>", transform = world::values::expected::<Self>))]
pub enum Acceleration {
    /// A bounding volume hierarchy over all shapes except planes.
    Bvh(Quality),
    /// Tests every ray against every shape: the reference for the others.
    BruteForce,
}

impl Acceleration {
    /// Returns the name in files: `bvh` or `brute_force`.
    pub fn kind(self) -> &'static str {
        match self {
            Self::Bvh(_) => "bvh",
            Self::BruteForce => "brute_force",
        }
    }

    /// Returns the quality of a hierarchy.
    pub fn quality(self) -> Option<Quality> {
        match self {
            Self::Bvh(quality) => Some(quality),
            Self::BruteForce => None,
        }
    }
}

/// The effort spent on building a hierarchy. All qualities find the same hits.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", expecting = "`fast`, `balanced` or `high`")]
pub enum Quality {
    /// Object splits only: the least build time and memory.
    Fast,
    /// Splits the triangles that fill their boxes worst before the build: up to
    /// twice the build time of `fast`.
    #[default]
    Balanced,
    /// Spatial splits wherever they lower the SAH cost: about fifteen times the
    /// build time of `fast`, and 1.5 times its memory.
    High,
}

/// Formats the name in scene files.
impl fmt::Display for Quality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Fast => "fast",
            Self::Balanced => "balanced",
            Self::High => "high",
        })
    }
}

keywords! {
    /// An [`Acceleration`] as one word, for the command line.
    pub enum Structure {
        /// A BVH of this quality
        Fast = "fast",
        /// A BVH of this quality
        Balanced = "balanced",
        /// A BVH of this quality
        High = "high",
        /// Every shape against every ray
        BruteForce = "brute_force",
    }
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

keywords! {
    /// How the kernel takes the rays of a wave.
    #[derive(Default)]
    pub enum Traversal {
        /// One after the other
        Single = "single",
        /// Many at a time
        #[default]
        Stream = "stream",
    }
}

/// How the hierarchy of a frame is made if its objects differ from the frame before.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", expecting = "`rebuild`, `refit` or `auto`")]
pub enum HierarchyUpdate {
    /// It is built, as for a still.
    Rebuild,
    /// The hierarchy of the first frame is refitted around the moved objects, if their number and
    /// kinds are unchanged.
    Refit,
    /// Chooses the method with the lower expected cost.
    #[default]
    Auto,
}

const EXPECTED: &str = "`bvh`, `brute_force` or { quality: … }";

/// A hierarchy of balanced quality.
impl Default for Acceleration {
    fn default() -> Self {
        Self::Bvh(Quality::default())
    }
}

impl Serialize for Acceleration {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        match *self {
            Self::Bvh(quality) => BvhSection { quality }.serialize(s),
            Self::BruteForce => s.serialize_str("brute_force"),
        }
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
        let BvhSection { quality } = BvhSection::deserialize(MapAccessDeserializer::new(map))?;
        Ok(Acceleration::Bvh(quality))
    }
}

/// The words of the section.
#[cfg(feature = "schema")]
#[derive(schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
#[expect(dead_code, reason = "for the schema")]
enum AccelerationWord {
    /// A bounding volume hierarchy over all shapes except planes.
    Bvh,
    /// Tests every ray against every shape: the reference for the others.
    BruteForce,
}

/// The YAML mapping of a hierarchy.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct BvhSection {
    /// The effort spent on building the hierarchy.
    quality: Quality,
}
