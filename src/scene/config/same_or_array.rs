//! A single number, or an array of a file.

use std::fmt;
use std::marker::PhantomData;

use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{DeserializeOwned, Deserializer, Error, IntoDeserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize};

use world::integers_as_f64;
use world::values;

/// A number greater than 0, or an array.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[schemars(bound = "A: NumberArray + JsonSchema", transform = values::expected::<Self>)]
#[serde(untagged)]
pub enum SameOrArray<A> {
    /// The same for all.
    Same(#[serde(with = "values::Positive")] f32),
    /// One number per element, from an array.
    Array(A),
}

/// The YAML mapping of an array.
pub trait NumberArray: DeserializeOwned {
    /// The expected value: a number, or such an array.
    const EXPECTED: &'static str;
}

impl<'de, A: NumberArray> Deserialize<'de> for SameOrArray<A> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(SameOrArrayVisitor(PhantomData))
    }
}

struct SameOrArrayVisitor<A>(PhantomData<A>);

impl<'de, A: NumberArray> Visitor<'de> for SameOrArrayVisitor<A> {
    type Value = SameOrArray<A>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(A::EXPECTED)
    }

    fn visit_f64<E: Error>(self, found: f64) -> Result<Self::Value, E> {
        values::Positive::deserialize(found.into_deserializer()).map(SameOrArray::Same)
    }

    integers_as_f64!();

    fn visit_map<M: MapAccess<'de>>(self, map: M) -> Result<Self::Value, M::Error> {
        A::deserialize(MapAccessDeserializer::new(map)).map(SameOrArray::Array)
    }
}
