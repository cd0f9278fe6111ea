//! Levels of factors: their forms in YAML.

use std::fmt;

use schemars::JsonSchema;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{DeserializeSeed, Deserializer, Error, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Serialize, Serializer};
use serde_json::Value;

use base::{Keyword, keywords};
use scene::config::MAX_SIDE;
use world::schema_of_form;
use world::values::{Either, Whole, expected};

/// The form in which a study file states the levels of a factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FactorForm {
    /// A list of at least one level.
    List,
    /// A single value.
    One,
}

/// A number from `MIN` to `MAX`.
#[derive(Serialize)]
pub(super) struct BoundedCount<const MAX: u64, const MIN: u64 = 1>(u64);

schema_of_form!(BoundedCount<MAX, MIN> where [const MAX: u64, const MIN: u64], Whole(MIN..=MAX));

impl<'de, const MAX: u64, const MIN: u64> Deserialize<'de> for BoundedCount<MAX, MIN> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        Whole(MIN..=MAX).deserialize(d).map(Self)
    }
}

/// A number from 1 to `MAX`, or `all`: as many as this machine has processors.
#[derive(Serialize, JsonSchema)]
#[schemars(with = "Either<All, BoundedCount<MAX>>", transform = expected::<Self>)]
pub(super) struct ProcessorCount<const MAX: u64>(BoundedCount<MAX>);

keywords! {
    /// The number of processors as a word.
    enum All {
        /// As many as this machine has processors.
        All = "all",
    }
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
        let number = |All::All| std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
        let unknown = || E::invalid_value(Unexpected::Str(found), &self);
        All::from_name(found).map(number).ok_or_else(unknown)
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

/// Writes `100x75`, as results and plots show sizes.
impl Serialize for ImageSize {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        let Self([width, height]) = self;
        s.collect_str(&format_args!("{width}x{height}"))
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

/// Returns a level as text, without quotes.
pub(super) fn text_of(level: &Value) -> String {
    level
        .as_str()
        .map_or_else(|| level.to_string(), str::to_owned)
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
