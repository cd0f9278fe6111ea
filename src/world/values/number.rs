//! Numbers in a range, and lists of them.
//!
//! All reject NaN, infinities and magnitudes above 1e15, whose squares and products would overflow
//! `f32` in the kernel.

use std::fmt;
use std::marker::PhantomData;
use std::ops::RangeInclusive;

use glam::{DVec3, Vec3};
use serde::de::{DeserializeSeed, Deserializer, Error, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Serialize, Serializer};

use crate::kinds;

/// Largest magnitude of a coordinate or length.
const MAX_MAGNITUDE: f64 = 1e15;
/// Smallest magnitude of a length that is not zero.
const MIN_LENGTH: f64 = 1e-15;

/// The numbers that a field accepts, read with 32 bits.
#[derive(Clone, Copy)]
pub struct Number {
    /// A description that follows the word "expected".
    pub expected: &'static str,
    /// The least and the greatest number of each range that is accepted.
    pub ranges: &'static [[f64; 2]],
}

/// A coordinate.
const COORDINATE: Number = Number {
    expected: "a number from -1e15 to 1e15",
    ranges: &[[-MAX_MAGNITUDE, MAX_MAGNITUDE]],
};
/// A length or an intensity greater than 0.
const POSITIVE: Number = Number {
    expected: "a number greater than 0 (1e-15 to 1e15)",
    ranges: &[[MIN_LENGTH, MAX_MAGNITUDE]],
};
pub(super) const NON_NEGATIVE: Number = Number {
    expected: "a number of at least 0 (at most 1e15)",
    ranges: &[[0.0, MAX_MAGNITUDE]],
};
const SCALE: Number = Number {
    expected: "a number other than 0 (magnitude 1e-6 to 1e6)",
    ranges: &[[-1e6, -1e-6], [1e-6, 1e6]],
};

kinds! {
    /// A length, greater than 0.
    pub Positive: f32 = POSITIVE;
    /// A number, at least 0.
    pub NonNegative: f32 = NON_NEGATIVE;
    /// The intensity of a light, at least 0, which grows with the square of all lengths.
    pub Intensity: f32 = Number {
        expected: "a number of at least 0 (at most 1e20)",
        ranges: &[[0.0, 1e20]],
    };
    /// A fraction, 0 to 1.
    pub Fraction: f32 = Number { expected: "a number from 0 to 1", ranges: &[[0.0, 1.0]] };
    /// A coordinate, or an angle in degrees, of any sign.
    pub Coordinate: f32 = COORDINATE;
    /// A length, greater than 0, with 64 bits.
    pub ExactPositive: f64 = Exactly(POSITIVE);
    /// A coordinate of a point, with 64 bits.
    pub ExactCoordinate: f64 = Exactly(COORDINATE);
    /// A whole number of 8 bits.
    pub Byte: u8 = Whole(0..=u8::MAX);
    /// Any unsigned 64-bit number, such as a seed.
    pub Unsigned: u64 = Whole(0..=u64::MAX);
    /// A width and a height: `[width, height]`, or one number for both.
    pub Size: [f32; 2] = Splat::<2>(POSITIVE, "a size [width, height], or one number for both")
        => rounded;
    /// The radii at two ends: `[from, to]`, or one number for both.
    pub Radii: [f32; 2] = Splat::<2>(POSITIVE, "a radius, or one for each end [from, to]")
        => rounded;
    /// The radii at two ends, one of which may be 0: `[from, to]`.
    pub ConeRadii: [f32; 2] = NumberList::<2>(NON_NEGATIVE, "a radius for each end [from, to]"), cone_radii;
    /// The least and the greatest length: `[from, to]` with `from <= to`, or one number for both.
    pub PositiveRange: [f32; 2] = Splat::<2>(POSITIVE, "a length, or a range [from, to]"),
        positive_range;
    /// An interval `[from, to]` of coordinates with `from < to`.
    pub Range: [f64; 2] = NumberList::<2>(COORDINATE, "a range [from, to]"), range;
    /// A point: `[x, y, z]`.
    pub Point: DVec3 = NumberList::<3>(COORDINATE, "a point [x, y, z]")
        => DVec3::from_array;
    /// A displacement, which may be zero: `[x, y, z]`.
    pub Displacement: DVec3 = NumberList::<3>(COORDINATE, "a vector [x, y, z]")
        => DVec3::from_array;
    /// A direction, `[x, y, z]` of any length but zero: the unit vector, and a unit vector as it is.
    pub Direction: Vec3 = NumberList::<3>(COORDINATE, "a direction [x, y, z]"), direction;
    /// Factors along x, y and z: `[x, y, z]`, or one number for all three.
    pub Scale: Vec3 = Splat::<3>(SCALE, "a factor, or three [x, y, z]")
        => |factors| Vec3::from(rounded(factors));
}

