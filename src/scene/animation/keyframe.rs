//! Keyframes, their values, and the interpolation between them.

use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserializer, Error, IntoDeserializer, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};

use super::MAX_FRAMES;
use base::keywords;
use world::integers_as_f64;
use world::values;

/// A value at a frame.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(
    deny_unknown_fields,
    expecting = "a keyframe such as { frame: 0, value: 1 }"
)]
pub struct Keyframe {
    /// The number of the frame; the first is 0.
    #[serde(with = "values::Between::<0, { MAX_FRAMES - 1 }>")]
    pub frame: u32,
    /// The value at this frame.
    pub value: KeyframeValue,
    /// The interpolation until the next keyframe.
    #[serde(default)]
    pub interpolation: Option<Interpolation>,
}

keywords! {
    /// The interpolation between two keyframes.
    #[derive(Default)]
    pub enum Interpolation {
        /// By the same amount in each frame.
        #[default]
        Linear = "linear",
        /// By a cubic curve that begins and ends at rest.
        Smooth = "smooth",
    }
}

/// A number, or a list of numbers: a vector or a color.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[schemars(transform = values::expected::<Self>)]
#[serde(untagged)]
pub enum KeyframeValue {
    /// One number.
    Number(#[schemars(with = "values::ExactCoordinate")] f64),
    /// At least one number.
    List(#[schemars(schema_with = "list_or_color")] Vec<f64>),
}

/// Maximum length of a list: the entries of a 4 x 4 matrix.
const MAX_NUMBERS: usize = 16;
const EXPECTED: &str = "a number, a list of numbers or a color \"#rrggbb\"";

impl KeyframeValue {
    /// Returns the numbers.
    pub fn numbers(&self) -> &[f64] {
        match self {
            Self::Number(number) => std::slice::from_ref(number),
            Self::List(numbers) => numbers,
        }
    }

    /// Describes the kind of value, for messages.
    pub(super) fn kind(&self) -> String {
        match self {
            Self::Number(_) => "a number".to_owned(),
            Self::List(numbers) => format!("a list of {}", numbers.len()),
        }
    }

    /// Returns a value of the same kind.
    pub(super) fn with_numbers(&self, numbers: impl Iterator<Item = f64>) -> Self {
        match self {
            Self::Number(number) => Self::Number(numbers.into_iter().next().unwrap_or(*number)),
            Self::List(_) => Self::List(numbers.collect()),
        }
    }
}

/// Formats as YAML.
impl fmt::Display for KeyframeValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::List(numbers) => {
                let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
                write!(f, "[{}]", numbers.join(", "))
            }
        }
    }
}

impl<'de> Deserialize<'de> for KeyframeValue {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(ValueVisitor)
    }
}

struct ValueVisitor;

impl<'de> Visitor<'de> for ValueVisitor {
    type Value = KeyframeValue;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(EXPECTED)
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<KeyframeValue, E> {
        values::ExactCoordinate::deserialize(number.into_deserializer()).map(KeyframeValue::Number)
    }

    integers_as_f64!();

    fn visit_str<E: Error>(self, text: &str) -> Result<KeyframeValue, E> {
        let rgb = values::hex_color(text)
            .ok_or_else(|| E::invalid_type(serde::de::Unexpected::Str(text), &self))?;
        let channels = rgb.map(|channel| f64::from(f32::from(channel) / 255.0));
        Ok(KeyframeValue::List(channels.to_vec()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<KeyframeValue, A::Error> {
        let mut numbers = Vec::new();
        while let Some(Coordinate(number)) = list.next_element()? {
            if numbers.len() == MAX_NUMBERS {
                return Err(A::Error::invalid_length(
                    numbers.len() + 1,
                    &format!("at most {MAX_NUMBERS} numbers").as_str(),
                ));
            }
            numbers.push(number);
        }
        if numbers.is_empty() {
            return Err(A::Error::invalid_length(0, &EXPECTED));
        }
        Ok(KeyframeValue::List(numbers))
    }
}

fn list_or_color(generator: &mut SchemaGenerator) -> Schema {
    let items = generator.subschema_for::<values::ExactCoordinate>();
    let list = json_schema!({
        "type": "array", "items": items, "minItems": 1, "maxItems": MAX_NUMBERS,
    });
    json_schema!({ "anyOf": [values::hex_color_schema(), list] })
}

/// A number of a list.
#[derive(Deserialize)]
struct Coordinate(#[serde(with = "values::ExactCoordinate")] f64);
