//! JSON Schemas of values, and of relations between keys.

use std::fmt::Display;
use std::marker::PhantomData;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Serialize;
use serde::de::value::{Error, UnitDeserializer};
use serde::de::{DeserializeOwned, IntoDeserializer};

use super::color::{CHANNEL, ColorForm, EXPECTED};
use super::name::{MAX_NAME, NameForm};
use super::number::{
    Between, Exactly, NON_NEGATIVE, NonEmpty, Number, NumberList, OneOrMore, Splat, Whole,
};
use super::{ColorOr, ColorPattern, RadianceOr, WordChoice, WordOr};

/// The form of a value, which has a schema.
pub trait Form {
    /// Returns the schema. Its keyword `expected` describes the value, as messages do.
    fn schema(&self, generator: &mut SchemaGenerator) -> Schema;
}

impl<F: Fn(&mut SchemaGenerator) -> Schema> Form for F {
    fn schema(&self, generator: &mut SchemaGenerator) -> Schema {
        self(generator)
    }
}

/// Implements `JsonSchema` for a type with this form.
#[doc(hidden)]
#[macro_export]
macro_rules! schema_of_form {
    ($kind:ty $(where [$($generic:tt)*])?, $form:expr) => {
        impl$(<$($generic)*>)? schemars::JsonSchema for $kind {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($kind).into()
            }

            fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
                $crate::values::Form::schema(&$form, generator)
            }
        }
    };
}

/// A value of one type or the other, for `#[schemars(with = "…")]`.
pub struct Either<A, B>(PhantomData<(A, B)>);

schema_of_form!(Either<A, B> where [A: JsonSchema, B: JsonSchema], |g: &mut SchemaGenerator| {
    json_schema!({ "anyOf": [g.subschema_for::<A>(), g.subschema_for::<B>()] })
});

schema_of_form!(WordOr<W, K> where [W: WordChoice + DeserializeOwned + JsonSchema, K: DeserializeOwned + JsonSchema], |g: &mut SchemaGenerator| {
    let mut schema = <Either<W, K>>::json_schema(g);
    expected::<WordOr<W, K>>(&mut schema);
    schema
});

/// Adds what the type's own messages expect to its schema.
pub fn expected<T: DeserializeOwned>(schema: &mut Schema) {
    let unit: UnitDeserializer<Error> = ().into_deserializer();
    let refusal = T::deserialize(unit).err().map(|error| error.to_string());
    if let Some((_, expected)) = refusal
        .as_deref()
        .and_then(|text| text.split_once(", expected "))
    {
        schema.insert("expected".to_owned(), expected.into());
    }
}

/// Adds that one of these keys, separated by blanks, is needed.
pub fn one_needed(keys: &str) -> impl Fn(&mut Schema) {
    move |schema| {
        let each = keys
            .split(' ')
            .map(|key| json_schema!({ "required": [key] }));
        require(schema, json_schema!({ "anyOf": each.collect::<Vec<_>>() }));
    }
}

/// Adds that each two of these keys, separated by blanks, exclude each other.
pub fn at_most_one(keys: &str) -> impl Fn(&mut Schema) {
    move |schema| {
        let mut rest = keys;
        while let Some((key, others)) = rest.split_once(' ') {
            excluded(key, others)(schema);
            rest = others;
        }
    }
}

/// Adds that a key excludes some others, separated by blanks.
pub fn excluded(key: &str, others: &str) -> impl Fn(&mut Schema) {
    move |schema| {
        for other in others.split(' ') {
            require(
                schema,
                json_schema!({ "not": { "required": [key, other] } }),
            );
        }
    }
}

/// Adds that exactly one of these keys, separated by blanks, is needed.
pub fn exactly_one(keys: &str) -> impl Fn(&mut Schema) {
    move |schema| {
        one_needed(keys)(schema);
        at_most_one(keys)(schema);
    }
}

fn require(schema: &mut Schema, condition: Schema) {
    let all = schema.ensure_object().entry("allOf");
    if let Some(all) = all
        .or_insert_with(|| Vec::<bool>::new().into())
        .as_array_mut()
    {
        all.push(condition.into());
    }
}

impl Form for Number {
    fn schema(&self, _: &mut SchemaGenerator) -> Schema {
        let ranges = self.ranges.iter().map(|[from, to]| {
            if from == to {
                json_schema!({ "const": from })
            } else {
                json_schema!({ "type": "number", "minimum": from, "maximum": to })
            }
        });
        any_of(ranges.collect(), self.expected)
    }
}

