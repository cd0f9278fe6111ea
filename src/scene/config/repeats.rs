//! The `repeats` section.

use std::fmt;
use std::num::NonZeroU8;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::de::{Deserializer, Error, Unexpected, Visitor};
use serde::{Deserialize, Serialize, Serializer};

use world::values::Count;

/// How many times the picture is rendered to time its pixels.
///
/// ```
/// # use raycost_scene::config::Repeats;
/// let repeats: Repeats = raycost_scene::yaml::from_str("10").unwrap();
/// # assert_eq!(repeats, "10".parse().unwrap());
/// let repeats: Repeats = raycost_scene::yaml::from_str("auto").unwrap();
/// # assert_eq!(repeats, Repeats::Auto);
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, JsonSchema)]
#[schemars(rename_all = "snake_case", transform = world::values::expected::<Self>)]
pub enum Repeats {
    /// If pixels are timed, up to five times within half a second, otherwise once.
    #[default]
    Auto,
    /// Exactly this many times.
    #[schemars(untagged)]
    Exactly(#[schemars(with = "Count<255>")] NonZeroU8),
}

/// Maximum number of bytes of samples of [`Repeats::Auto`].
const MAX_SAMPLE_BYTES_OF_AUTO: usize = 64 << 20;

impl Repeats {
    /// A single rendering, whose times are not checked.
    pub const ONCE: Self = Self::Exactly(NonZeroU8::MIN);

    /// Maximum number of renderings of [`Repeats::Auto`].
    pub const MAX_OF_AUTO: u8 = 5;

    /// Returns true if timed pixels have a spread. Always true for
    /// [`Repeats::Auto`], so that the files of a scene always have the same arrays.
    pub fn has_spread(self) -> bool {
        self != Self::ONCE
    }

    /// Returns the maximum number of renderings of a picture of `n_pixels` pixels, whose samples
    /// take `sample_bytes` each.
    pub fn most(self, n_pixels: usize, sample_bytes: usize) -> u8 {
        match self {
            Self::Exactly(n) => n.get(),
            Self::Auto => {
                let fitting = MAX_SAMPLE_BYTES_OF_AUTO / (n_pixels * sample_bytes).max(1);
                fitting.clamp(1, Self::MAX_OF_AUTO.into()) as u8
            }
        }
    }
}

impl fmt::Display for Repeats {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Exactly(n) => n.fmt(f),
        }
    }
}

/// The values that scene files and the command line accept.
const EXPECTED: &str = "`auto` or a whole number from 1 to 255";

impl FromStr for Repeats {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => Ok(Self::Auto),
            number => {
                let number = number.parse().map(Self::Exactly);
                number.map_err(|_| format!("expected {EXPECTED}"))
            }
        }
    }
}

impl<'de> Deserialize<'de> for Repeats {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(RepeatsVisitor)
    }
}

impl Serialize for Repeats {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Auto => s.serialize_str("auto"),
            Self::Exactly(n) => s.serialize_u8(n.get()),
        }
    }
}

struct RepeatsVisitor;

impl Visitor<'_> for RepeatsVisitor {
    type Value = Repeats;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(EXPECTED)
    }

    fn visit_str<E: Error>(self, found: &str) -> Result<Repeats, E> {
        match found {
            "auto" => Ok(Repeats::Auto),
            _ => Err(E::invalid_value(Unexpected::Str(found), &self)),
        }
    }

    fn visit_u64<E: Error>(self, found: u64) -> Result<Repeats, E> {
        let number = u8::try_from(found).ok().and_then(NonZeroU8::new);
        let error = || E::invalid_value(Unexpected::Unsigned(found), &self);
        number.map(Repeats::Exactly).ok_or_else(error)
    }

    fn visit_i64<E: Error>(self, found: i64) -> Result<Repeats, E> {
        match u64::try_from(found) {
            Ok(found) => self.visit_u64(found),
            Err(_) => Err(E::invalid_value(Unexpected::Signed(found), &self)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parsing_inverts_formatting() {
        for text in ["auto", "1", "10", "255"] {
            let repeats: Repeats = text.parse().unwrap();
            assert_eq!(repeats.to_string(), text);
            assert_eq!(crate::yaml::from_str::<Repeats>(text).unwrap(), repeats);
        }
        for text in ["", "0", "256", "-1", "many", "Auto", "1.5"] {
            assert!(text.parse::<Repeats>().is_err(), "{text}");
        }
    }

    #[test]
    fn large_pictures_are_repeated_less_to_save_memory() {
        let most = |n_pixels| Repeats::Auto.most(n_pixels, 4);
        assert_eq!([1, 3_000_000].map(most), [5, 5]);
        assert_eq!([8_294_400, 100_000_000].map(most), [2, 1]);
        let ten: Repeats = "10".parse().unwrap();
        assert_eq!(ten.most(100_000_000, 4), 10);
    }
}
