//! Metrics that a scene defines: ratios of cost arrays.

use std::fmt;
use std::sync::Mutex;

use serde::de::{Deserializer, Error, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Serialize, Serializer};

use super::PixelArray;
use base::{Keyword, locked};

/// The ratio of two cost arrays: a metric that a scene defines.
#[derive(Debug, PartialEq, Eq)]
pub struct RatioMetric {
    /// Name of the metric's array in files.
    pub name: String,
    /// Name in tables and menus.
    pub label: String,
    /// The definition, such as `primitive_tests / rays`.
    pub definition: String,
    /// The array above the line, and the array below it.
    pub parts: [PixelArray; 2],
}

/// The metrics that a scene defines, in the order of its file.
///
/// All copies refer to one list, which is kept until the program ends: equal lists are kept once.
///
/// ```
/// # use raycost_tracer::cost::{PixelArray, RatioMetrics};
/// let metrics: RatioMetrics = scene::yaml::from_str("
/// { tests_per_ray: primitive_tests / rays }
/// ").unwrap();
/// # let [metric] = metrics.list() else { panic!() };
/// # assert_eq!((&*metric.name, &*metric.label), ("tests_per_ray", "tests per ray"));
/// # assert_eq!(metric.parts, [PixelArray::PrimitiveTests, PixelArray::Rays]);
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(
        with = "std::collections::BTreeMap<String, RatioParts>",
        transform = world::values::expected::<Self>,
    )
)]
pub struct RatioMetrics(&'static [RatioMetric]);

/// The greatest number of metrics of a scene.
pub const MAX_METRICS: usize = 16;

/// The greatest number of characters of a metric's name.
const MAX_NAME: usize = 40;

impl RatioMetrics {
    /// Returns the metrics with these definitions, pairs of a name and a text such as
    /// `primitive_tests / rays`; `None` if one of them is wrong.
    pub fn parse<'a>(definitions: impl Iterator<Item = (&'a str, &'a str)>) -> Option<Self> {
        let metric = |(name, text)| Some(RatioMetric::new(name, RatioParts::parse(text)?));
        let metrics: Vec<_> = definitions.map(metric).collect::<Option<_>>()?;
        let is_fine = metrics.iter().all(|metric| metric.name_fault().is_none());
        is_fine.then(|| Self::interned(metrics))
    }

    /// Returns the list.
    pub fn list(self) -> &'static [RatioMetric] {
        self.0
    }

    fn interned(metrics: Vec<RatioMetric>) -> Self {
        static KNOWN: Mutex<Vec<&'static [RatioMetric]>> = Mutex::new(Vec::new());
        if metrics.is_empty() {
            return Self::default();
        }
        let mut known = locked(&KNOWN);
        let list = known.iter().copied().find(|list| *list == metrics);
        Self(list.unwrap_or_else(|| {
            let list = Vec::leak(metrics);
            known.push(list);
            list
        }))
    }
}

impl RatioMetric {
    fn new(name: &str, RatioParts(parts): RatioParts) -> Self {
        let [above, below] = parts.map(PixelArray::name);
        Self {
            name: name.to_owned(),
            label: name.replace('_', " "),
            definition: format!("{above} / {below}"),
            parts,
        }
    }

    /// Returns the mistake in the name and what is expected; `None` if it can name an array.
    pub fn name_fault(&self) -> Option<[String; 2]> {
        let name = &self.name;
        let is_plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
        let begins = name.starts_with(|c: char| c.is_ascii_lowercase());
        if !begins || !name.chars().all(is_plain) || name.len() > MAX_NAME {
            let expected = format!(
                "expected at most {MAX_NAME} small letters, digits and `_`, such as `tests_per_ray`"
            );
            return Some([format!("a metric cannot have the name `{name}`"), expected]);
        }
        PixelArray::from_name(name).map(|_| {
            let message = format!("there is an array `{name}` already");
            [message, "expected another name".to_owned()]
        })
    }
}

/// The array above the line, and the array below it.
struct RatioParts([PixelArray; 2]);

impl RatioParts {
    fn parse(text: &str) -> Option<Self> {
        let part = |text: &str| PixelArray::from_name(text.trim()).filter(|array| array.is_cost());
        let (above, below) = text.split_once('/')?;
        Some(Self([part(above)?, part(below)?]))
    }
}

impl<'de> Deserialize<'de> for RatioParts {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_str(RatioPartsVisitor)
    }
}

#[cfg(feature = "schema")]
world::schema_of_form!(RatioParts, |_: &mut schemars::SchemaGenerator| {
    let cost = format!("({})", PixelArray::cost_names().join("|"));
    schemars::json_schema!({ "type": "string", "pattern": format!("^ *{cost} */ *{cost} *$") })
});

struct RatioPartsVisitor;

impl Visitor<'_> for RatioPartsVisitor {
    type Value = RatioParts;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(
            f,
            "a ratio `a / b` of {}",
            PixelArray::cost_names().join(", ")
        )
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<RatioParts, E> {
        RatioParts::parse(text).ok_or_else(|| E::invalid_value(Unexpected::Str(text), &self))
    }
}

impl<'de> Deserialize<'de> for RatioMetrics {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_map(MetricsVisitor)
    }
}

impl Serialize for RatioMetrics {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        s.collect_map(
            self.0
                .iter()
                .map(|metric| (&metric.name, &metric.definition)),
        )
    }
}

struct MetricsVisitor;

impl<'de> Visitor<'de> for MetricsVisitor {
    type Value = RatioMetrics;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("names and ratios, such as { tests_per_ray: primitive_tests / rays }")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<RatioMetrics, A::Error> {
        let mut metrics: Vec<RatioMetric> = Vec::new();
        while let Some((name, parts)) = map.next_entry::<String, RatioParts>()? {
            metrics.push(RatioMetric::new(&name, parts));
            if metrics.len() > MAX_METRICS {
                let message = format!("cannot be so many, expected at most {MAX_METRICS}");
                return Err(Error::custom(message));
            }
        }
        Ok(RatioMetrics::interned(metrics))
    }
}
