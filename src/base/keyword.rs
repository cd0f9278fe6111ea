//! Keywords: words that select one of a few choices, the same in YAML, in JSON and on
//! the command line.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{Deserialize, Deserializer, EnumAccess, Error, VariantAccess, Visitor};

/// A choice with a name. [`keywords!`](crate::keywords) defines types of them.
pub trait Keyword: Copy + 'static {
    /// All choices that can be named, in the order of lists.
    const KEYWORDS: &'static [Self];

    /// Returns the name.
    fn name(self) -> &'static str;

    /// Returns the description in one line.
    fn help(self) -> &'static str;

    /// Returns the choice with this name.
    fn from_name(name: &str) -> Option<Self> {
        let mut all = Self::KEYWORDS.iter();
        all.find(|keyword| keyword.name() == name).copied()
    }
}

/// Defines an enum whose variants are keywords: [`Keyword`], `Deserialize`, which accepts the
/// names, and `Serialize`. The doc comment of a variant is its description, on the command line,
/// too.
///
/// ```
/// use raycost_base::Keyword;
///
/// raycost_base::keywords! {
///     /// The way from here.
///     #[derive(Default)]
///     pub enum Turn {
///         /// Straight on
///         #[default]
///         None = "none",
///         /// Toward the heart
///         Left = "left",
///     }
/// }
/// assert_eq!(Turn::from_name("left"), Some(Turn::Left));
/// assert_eq!(Turn::Left.help(), "Toward the heart");
/// ```
#[macro_export]
macro_rules! keywords {
    (
        $(#[$meta:meta])*
        $vis:vis enum $type:ident {$(
            $(#[doc = $help:literal])+
            $(#[default $($default:tt)*])?
            $keyword:ident = $name:literal,
        )+}
    ) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        $vis enum $type {$(
            $(#[doc = $help])+
            $(#[default $($default)*])?
            $keyword,
        )+}

        impl $crate::Keyword for $type {
            const KEYWORDS: &'static [Self] = &[$(Self::$keyword),+];

            fn name(self) -> &'static str {
                match self {
                    $(Self::$keyword => $name,)+
                }
            }

            fn help(self) -> &'static str {
                match self {
                    $(Self::$keyword => concat!($($help),+).trim_ascii_start(),)+
                }
            }
        }

        impl<'de> $crate::serde::Deserialize<'de> for $type {
            fn deserialize<D: $crate::serde::Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
                $crate::keyword::deserialize(d)
            }
        }

        impl $crate::serde::Serialize for $type {
            fn serialize<S: $crate::serde::Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
                s.serialize_str($crate::Keyword::name(*self))
            }
        }

        $crate::schema_of_keywords!($type);
    };
}

#[cfg(not(feature = "schema"))]
#[doc(hidden)]
#[macro_export]
macro_rules! schema_of_keywords {
    ($type:ty) => {};
}

/// Implements `JsonSchema` for a type of keywords: their names and descriptions.
#[cfg(feature = "schema")]
#[doc(hidden)]
#[macro_export]
macro_rules! schema_of_keywords {
    ($type:ty) => {
        impl $crate::schemars::JsonSchema for $type {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($type).into()
            }

            fn json_schema(_: &mut $crate::schemars::SchemaGenerator) -> $crate::schemars::Schema {
                let keywords = <Self as $crate::Keyword>::KEYWORDS.iter().map(|&keyword| {
                    let (name, help) = ($crate::Keyword::name(keyword), $crate::Keyword::help(keyword));
                    $crate::schemars::json_schema!({ "const": name, "description": help })
                });
                $crate::schemars::json_schema!({ "oneOf": keywords.collect::<Vec<_>>() })
            }
        }
    };
}

/// Deserializes a keyword.
///
/// # Errors
/// Any other value; the message lists all names.
pub fn deserialize<'de, T: Keyword, D: Deserializer<'de>>(d: D) -> Result<T, D::Error> {
    d.deserialize_enum("keyword", &[], KeywordVisitor(PhantomData))
}

struct KeywordVisitor<T>(PhantomData<T>);

impl<'de, T: Keyword> Visitor<'de> for KeywordVisitor<T> {
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

impl<'de, T: Keyword> Deserialize<'de> for NamedKeyword<T> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_identifier(KeywordNameVisitor(PhantomData))
    }
}

struct KeywordNameVisitor<T>(PhantomData<T>);

impl<T: Keyword> Visitor<'_> for KeywordNameVisitor<T> {
    type Value = NamedKeyword<T>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a name")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<NamedKeyword<T>, E> {
        T::from_name(name).map(NamedKeyword).ok_or_else(|| {
            let names = names::<T>();
            E::custom(format!("unknown variant `{name}`, expected {names}"))
        })
    }
}

/// Lists all names, as in "`a`, `b` or `c`".
fn names<T: Keyword>() -> String {
    let name = |keyword: &T| format!("`{}`", keyword.name());
    let names: Vec<String> = T::KEYWORDS.iter().map(name).collect();
    match names.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    keywords! {
        enum Width {
            /// Not wide
            Narrow = "narrow",
            /// Wider than
            /// the others
            VeryWide = "very_wide",
        }
    }

    #[test]
    fn names_are_read_and_messages_list_them() {
        let read = |json: &str| {
            let read: Result<Width, _> = serde_json::from_str(json);
            read.map_err(|error| error.to_string())
        };
        assert_eq!(read("\"very_wide\""), Ok(Width::VeryWide));
        assert_eq!(serde_json::json!(Width::VeryWide), "very_wide");
        assert_eq!(Width::VeryWide.help(), "Wider than the others");
        let error = read("\"wide\"").unwrap_err();
        let expected = "unknown variant `wide`, expected `narrow` or `very_wide`";
        assert!(error.starts_with(expected), "{error}");
        assert!(read("1").is_err());
    }
}
