//! The `output` section.

use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{
    DeserializeSeed, Deserializer, Error, IntoDeserializer, MapAccess, SeqAccess, Unexpected,
    Visitor,
};
use serde::{Deserialize, Serialize, Serializer};

use super::{Acceleration, CostMode, PixelArray, RatioMetrics, Warps, WrittenArrays};
use crate::yaml::{Fault, FieldPath};
use base::{Keyword, keywords};
use world::values;

/// The optional outputs of a run, and the arrays of its VTK files.
///
/// ```
/// # use raycost_scene::config::{OptionalOutput, Outputs};
/// let outputs: Outputs = raycost_scene::yaml::from_str("
/// [objects, bvh: { max_depth: 10, min_visits: 100 }]
/// ").unwrap();
/// # assert!(outputs.has(OptionalOutput::Objects) && outputs.has(OptionalOutput::Bvh) && !outputs.has(OptionalOutput::Surface));
/// # assert_eq!((outputs.bvh.max_depth, outputs.bvh.min_visits), (10, 100));
/// let outputs: Outputs = raycost_scene::yaml::from_str("
/// { also: [objects], arrays: [RGB, time_ns] }
/// ").unwrap();
/// # assert!(outputs.has(OptionalOutput::Objects) && outputs.written_arrays().has("RGB"));
/// # assert!(!outputs.written_arrays().has("distance"));
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq, JsonSchema)]
#[schemars(with = "values::Either<Vec<OutputEntry>, OutputKeys>", transform = values::expected::<Self>)]
pub struct Outputs {
    optional: Vec<OptionalOutput>,
    arrays: Option<Vec<PixelArray>>,
    /// The nodes of the hierarchy that are written.
    pub bvh: BvhLimits,
    /// The cost that `efficiency` divides by.
    pub noise: SampleCost,
    /// The warps of `idle_lanes`.
    pub warps: Warps,
    /// Requested outputs that have nothing to show.
    left_out: Vec<OptionalOutput>,
}

keywords! {
    /// A group of files that is written on request.
    pub enum OptionalOutput {
        /// The time span and the thread of each tile
        Schedule = "schedule",
        /// The cost of each object and each material
        Objects = "objects",
        /// The cost of each primitive, on the scene's geometry
        Surface = "surface",
        /// The boxes of the hierarchy and the cost of each
        Bvh = "bvh",
        /// The linear light of each pixel, as an array of the VTK files
        Radiance = "radiance",
        /// The standard error of each pixel and the efficiency of its samples, as arrays of the VTK
        /// files
        Noise = "noise",
        /// The rays of each pixel by bounce, as an array of the VTK files
        Bounces = "bounces",
        /// The group of each pixel that was timed as a whole, as an array of the VTK files
        Groups = "groups",
        /// The tests of boxes and primitives, hits apart from misses, as arrays of the VTK files
        Tests = "tests",
        /// The idle lanes of a SIMT machine that traces the rays in warps: a table, and an array of
        /// the VTK files
        Lanes = "lanes",
        /// The linear light and all arrays of the pixels as an OpenEXR picture
        Exr = "exr",
    }
}

/// The arrays of a film beyond what every film keeps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ExtraArrays {
    /// True to keep the radiance.
    pub radiance: bool,
    /// True if VTK files also have the radiance.
    pub radiance_in_vtk: bool,
    /// The cost that `efficiency` divides by, if the noise of pixels is kept.
    pub noise: Option<SampleCost>,
    /// True to keep the color of the surface that the center sample hit.
    pub albedo: bool,
    /// True to keep the numbers of rays by bounce.
    pub bounces: bool,
    /// True if VTK files have the groups of pixels.
    pub groups: bool,
    /// True if VTK files have the tests of boxes and primitives.
    pub tests: bool,
    /// The warps that the array of idle lanes is for, if it is kept.
    pub lanes: Option<Warps>,
    /// True if a device's cycles are kept, which is known after a rendering.
    pub cycles: bool,
    /// True if the multiprocessors of a device are kept, which is known after a rendering.
    pub sm: bool,
    /// True to keep the instance that the center sample hit.
    pub instance: bool,
    /// The metrics that the scene defines; cloud and frame have an array of each.
    pub metrics: RatioMetrics,
    /// The arrays that cloud and frame have.
    pub written: WrittenArrays,
}

