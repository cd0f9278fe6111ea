//! A word, or a mapping of keys.

use std::fmt;
use std::marker::PhantomData;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserialize, Deserializer, Error, IntoDeserializer, MapAccess, Visitor};

use base::Keyword;

/// A word or a mapping of keys, for `#[serde(from = "WordOr<W, K>")]`.
pub enum WordOr<W, K> {
    /// A word.
    Word(W),
    /// A mapping.
    Keys(K),
}

/// The words of a value that may also be a mapping of keys.
pub trait WordChoice: Keyword {
    /// Describes words and mappings in messages.
    const EXPECTED: &'static str;
}

impl<'de, W: WordChoice + Deserialize<'de>, K: Deserialize<'de>> Deserialize<'de> for WordOr<W, K> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(WordOrVisitor(PhantomData))
    }
}

struct WordOrVisitor<W, K>(PhantomData<(W, K)>);

impl<'de, W: WordChoice + Deserialize<'de>, K: Deserialize<'de>> Visitor<'de>
    for WordOrVisitor<W, K>
{
    type Value = WordOr<W, K>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(W::EXPECTED)
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Self::Value, E> {
        let expected = W::EXPECTED;
        let lists_words = W::KEYWORDS
            .iter()
            .all(|word| expected.contains(word.name()));
        if lists_words && W::from_name(word).is_none() {
            let message = format!("unknown variant `{word}`, expected {expected}");
            return Err(E::custom(message));
        }
        W::deserialize(word.into_deserializer()).map(WordOr::Word)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        K::deserialize(MapAccessDeserializer::new(map)).map(WordOr::Keys)
    }
}
