//! Levels of factors: their form in YAML, and the flags that select them.

use std::fmt;

use schemars::JsonSchema;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{DeserializeSeed, Deserializer, Error, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use scene::config::MAX_SIDE;
use world::schema_of_form;
use world::values::{Either, NonEmpty, Whole, expected};

/// One level of a factor.
#[derive(Debug, Clone, PartialEq)]
pub struct FactorLevel {
    /// The level in the results: a number or a text.
    pub value: Value,
    /// The flags of `raycost render` that select it.
    pub flags: Vec<String>,
}

/// The form in which a study file states the levels of a factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FactorForm {
    /// A list of at least one level.
    List,
    /// A single value.
    One,
}

/// A list of at least one level.
pub(super) struct Choices<T>(pub(super) Vec<T>);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Choices<T> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        NonEmpty::of("choice").deserialize(d).map(Self)
    }
}

/// Returns the level `--flag=value` of a flag with keywords, such as `--cost=time`.
pub(super) fn keyword(flag: &str, value: impl Serialize) -> FactorLevel {
    let value = json!(value);
    let text = value.as_str().unwrap_or_default();
    FactorLevel {
        flags: vec![format!("--{flag}={text}")],
        value,
    }
}

/// Returns the level `--max-depth=depth`, from 0 to 255.
pub(super) fn max_depth(depth: u8) -> FactorLevel {
    FactorLevel {
        value: json!(depth),
        flags: vec![format!("--max-depth={depth}")],
    }
}

/// Returns the level `--set=path=value`: a number or a text in the results, and JSON if the value
/// is a list or a mapping.
pub(super) fn setting(path: &str, value: Value) -> FactorLevel {
    let json = value.to_string();
    FactorLevel {
        flags: vec![format!("--set={path}={json}")],
        value: match value {
            Value::Number(_) | Value::String(_) => value,
            _ => json.into(),
        },
    }
}

/// A number from 1 to `MAX`.
pub(super) struct BoundedCount<const MAX: u64>(u64);

schema_of_form!(BoundedCount<MAX> where [const MAX: u64], Whole(1..=MAX));

impl<const MAX: u64> BoundedCount<MAX> {
    /// Returns the level `--flag=number`.
    pub(super) fn level(self, flag: &str) -> FactorLevel {
        FactorLevel {
            value: json!(self.0),
            flags: vec![format!("--{flag}={}", self.0)],
        }
    }
}

impl<'de, const MAX: u64> Deserialize<'de> for BoundedCount<MAX> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        Whole(1..=MAX).deserialize(d).map(Self)
    }
}

/// A number from 1 to `MAX`, or `all`: as many as this machine has processors.
#[derive(JsonSchema)]
#[schemars(with = "Either<All, BoundedCount<MAX>>", transform = expected::<Self>)]
pub(super) struct ProcessorCount<const MAX: u64>(BoundedCount<MAX>);

impl<const MAX: u64> ProcessorCount<MAX> {
    /// Returns the level `--flag=number`.
    pub(super) fn level(self, flag: &str) -> FactorLevel {
        self.0.level(flag)
    }

    /// Returns the level that the launcher selects, not a flag.
    pub(super) fn level_of_launcher(self) -> FactorLevel {
        FactorLevel {
            value: json!(self.0.0),
            flags: Vec::new(),
        }
    }
}

/// As many as this machine has processors.
#[derive(JsonSchema)]
#[schemars(rename_all = "snake_case")]
#[expect(dead_code, reason = "for the schema")]
enum All {
    All,
}

impl<'de, const MAX: u64> Deserialize<'de> for ProcessorCount<MAX> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(ProcessorCountVisitor::<MAX>)
            .map(BoundedCount)
            .map(Self)
    }
}

struct ProcessorCountVisitor<const MAX: u64>;

impl<const MAX: u64> Visitor<'_> for ProcessorCountVisitor<MAX> {
    type Value = u64;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "`all` or a whole number from 1 to {MAX}")
    }

    fn visit_str<E: Error>(self, found: &str) -> Result<u64, E> {
        match found {
            "all" => Ok(std::thread::available_parallelism().map_or(1, |n| n.get() as u64)),
            _ => Err(E::invalid_value(Unexpected::Str(found), &self)),
        }
    }

    fn visit_u64<E: Error>(self, found: u64) -> Result<u64, E> {
        if (1..=MAX).contains(&found) {
            Ok(found)
        } else {
            Err(E::invalid_value(Unexpected::Unsigned(found), &self))
        }
    }
}

/// Width and height of an image in pixels: `[100, 75]`, `100x75`, or `100` for a square.
#[derive(JsonSchema)]
#[schemars(with = "Either<ImageSide, [ImageSide; 2]>", transform = expected::<Self>)]
pub(super) struct ImageSize([u64; 2]);

type ImageSide = BoundedCount<{ MAX_SIDE as u64 }>;

impl<'de> Deserialize<'de> for ImageSize {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(ImageSizeVisitor).map(Self)
    }
}

struct ImageSizeVisitor;

impl<'de> Visitor<'de> for ImageSizeVisitor {
    type Value = [u64; 2];

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a size: [100, 75], 100x75, or 100 for a square")
    }

    fn visit_str<E: Error>(self, found: &str) -> Result<[u64; 2], E> {
        let is_side = |side: &u64| (1..=u64::from(MAX_SIDE)).contains(side);
        let sides = sides_of(found).filter(|sides| sides.iter().all(is_side));
        sides.ok_or_else(|| E::invalid_value(Unexpected::Str(found), &self))
    }

    fn visit_u64<E: Error>(self, side: u64) -> Result<[u64; 2], E> {
        self.visit_str(&format!("{side}x{side}"))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<[u64; 2], A::Error> {
        let [width, height] = <[ImageSide; 2]>::deserialize(SeqAccessDeserializer::new(list))?;
        Ok([width.0, height.0])
    }
}

/// Returns the width and the height of a size such as `100x75`.
fn sides_of(size: &str) -> Option<[u64; 2]> {
    let (width, height) = size.split_once('x')?;
    Some([width.parse().ok()?, height.parse().ok()?])
}

/// Returns the number that a law of the cost grows with: a level that is a number, or the number of
/// pixels of a size; `None` for other levels.
pub(super) fn size_of_level(level: &Value) -> Option<f64> {
    let n_pixels = || {
        Some(
            sides_of(level.as_str()?)?
                .map(|side| side as f64)
                .iter()
                .product(),
        )
    };
    level.as_f64().or_else(n_pixels)
}

impl ImageSize {
    /// Returns the level `--width=width --height=height`, `widthxheight` in the results.
    pub(super) fn level(self) -> FactorLevel {
        let Self([width, height]) = self;
        FactorLevel {
            value: json!(format!("{width}x{height}")),
            flags: vec![format!("--width={width}"), format!("--height={height}")],
        }
    }
}
