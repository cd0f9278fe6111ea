//! The `output` section.

use std::fmt;

use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, IntoDeserializer, MapAccess, Visitor};

use super::{Acceleration, CostMode};
use crate::yaml::{self, Fault, Path};

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

impl Extra {
    /// What it is called in scene files and on the command line.
    fn name(self) -> &'static str {
        match self {
            Self::Schedule => "schedule",
            Self::Objects => "objects",
            Self::Surface => "surface",
            Self::Bvh => "bvh",
        }
    }

    /// Whether it is made of counters.
    fn needs_counters(self) -> bool {
        self != Self::Schedule
    }
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

    /// Makes sure that all of it can be written of what is measured and built.
    ///
    /// # Errors
    /// What cannot be, and the fault of the section.
    pub(super) fn check(
        &self,
        cost: CostMode,
        acceleration: Acceleration,
    ) -> Result<(), (Extra, Fault)> {
        for &extra in &self.extras {
            let name = extra.name();
            let fault = |message: String, help: &str| {
                let output = Path::default().key("output");
                let fault = Fault::of_key(output, message, format!("asks for `{name}`"));
                Err((extra, fault.with_help(help)))
            };
            if extra.needs_counters() && !cost.has_counters() {
                let message = format!("`{name}` is made of counters, and the cost is `none`");
                return fault(message, "take `--cost counters`, or do not ask for it");
            }
            if extra == Extra::Bvh && acceleration == Acceleration::BruteForce {
                let message = format!("`{name}` shows the hierarchy, and `brute_force` has none");
                return fault(message, "take `acceleration: bvh`, or do not ask for it");
            }
        }
        Ok(())
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