/// A whole number, at least `LEAST` and at most `GREATEST`.
pub struct Between<const LEAST: u32, const GREATEST: u32>;

/// A count, at least 1 and at most `MAX`.
pub type Count<const MAX: u32> = Between<1, MAX>;

impl<const LEAST: u32, const GREATEST: u32> Between<LEAST, GREATEST> {
    /// Reads a value.
    ///
    /// # Errors
    /// It is not a whole number in the range.
    pub fn deserialize<'de, D: Deserializer<'de>, T: From<u32>>(d: D) -> Result<T, D::Error> {
        Whole(LEAST..=GREATEST).deserialize(d).map(T::from)
    }

    /// Writes a value.
    ///
    /// # Errors
    /// The serializer's.
    pub fn serialize<S: Serializer>(value: &impl Serialize, s: S) -> Result<S::Ok, S::Error> {
        value.serialize(s)
    }
}

/// A number, or a list of at least one.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum OneOrList {
    /// A number.
    One(f64),
    /// A list.
    List(Vec<f64>),
}

/// A coordinate, or a list of them; the text describes both in messages.
pub fn coordinate_or_list(expected: &'static str) -> OneOrMore {
    OneOrMore(COORDINATE, expected)
}

/// A length, greater than 0, or a list of them; the text describes both in messages.
pub fn positive_or_list(expected: &'static str) -> OneOrMore {
    OneOrMore(POSITIVE, expected)
}

/// A list of at least one item; a text names an item in the message.
pub struct NonEmpty<T>(pub(super) &'static str, PhantomData<T>);

impl<T> NonEmpty<T> {
    /// Creates the form; `item` names an item in the message.
    pub fn of(item: &'static str) -> Self {
        Self(item, PhantomData)
    }
}

impl<'de, T: Deserialize<'de>> DeserializeSeed<'de> for NonEmpty<T> {
    type Value = Vec<T>;

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> Result<Vec<T>, D::Error> {
        let items = Vec::<T>::deserialize(d)?;
        if items.is_empty() {
            let expected = format!("at least one {}", self.0);
            Err(D::Error::invalid_length(0, &expected.as_str()))
        } else {
            Ok(items)
        }
    }
}

fn cone_radii(radii: [f64; 2]) -> Result<[f32; 2], &'static str> {
    match rounded(radii) {
        [0.0, 0.0] => Err("cannot be 0 at both ends, expected [from, to] with one greater than 0"),
        radii => Ok(radii),
    }
}

/// Rounds the numbers to 32 bits.
pub(super) fn rounded<const N: usize>(numbers: [f64; N]) -> [f32; N] {
    numbers.map(|number| number as f32)
}

fn direction(found: [f64; 3]) -> Result<Vec3, &'static str> {
    let found = Vec3::from(rounded(found));
    let is_unit = (found.length_squared() - 1.0).abs() <= 8.0 * f32::EPSILON;
    if is_unit {
        return Ok(found);
    }
    // Scaled first, so that no square overflows or underflows f32.
    let largest = found.abs().max_element();
    (found / largest)
        .try_normalize()
        .ok_or("invalid value: the zero vector, expected a direction [x, y, z] that is not zero")
}

fn range([from, to]: [f64; 2]) -> Result<[f64; 2], &'static str> {
    if from < to {
        Ok([from, to])
    } else {
        Err("cannot run backwards or be empty, expected a range [from, to] with from < to")
    }
}

fn positive_range(range: [f64; 2]) -> Result<[f32; 2], &'static str> {
    let [from, to] = rounded(range);
    if from <= to {
        Ok([from, to])
    } else {
        Err("cannot run backwards, expected a range [from, to] with from <= to")
    }
}

/// Defines the methods of a visitor that takes whole numbers as it takes others.
#[macro_export]
macro_rules! integers_as_f64 {
    () => {
        fn visit_i64<E: serde::de::Error>(self, found: i64) -> Result<Self::Value, E> {
            self.visit_f64(found as f64)
        }

        fn visit_u64<E: serde::de::Error>(self, found: u64) -> Result<Self::Value, E> {
            self.visit_f64(found as f64)
        }
    };
}

/// A number with 64 bits.
pub struct Exactly(pub Number);