/// The nodes of the hierarchy that are written; all, if not given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BvhLimits {
    /// Greatest depth of a node; the root has depth 0.
    #[serde(with = "values::Between::<0, { u32::MAX }>")]
    pub max_depth: u32,
    /// Least number of rays that visited a node.
    #[serde(with = "values::Unsigned")]
    pub min_visits: u64,
}

/// The cost of a sample, for the array `efficiency`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SampleCost {
    /// A cost array, such as `time_ns`; the sum of node visits and primitive tests if not given.
    #[serde(default, with = "CostName")]
    pub cost: Option<PixelArray>,
}

world::kinds! {
    CostName: PixelArray = CostForm;
}

/// The name of a cost that is a sum over samples.
struct CostForm;

impl CostForm {
    fn names() -> Vec<&'static str> {
        let mut names = PixelArray::cost_names();
        // The greatest of all samples.
        names.retain(|&name| name != PixelArray::Depth.name());
        names
    }
}

impl<'de> DeserializeSeed<'de> for CostForm {
    type Value = PixelArray;

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> Result<PixelArray, D::Error> {
        let word = String::deserialize(d)?;
        let array =
            PixelArray::from_name(&word).filter(|array| Self::names().contains(&array.name()));
        array.ok_or_else(|| {
            let expected = format!("a cost: {}", Self::names().join(", "));
            Error::invalid_value(Unexpected::Str(&word), &expected.as_str())
        })
    }
}

impl values::Form for CostForm {
    fn schema(&self, _: &mut SchemaGenerator) -> Schema {
        json_schema!({ "enum": Self::names() })
    }
}

impl OptionalOutput {
    /// Returns true if it requires the cost attribution, and therefore counters.
    pub fn needs_attribution(self) -> bool {
        matches!(
            self,
            Self::Objects | Self::Surface | Self::Bvh | Self::Tests
        )
    }

    /// Returns true if it requires counters.
    fn needs_counters(self) -> bool {
        self.needs_attribution() || self == Self::Lanes
    }

    /// Returns true if it requires a bounding volume hierarchy.
    fn needs_hierarchy(self) -> bool {
        self == Self::Bvh
    }
}

impl BvhLimits {
    /// Returns true if they include a node of this depth that this number of rays visited.
    pub fn include(&self, depth: u32, n_visits: u64) -> bool {
        depth <= self.max_depth && n_visits >= self.min_visits
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
    /// Returns true if the output is requested.
    pub fn has(&self, requested: OptionalOutput) -> bool {
        self.optional.contains(&requested)
    }

    /// Requests the output.
    pub fn add(&mut self, requested: OptionalOutput) {
        if !self.has(requested) {
            self.optional.push(requested);
        }
    }

    /// Leaves out what this acceleration structure does not have.
    pub fn leave_out_without(&mut self, acceleration: Acceleration) {
        if acceleration == Acceleration::BruteForce {
            let left_out = |output: &mut OptionalOutput| output.needs_hierarchy();
            self.left_out.extend(self.optional.extract_if(.., left_out));
        }
    }

    /// Returns the requested outputs that have nothing to show without a hierarchy.
    pub fn left_out(&self) -> &[OptionalOutput] {
        &self.left_out
    }

    /// Checks that all requested outputs are possible with this cost.
    ///
    /// # Errors
    /// The output that is impossible, and the fault of the section.
    pub(super) fn check(&self, cost: CostMode) -> Result<(), (OptionalOutput, Fault)> {
        for &requested in &self.optional {
            let name = requested.name();
            let fault = |message: String, help: &str| {
                let output = FieldPath::default().key("output");
                let fault = Fault::at_key(output, message, format!("requests `{name}`"));
                Err((requested, fault.with_help(help)))
            };
            if requested.needs_counters() && !cost.has_counters() {
                let message = format!("`{name}` requires counters, and `cost` is `none`");
                return fault(message, "use `--cost counters`, or do not request it");
            }
        }
        Ok(())
    }

    /// Returns the chosen arrays of cloud and frame; `None` for all.
    pub fn arrays(&self) -> Option<&[PixelArray]> {
        self.arrays.as_deref()
    }

    /// Returns the arrays that cloud and frame have.
    pub fn written_arrays(&self) -> WrittenArrays {
        let chosen = self.arrays.as_deref();
        chosen.map_or(WrittenArrays::default(), WrittenArrays::only)
    }

    /// Returns the requested outputs, each once.
    pub fn iter(&self) -> impl Iterator<Item = OptionalOutput> {
        self.optional.iter().copied()
    }

    /// Returns true if no output is requested.
    pub fn is_empty(&self) -> bool {
        self.optional.is_empty()
    }
}

/// An entry of the list: a name, or a name with settings.
#[derive(Serialize, JsonSchema)]
#[schemars(with = "values::Either<OptionalOutput, Settings>", transform = values::expected::<Self>)]
#[serde(rename_all = "snake_case")]
enum OutputEntry {
    Bvh(BvhLimits),
    Noise(SampleCost),
    Lanes(Warps),
    #[serde(untagged)]
    Plain(OptionalOutput),
}

impl From<Vec<OutputEntry>> for Outputs {
    fn from(entries: Vec<OutputEntry>) -> Self {
        let mut outputs = Self::default();
        for entry in entries {
            match entry {
                OutputEntry::Plain(requested) => outputs.add(requested),
                OutputEntry::Bvh(limits) => {
                    outputs.add(OptionalOutput::Bvh);
                    outputs.bvh = limits;
                }
                OutputEntry::Noise(cost) => {
                    outputs.add(OptionalOutput::Noise);
                    outputs.noise = cost;
                }
                OutputEntry::Lanes(warps) => {
                    outputs.add(OptionalOutput::Lanes);
                    outputs.warps = warps;
                }
            }
        }
        outputs
    }
}

/// Writes the optional outputs as requested, and the arrays if some are chosen.
impl Serialize for Outputs {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        let entry = |output: OptionalOutput| match output {
            OptionalOutput::Bvh => OutputEntry::Bvh(self.bvh),
            OptionalOutput::Noise => OutputEntry::Noise(self.noise),
            OptionalOutput::Lanes => OutputEntry::Lanes(self.warps),
            plain => OutputEntry::Plain(plain),
        };
        let keys = OutputKeys {
            also: self.iter().map(entry).collect(),
            arrays: self.arrays.clone(),
        };
        keys.serialize(s)
    }
}

