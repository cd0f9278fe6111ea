//! Keywords: words that select one of a few choices, the same in YAML, in JSON and on
//! the command line, where clap lists them.

use std::fmt;
use std::marker::PhantomData;

use clap::ValueEnum;
use serde::de::{Deserialize, Deserializer, EnumAccess, Error, VariantAccess, Visitor};

/// Deserializes a keyword: one of the names that the command line accepts for a `T`.
///
/// # Errors
/// Any other value; the message lists all names.
pub fn keyword<'de, T: ValueEnum, D: Deserializer<'de>>(d: D) -> Result<T, D::Error> {
    d.deserialize_enum("keyword", &[], KeywordVisitor(PhantomData))
}

/// Implements `Deserialize` and `Serialize` for types of keywords, by [`keyword`] and
/// [`keyword_name`].
#[macro_export]
macro_rules! serde_keywords {
    ($($type:ty),+) => {$(
        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
                $crate::text::keyword(d)
            }
        }

        impl serde::Serialize for $type {
            fn serialize<S: serde::Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
                s.serialize_str(&$crate::text::keyword_name(self))
            }
        }
    )+};
}

/// Returns the name of a keyword.
pub fn keyword_name(keyword: &impl ValueEnum) -> String {
    let value = keyword.to_possible_value();
    value.map_or_else(String::new, |value| value.get_name().to_owned())
}

struct KeywordVisitor<T>(PhantomData<T>);

impl<'de, T: ValueEnum> Visitor<'de> for KeywordVisitor<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&names::<T>())
    }

    fn visit_enum<A: EnumAccess<'de>>(self, found: A) -> Result<T, A::Error> {
        let (NamedKeyword(keyword), variant) = found.variant()?;
        variant.unit_variant()?;
        Ok(keyword)
    }
}

/// A keyword parsed by its name only.
struct NamedKeyword<T>(T);

impl<'de, T: ValueEnum> Deserialize<'de> for NamedKeyword<T> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_identifier(KeywordNameVisitor(PhantomData))
    }
}

struct KeywordNameVisitor<T>(PhantomData<T>);

impl<T: ValueEnum> Visitor<'_> for KeywordNameVisitor<T> {
    type Value = NamedKeyword<T>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a name")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<NamedKeyword<T>, E> {
        let mut all = T::value_variants().iter();
        match all.find(|keyword| keyword_name(*keyword) == name) {
            Some(keyword) => Ok(NamedKeyword(keyword.clone())),
            None => {
                let names = names::<T>();
                let message = format!("unknown variant `{name}`, expected {names}");
                Err(E::custom(message))
            }
        }
    }
}

/// Lists all names, as in "`a`, `b` or `c`".
fn names<T: ValueEnum>() -> String {
    let name = |keyword| format!("`{}`", keyword_name(keyword));
    let names: Vec<String> = T::value_variants().iter().map(name).collect();
    match names.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Clone, PartialEq, ValueEnum)]
    #[value(rename_all = "snake_case")]
    enum Width {
        Narrow,
        VeryWide,
    }

    serde_keywords!(Width);

    #[test]
    fn names_are_those_of_the_command_line_and_messages_list_them() {
        let read = |json: &str| {
            let read: Result<Width, _> = serde_json::from_str(json);
            read.map_err(|error| error.to_string())
        };
        assert_eq!(read("\"very_wide\""), Ok(Width::VeryWide));
        let error = read("\"wide\"").unwrap_err();
        let expected = "unknown variant `wide`, expected `narrow` or `very_wide`";
        assert!(error.starts_with(expected), "{error}");
        assert!(read("1").is_err());
    }
}
