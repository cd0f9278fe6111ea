//! The `plots` section of a study file.

use std::fmt;
use std::marker::PhantomData;

use schemars::JsonSchema;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};

use output::chart::Scale;
use world::kinds;
use world::values::{Either, Text, expected};

/// A plot that a study file requests.
///
/// ```
/// # use scene::yaml;
/// # use raycost_tools::study::PlotSpec;
/// let plot: PlotSpec = yaml::from_str("{ x: threads, y: render_wall_ms, fit: true }").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlotSpec {
    /// The factor or metric along the horizontal axis.
    pub x: String,
    /// The metrics along the vertical axis, of one unit.
    #[serde(with = "Names")]
    pub y: Vec<String>,
    /// The factors that distinguish series.
    #[serde(default)]
    pub by: Option<Vec<String>>,
    /// The scale of both axes; logarithmic if not given.
    #[serde(default)]
    pub scale: Scale,
    /// If true, draws a bar for each median, with the speedups of steps.
    #[serde(default)]
    pub bars: bool,
    /// If true, fits a law of the cost, a + b n^k, to each series.
    #[serde(default)]
    pub fit: bool,
}

kinds! {
    Names: Vec<String> = PhantomData::<NameOrList> => |names| names.0;
}

/// The name of a metric, or a list of names.
#[derive(JsonSchema)]
#[schemars(with = "Either<Text, Vec<String>>", transform = expected::<Self>)]
struct NameOrList(Vec<String>);

impl<'de> Deserialize<'de> for NameOrList {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(NamesVisitor).map(Self)
    }
}

struct NamesVisitor;

impl<'de> Visitor<'de> for NamesVisitor {
    type Value = Vec<String>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("the name of a metric, or a list of names")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<Vec<String>, E> {
        Ok(vec![name.to_owned()])
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Vec<String>, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(list))
    }
}
