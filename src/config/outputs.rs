//! The `output` section.

use std::fmt;

use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, IntoDeserializer, MapAccess, Visitor};

use crate::yaml;

/// What is written beside the files of every run.
///
/// ```
/// # use raycost::config::{Extra, Outputs};
/// let outputs: Outputs = raycost::yaml::from_str("
/// [objects, bvh: { max_depth: 10, min_visits: 100 }]
/// ").unwrap();
/// # assert!(outputs.has(Extra::Objects) && outputs.has(Extra::Bvh) && !outputs.has(Extra::Surface));
/// # assert_eq!((outputs.bvh.max_depth, outputs.bvh.min_visits), (10, 100));
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize)]
#[serde(from = "Vec<Entry>")]
pub struct Outputs {
    extras: Vec<Extra>,
    /// Which nodes of the hierarchy are shown.
    pub bvh: BvhLimits,
}

/// A group of files that is written where it is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Extra {
    /// When each tile was rendered, and by which thread
    Schedule,
    /// What each object and each material costs
    Objects,
    /// What each primitive costs, on the scene's geometry
    Surface,
    /// The boxes of the hierarchy and what each costs
    Bvh,
}

/// Which nodes of the hierarchy are shown: all, if not given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BvhLimits {
    /// Edges from the root to the deepest node.
    #[serde(deserialize_with = "depth")]
    pub max_depth: u32,
    /// Rays that have come to the node.
    #[serde(deserialize_with = "visits")]
    pub min_visits: u64,
}

fn depth<'de, D: Deserializer<'de>>(d: D) -> Result<u32, D::Error> {
    yaml::whole(d, 0..=u32::MAX)
}

fn visits<'de, D: Deserializer<'de>>(d: D) -> Result<u64, D::Error> {
    yaml::whole(d, 0..=u64::MAX)
}

impl Default for BvhLimits {
    fn default() -> Self {
        Self {
            max_depth: u32::MAX,
            min_visits: 0,
        }
    }
}

impl Outputs {
    /// Whether these files are asked for.
    pub fn has(&self, extra: Extra) -> bool {
        self.extras.contains(&extra)
    }

    /// Asks for these files, too.
    pub fn add(&mut self, extra: Extra) {
        if !self.has(extra) {
            self.extras.push(extra);
        }
    }

    /// Whether nothing is asked for.
    pub fn is_empty(&self) -> bool {
        self.extras.is_empty()
    }
}

/// A name, or a name with its settings.
enum Entry {
    Plain(Extra),
    Bvh(BvhLimits),
}

impl From<Vec<Entry>> for Outputs {
    fn from(entries: Vec<Entry>) -> Self {
        let mut outputs = Self::default();
        for entry in entries {
            match entry {
                Entry::Plain(extra) => outputs.add(extra),
                Entry::Bvh(limits) => {
                    outputs.add(Extra::Bvh);
                    outputs.bvh = limits;
                }
            }
        }
        outputs
    }
}

impl<'de> Deserialize<'de> for Entry {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(EntryVisitor)
    }
}

struct EntryVisitor;

impl<'de> Visitor<'de> for EntryVisitor {
    type Value = Entry;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("`schedule`, `objects`, `surface`, `bvh` or { bvh: … }")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Entry, E> {
        Extra::deserialize(word.into_deserializer()).map(Entry::Plain)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Entry, A::Error> {
        let settings = Settings::deserialize(MapAccessDeserializer::new(map))?;
        Ok(Entry::Bvh(settings.bvh))
    }
}

/// The mapping that carries settings.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Settings {
    bvh: BvhLimits,
}
