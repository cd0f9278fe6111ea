//! Kinds of values in settings: numbers in a range, points and directions, colors, names. For
//! `#[serde(with = "…")]` of a field that may be an `Option`, in any format of serde: a kind checks
//! what is read, writes it as it is, and has its JSON Schema with the feature `schema`.

mod default;
mod color;
mod name;
mod number;
mod word;
#[cfg(feature = "schema")]
mod schema;

pub use color::{Color, ColorForm, ColorOr, ColorPattern, Radiance, RadianceOr, hex_color};
pub use default::{half, one, white};
pub use name::{MAX_NAME, Name, is_long};
pub use number::*;
#[cfg(feature = "schema")]
pub use schema::{
    Either, Form, Text, at_most_one, exactly_one, excluded, expected, hex_color_schema, one_needed,
};
pub use word::{WordChoice, WordOr};

/// Defines kinds of values. A row has the name, the type and the form: anything that implements
/// `DeserializeSeed`, and `Form` with the feature `schema`. After `,` a function may check and convert
/// what the form reads, with a message as its error; after `=>` it only converts.
#[macro_export]
macro_rules! kinds {
    ($($(#[$doc:meta])* $vis:vis $kind:ident: $value:ty = $form:expr $(, $check:expr)? $(=> $map:expr)?;)*) => {$(
        $(#[$doc])*
        $vis struct $kind;

        #[allow(dead_code, reason = "some values are only read")]
        impl $kind {
            /// Reads a value.
            ///
            /// # Errors
            /// It is not of this kind.
            pub fn deserialize<'de, D: serde::Deserializer<'de>, T: From<$value>>(
                d: D,
            ) -> Result<T, D::Error> {
                let found = serde::de::DeserializeSeed::deserialize($form, d)?;
                $(let found = $crate::values::apply(found, $check).map_err(serde::de::Error::custom)?;)?
                $(let found = $crate::values::apply(found, $map);)?
                Ok(T::from(found))
            }

            /// Writes a value.
            ///
            /// # Errors
            /// The serializer's.
            pub fn serialize<S: serde::Serializer>(
                value: &impl serde::Serialize,
                s: S,
            ) -> Result<S::Ok, S::Error> {
                value.serialize(s)
            }
        }

        $crate::schema_of_form!($kind, $form);
    )*};
}

/// Calls a function, whose argument the compiler then knows the type of.
#[doc(hidden)]
pub fn apply<A, B>(value: A, function: impl FnOnce(A) -> B) -> B {
    function(value)
}

#[cfg(not(feature = "schema"))]
#[doc(hidden)]
#[macro_export]
macro_rules! schema_of_form {
    ($($kind:tt)*) => {};
}