impl<'de> Deserialize<'de> for Outputs {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(OutputsVisitor)
    }
}

/// Deserializes a list of optional outputs, or a mapping with such a list.
struct OutputsVisitor;

impl<'de> Visitor<'de> for OutputsVisitor {
    type Value = Outputs;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a list such as [objects], or keys such as { arrays: [RGB, time_ns] }")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Outputs, A::Error> {
        Vec::<OutputEntry>::deserialize(SeqAccessDeserializer::new(list)).map(Outputs::from)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Outputs, A::Error> {
        let keys = OutputKeys::deserialize(MapAccessDeserializer::new(map))?;
        Ok(Outputs {
            arrays: keys.arrays,
            ..keys.also.into()
        })
    }
}

/// The YAML mapping of the section.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct OutputKeys {
    /// The optional outputs.
    #[serde(default)]
    also: Vec<OutputEntry>,
    /// The arrays of `hits.vtu` and `frame.vti`; all if not given.
    #[serde(default)]
    arrays: Option<Vec<PixelArray>>,
}

impl<'de> Deserialize<'de> for OutputEntry {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(OutputEntryVisitor)
    }
}

struct OutputEntryVisitor;

impl<'de> Visitor<'de> for OutputEntryVisitor {
    type Value = OutputEntry;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let outputs = OptionalOutput::KEYWORDS.iter();
        let names: Vec<String> = outputs
            .map(|output| format!("`{}`", output.name()))
            .collect();
        write!(
            f,
            "{}, {{ bvh: … }}, {{ noise: … }} or {{ lanes: … }}",
            names.join(", ")
        )
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<OutputEntry, E> {
        OptionalOutput::deserialize(word.into_deserializer()).map(OutputEntry::Plain)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<OutputEntry, A::Error> {
        Ok(
            match Settings::deserialize(MapAccessDeserializer::new(map))? {
                Settings::Bvh(limits) => OutputEntry::Bvh(limits),
                Settings::Noise(cost) => OutputEntry::Noise(cost),
                Settings::Lanes(warps) => OutputEntry::Lanes(warps),
            },
        )
    }
}

/// The YAML mapping of an entry with settings.
#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum Settings {
    /// The boxes of the hierarchy and the cost of each, within these limits.
    Bvh(BvhLimits),
    /// The standard error of each pixel, and the efficiency of its samples by this cost.
    Noise(SampleCost),
    /// The idle lanes of a SIMT machine, and an array for these warps.
    Lanes(Warps),
}
