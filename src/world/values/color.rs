//! Colors: `[r, g, b]`, `"#rrggbb"`, or one number for a gray.

use std::fmt;
use std::marker::PhantomData;

use glam::Vec3;
use serde::de::value::{MapAccessDeserializer, MapDeserializer};
use serde::de::{
    Deserialize, DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Unexpected, Visitor,
};

use super::number::{NON_NEGATIVE, Number, Splat, rounded};
use crate::{integers_as_f64, kinds};

pub(super) const EXPECTED: &str = "a color: [r, g, b], \"#rrggbb\" or one number for a gray";

/// A channel of a reflectance.
pub(super) const CHANNEL: Number = Number {
    expected: "a number from 0 to 1 (not 0 to 255)",
    ranges: &[[0.0, 1.0]],
};

kinds! {
    /// A reflectance: each channel from 0 to 1.
    pub Color: Vec3 = ColorForm(CHANNEL);
    /// A radiance: each channel at least 0.
    pub Radiance: Vec3 = ColorForm(NON_NEGATIVE);
}

/// Parses red, green and blue of `#rrggbb`.
pub fn hex_color(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#').filter(|hex| hex.len() == 6)?;
    // `from_str_radix` accepts a sign too.
    let is_hex = digits.bytes().all(|digit| digit.is_ascii_hexdigit());
    let rgb = u32::from_str_radix(digits, 16).ok().filter(|_| is_hex)?;
    let [_, r, g, b] = rgb.to_be_bytes();
    Some([r, g, b])
}

/// An alternative to a color.
pub trait ColorPattern {
    /// The patterns that are a single word, without keys.
    const WORDS: &[&str] = &[];
}

/// One color, or a mapping that holds a `T`. For types that accept both:
/// `#[serde(from = "ColorOr<T>")]`.
pub enum ColorOr<T> {
    /// One color, each channel from 0 to 1.
    Color(Vec3),
    /// The value of the mapping.
    Other(T),
}

impl<'de, T: Deserialize<'de> + ColorPattern> Deserialize<'de> for ColorOr<T> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(ColorOrVisitor(CHANNEL, PhantomData))
    }
}

/// As [`ColorOr`], with a radiance as the color: each channel at least 0.
pub struct RadianceOr<T>(pub ColorOr<T>);

impl<'de, T: Deserialize<'de> + ColorPattern> Deserialize<'de> for RadianceOr<T> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(ColorOrVisitor(NON_NEGATIVE, PhantomData))
            .map(Self)
    }
}

fn vector_of(numbers: [f64; 3]) -> Vec3 {
    Vec3::from(rounded(numbers))
}

/// A color: a number for each channel.
pub struct ColorForm(pub Number);

impl ColorForm {
    fn numbers(self) -> Splat<3> {
        Splat(self.0, EXPECTED)
    }
}

impl<'de> DeserializeSeed<'de> for ColorForm {
    type Value = Vec3;

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> Result<Vec3, D::Error> {
        d.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for ColorForm {
    type Value = Vec3;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(EXPECTED)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Vec3, A::Error> {
        self.numbers().visit_seq(list).map(vector_of)
    }

    fn visit_f64<E: Error>(self, found: f64) -> Result<Vec3, E> {
        self.numbers().visit_f64(found).map(vector_of)
    }

    integers_as_f64!();

    fn visit_str<E: Error>(self, found: &str) -> Result<Vec3, E> {
        match hex_color(found) {
            Some(rgb) => Ok(Vec3::from(rgb.map(f32::from)) / 255.0),
            None => Err(E::invalid_value(Unexpected::Str(found), &EXPECTED)),
        }
    }
}

/// Visits the channels of a color, or its alternatives.
struct ColorOrVisitor<T>(Number, PhantomData<T>);

impl<'de, T: Deserialize<'de> + ColorPattern> Visitor<'de> for ColorOrVisitor<T> {
    type Value = ColorOr<T>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{EXPECTED}, or a pattern {{ … }}")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<ColorOr<T>, A::Error> {
        ColorForm(self.0).visit_seq(list).map(ColorOr::Color)
    }

    fn visit_f64<E: Error>(self, found: f64) -> Result<ColorOr<T>, E> {
        ColorForm(self.0).visit_f64(found).map(ColorOr::Color)
    }

    integers_as_f64!();

    fn visit_str<E: Error>(self, found: &str) -> Result<ColorOr<T>, E> {
        match hex_color(found) {
            None if T::WORDS.contains(&found) => {
                let word = MapDeserializer::new(std::iter::once((found, ())));
                T::deserialize(MapAccessDeserializer::new(word)).map(ColorOr::Other)
            }
            None if !T::WORDS.is_empty() => {
                let expected = format!("{EXPECTED}, or `{}`", T::WORDS.join("`, `"));
                Err(E::invalid_value(Unexpected::Str(found), &expected.as_str()))
            }
            _ => ColorForm(self.0).visit_str(found).map(ColorOr::Color),
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ColorOr<T>, A::Error> {
        T::deserialize(MapAccessDeserializer::new(map)).map(ColorOr::Other)
    }
}