impl Visitor<'_> for Exactly {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.0.expected)
    }

    fn visit_f64<E: Error>(self, found: f64) -> Result<f64, E> {
        let mut ranges = self.0.ranges.iter();
        if ranges.any(|[from, to]| (*from..=*to).contains(&found)) {
            Ok(found)
        } else {
            Err(E::invalid_value(Unexpected::Float(found), &self))
        }
    }

    integers_as_f64!();
}

impl<'de> DeserializeSeed<'de> for Exactly {
    type Value = f64;

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> Result<f64, D::Error> {
        d.deserialize_any(self)
    }
}

impl<'de> DeserializeSeed<'de> for Number {
    type Value = f32;

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> Result<f32, D::Error> {
        d.deserialize_any(Exactly(self)).map(|found| found as f32)
    }
}

/// A list of `N` numbers; the text describes the list in messages.
pub struct NumberList<const N: usize>(pub Number, pub &'static str);

impl<'de, const N: usize> Visitor<'de> for NumberList<N> {
    type Value = [f64; N];

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.1)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<[f64; N], A::Error> {
        let mut values = [0.0; N];
        for (i, value) in values.iter_mut().enumerate() {
            *value = list
                .next_element_seed(Exactly(self.0))?
                .ok_or_else(|| A::Error::invalid_length(i, &self.1))?;
        }
        match list.next_element::<serde::de::IgnoredAny>()? {
            None => Ok(values),
            Some(_) => Err(A::Error::invalid_length(N + 1, &self.1)),
        }
    }
}

impl<'de, const N: usize> DeserializeSeed<'de> for NumberList<N> {
    type Value = [f64; N];

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> Result<[f64; N], D::Error> {
        d.deserialize_seq(self)
    }
}

/// A list of `N` numbers, or one number for all of them.
pub struct Splat<const N: usize>(pub Number, pub &'static str);

impl<'de, const N: usize> DeserializeSeed<'de> for Splat<N> {
    type Value = [f64; N];

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> Result<[f64; N], D::Error> {
        d.deserialize_any(self)
    }
}

impl<'de, const N: usize> Visitor<'de> for Splat<N> {
    type Value = [f64; N];

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.1)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<[f64; N], A::Error> {
        NumberList(self.0, self.1).visit_seq(list)
    }

    fn visit_f64<E: Error>(self, found: f64) -> Result<[f64; N], E> {
        Exactly(self.0).visit_f64(found).map(|number| [number; N])
    }

    integers_as_f64!();
}

/// A number, or a list of at least one; the text describes both in messages.
pub struct OneOrMore(pub(super) Number, pub(super) &'static str);

impl<'de> DeserializeSeed<'de> for OneOrMore {
    type Value = OneOrList;

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> Result<OneOrList, D::Error> {
        d.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for OneOrMore {
    type Value = OneOrList;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.1)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<OneOrList, A::Error> {
        let mut values = Vec::new();
        while let Some(value) = list.next_element_seed(Exactly(self.0))? {
            values.push(value);
        }
        if values.is_empty() {
            return Err(A::Error::invalid_length(0, &"at least one number"));
        }
        Ok(OneOrList::List(values))
    }

    fn visit_f64<E: Error>(self, found: f64) -> Result<OneOrList, E> {
        Exactly(self.0).visit_f64(found).map(OneOrList::One)
    }

    integers_as_f64!();
}

/// A whole number in a range.
pub struct Whole<T>(pub RangeInclusive<T>);

impl<'de, T: TryFrom<u64> + PartialOrd + fmt::Display> DeserializeSeed<'de> for Whole<T> {
    type Value = T;

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> Result<T, D::Error> {
        d.deserialize_any(self)
    }
}

impl<'de, T: TryFrom<u64> + PartialOrd + fmt::Display> Visitor<'de> for Whole<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (least, greatest) = (self.0.start(), self.0.end());
        write!(f, "a whole number from {least} to {greatest}")
    }

    fn visit_u64<E: Error>(self, found: u64) -> Result<T, E> {
        let number = T::try_from(found).ok();
        number
            .filter(|number| self.0.contains(number))
            .ok_or_else(|| E::invalid_value(Unexpected::Unsigned(found), &self))
    }

    fn visit_i64<E: Error>(self, found: i64) -> Result<T, E> {
        match u64::try_from(found) {
            Ok(found) => self.visit_u64(found),
            Err(_) => Err(E::invalid_value(Unexpected::Signed(found), &self)),
        }
    }
}
