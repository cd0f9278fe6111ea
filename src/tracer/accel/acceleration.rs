//! The choice of the structure, and of its traversal.

use serde::{Deserialize, Serialize, Serializer};

use base::{Keyword, keywords};
use world::values::{WordChoice, WordOr};

/// The structure that finds the nearest hit of a ray.
///
/// ```
/// # use raycost_tracer::accel::{Acceleration, Quality};
/// let careful: Acceleration = scene::yaml::from_str("{ quality: high }").unwrap();
/// let plain: Acceleration = scene::yaml::from_str("bvh").unwrap();
/// # assert_eq!(careful, Acceleration::Bvh(Quality::High));
/// # assert_eq!(plain, Acceleration::default());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(from = "WordOr<AccelerationWord, BvhSection>")]
pub enum Acceleration {
    /// A bounding volume hierarchy over all shapes except planes.
    Bvh(Quality),
    /// Tests every ray against every shape: the reference for the others.
    BruteForce,
}

impl Acceleration {
    /// Returns the name in files: `bvh` or `brute_force`.
    pub fn kind(self) -> &'static str {
        let word = match self {
            Self::Bvh(_) => AccelerationWord::Bvh,
            Self::BruteForce => AccelerationWord::BruteForce,
        };
        word.name()
    }

    /// Returns the quality of a hierarchy.
    pub fn quality(self) -> Option<Quality> {
        match self {
            Self::Bvh(quality) => Some(quality),
            Self::BruteForce => None,
        }
    }
}

keywords! {
    /// The effort spent on building a hierarchy. All qualities find the same hits.
    #[derive(Default)]
    pub enum Quality {
        /// Object splits only: the least build time and memory.
        Fast = "fast",
        /// Splits the triangles that fill their boxes worst before the build: up to twice the build
        /// time of `fast`.
        #[default]
        Balanced = "balanced",
        /// Spatial splits wherever they lower the SAH cost: three to ten times the build time of
        /// `fast`, and 1.5 times its memory.
        High = "high",
    }
}

keywords! {
    /// An [`Acceleration`] as one word, for the command line.
    pub enum Structure {
        /// A BVH that splits objects only: the least time to build
        Fast = "fast",
        /// A BVH after a split of the triangles that fill their boxes worst
        Balanced = "balanced",
        /// A BVH with spatial splits: the fewest tests, the longest time to build
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

keywords! {
    /// How the hierarchy of a frame is made if its objects differ from the frame before.
    #[derive(Default)]
    pub enum HierarchyUpdate {
        /// It is built, as for a still.
        Rebuild = "rebuild",
        /// The hierarchy of the first frame is refitted around the moved objects, if their number
        /// and kinds are unchanged.
        Refit = "refit",
        /// Chooses the method with the lower expected cost.
        #[default]
        Auto = "auto",
    }
}

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
            Self::BruteForce => s.serialize_str(self.kind()),
        }
    }
}

impl From<WordOr<AccelerationWord, BvhSection>> for Acceleration {
    fn from(found: WordOr<AccelerationWord, BvhSection>) -> Self {
        match found {
            WordOr::Word(AccelerationWord::Bvh) => Self::default(),
            WordOr::Word(AccelerationWord::BruteForce) => Self::BruteForce,
            WordOr::Keys(BvhSection { quality }) => Self::Bvh(quality),
        }
    }
}

keywords! {
    /// The words of the section.
    enum AccelerationWord {
        /// A bounding volume hierarchy over all shapes except planes.
        Bvh = "bvh",
        /// Tests every ray against every shape: the reference for the others.
        BruteForce = "brute_force",
    }
}

impl WordChoice for AccelerationWord {
    const EXPECTED: &'static str = "`bvh`, `brute_force` or { quality: … }";
}

/// The YAML mapping of a hierarchy.
#[derive(Deserialize, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct BvhSection {
    /// The effort spent on building the hierarchy.
    quality: Quality,
}