impl Form for Exactly {
    fn schema(&self, generator: &mut SchemaGenerator) -> Schema {
        self.0.schema(generator)
    }
}

impl<T: Serialize + Display> Form for Whole<T> {
    fn schema(&self, _: &mut SchemaGenerator) -> Schema {
        let (least, greatest) = (self.0.start(), self.0.end());
        json_schema!({
            "expected": format!("a whole number from {least} to {greatest}"),
            "type": "integer", "minimum": least, "maximum": greatest,
        })
    }
}

schema_of_form!(Between<LEAST, GREATEST> where [const LEAST: u32, const GREATEST: u32],
    Whole(LEAST..=GREATEST)
);

impl<const N: usize> Form for NumberList<N> {
    fn schema(&self, generator: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "expected": self.1,
            "type": "array", "items": self.0.schema(generator), "minItems": N, "maxItems": N,
        })
    }
}

impl<const N: usize> Form for Splat<N> {
    fn schema(&self, generator: &mut SchemaGenerator) -> Schema {
        let list: NumberList<N> = NumberList(self.0, self.1);
        any_of(
            vec![self.0.schema(generator), list.schema(generator)],
            self.1,
        )
    }
}

impl Form for OneOrMore {
    fn schema(&self, generator: &mut SchemaGenerator) -> Schema {
        let number = self.0.schema(generator);
        let list = json_schema!({ "type": "array", "items": number, "minItems": 1 });
        any_of(vec![number, list], self.1)
    }
}

impl<T: JsonSchema> Form for NonEmpty<T> {
    fn schema(&self, generator: &mut SchemaGenerator) -> Schema {
        let items = generator.subschema_for::<T>();
        json_schema!({ "type": "array", "items": items, "minItems": 1 })
    }
}

/// A text, where a number is not read as one, for `#[schemars(with = "…")]`.
pub struct Text;

schema_of_form!(Text, |_: &mut SchemaGenerator| {
    json_schema!({ "type": "string", "minLength": 1 })
});

impl Form for NameForm {
    fn schema(&self, _: &mut SchemaGenerator) -> Schema {
        json_schema!({ "expected": "a text", "type": "string", "maxLength": MAX_NAME })
    }
}

impl Form for ColorForm {
    fn schema(&self, generator: &mut SchemaGenerator) -> Schema {
        let list: NumberList<3> = NumberList(self.0, EXPECTED);
        any_of(
            vec![
                hex_color_schema(),
                self.0.schema(generator),
                list.schema(generator),
            ],
            EXPECTED,
        )
    }
}

impl<T: JsonSchema> Form for PhantomData<T> {
    fn schema(&self, generator: &mut SchemaGenerator) -> Schema {
        generator.subschema_for::<T>()
    }
}

/// Returns the schema of a color such as `#12abef`.
pub fn hex_color_schema() -> Schema {
    json_schema!({ "type": "string", "pattern": "^#[0-9a-fA-F]{6}$" })
}

fn any_of(mut schemas: Vec<Schema>, expected: &str) -> Schema {
    let mut schema = match schemas.len() {
        1 => schemas.remove(0),
        _ => json_schema!({ "anyOf": schemas }),
    };
    schema.insert("expected".to_owned(), expected.into());
    schema
}

schema_of_form!(ColorOr<T> where [T: ColorPattern + DeserializeOwned + JsonSchema], |g: &mut _| {
    color_or::<T>(ColorForm(CHANNEL), g)
});
schema_of_form!(RadianceOr<T> where [T: ColorPattern + DeserializeOwned + JsonSchema], |g: &mut _| {
    color_or::<T>(ColorForm(NON_NEGATIVE), g)
});

/// Returns the schema of a color, the words of its alternative, and the alternative.
fn color_or<T: ColorPattern + DeserializeOwned + JsonSchema>(
    color: ColorForm,
    generator: &mut SchemaGenerator,
) -> Schema {
    let other = generator.subschema_for::<T>();
    let patterns = other
        .get("oneOf")
        .and_then(|kinds| kinds.as_array())
        .into_iter()
        .flatten();
    let words = T::WORDS.iter().map(|word| {
        let mut patterns = patterns.clone();
        let with_keys = patterns.find(|pattern| pattern["required"][0] == *word);
        json_schema!({ "const": word, "description": with_keys.map(|pattern| &pattern["description"]) })
    });
    let kinds = words.chain([color.schema(generator), other.clone()]);
    let mut schema = any_of(kinds.collect(), "");
    expected::<ColorOr<T>>(&mut schema);
    schema
}
