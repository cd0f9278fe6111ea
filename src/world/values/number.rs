//! Deserializers of numbers that check their range.
//!
//! Each function is for `#[serde(deserialize_with = "…")]`, of a field that may be an `Option`. All
//! reject NaN, infinities and magnitudes above 1e15, whose squares and products would overflow
//! `f32` in the kernel.

use std::fmt;
use std::ops::RangeInclusive;

use glam::{DVec3, Vec3};
use serde::de::{DeserializeSeed, Deserializer, Error, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Serialize};

/// Largest magnitude of a coordinate or length.
const MAX_MAGNITUDE: f64 = 1e15;
/// Smallest magnitude of a length that is not zero.
const MIN_LENGTH: f64 = 1e-15;

/// The numbers that a field accepts.
#[derive(Clone, Copy)]
pub struct Number<A = fn(f64) -> bool> {
    /// A description that follows the word "expected".
    pub expected: &'static str,
    /// True if a finite number is accepted.
    pub accepts: A,
}

/// A coordinate.
const COORDINATE: Number = Number {
    expected: "a number from -1e15 to 1e15",
    accepts: |x| x.abs() <= MAX_MAGNITUDE,
};
/// A length or an intensity greater than 0.
const POSITIVE: Number = Number {
    expected: "a number greater than 0 (1e-15 to 1e15)",
    accepts: |x| (MIN_LENGTH..=MAX_MAGNITUDE).contains(&x),
};
pub(super) const NON_NEGATIVE: Number = Number {
    expected: "a number of at least 0 (at most 1e15)",
    accepts: |x| (0.0..=MAX_MAGNITUDE).contains(&x),
};
/// The intensity of a light, which grows with the square of all lengths.
const INTENSITY: Number = Number {
    expected: "a number of at least 0 (at most 1e20)",
    accepts: |x| (0.0..=1e20).contains(&x),
};
/// A fraction.
const FRACTION: Number = Number {
    expected: "a number from 0 to 1",
    accepts: |x| (0.0..=1.0).contains(&x),
};
const SCALE: Number = Number {
    expected: "a number other than 0 (magnitude 1e-6 to 1e6)",
    accepts: |x| (1e-6..=1e6).contains(&x.abs()),
};

/// Reads a length, greater than 0.
pub fn positive<'de, D: Deserializer<'de>, T: From<f32>>(d: D) -> Result<T, D::Error> {
    POSITIVE.deserialize(d).map(T::from)
}

/// Reads the intensity of a light, at least 0.
pub fn intensity<'de, D: Deserializer<'de>, T: From<f32>>(d: D) -> Result<T, D::Error> {
    INTENSITY.deserialize(d).map(T::from)
}

/// Reads a number, at least 0.
pub fn non_negative<'de, D: Deserializer<'de>, T: From<f32>>(d: D) -> Result<T, D::Error> {
    NON_NEGATIVE.deserialize(d).map(T::from)
}

/// Reads a fraction, 0 to 1.
pub fn fraction<'de, D: Deserializer<'de>, T: From<f32>>(d: D) -> Result<T, D::Error> {
    FRACTION.deserialize(d).map(T::from)
}

/// Reads a coordinate, or an angle in degrees, of any sign.
pub fn coordinate<'de, D: Deserializer<'de>, T: From<f32>>(d: D) -> Result<T, D::Error> {
    COORDINATE.deserialize(d).map(T::from)
}

/// Reads a number in `range`; the text describes it in messages.
pub fn within<'de, D: Deserializer<'de>, T: From<f32>>(
    d: D,
    range: RangeInclusive<f64>,
    expected: &'static str,
) -> Result<T, D::Error> {
    let accepts = |number| range.contains(&number);
    Number { expected, accepts }.deserialize(d).map(T::from)
}

/// Reads a length, greater than 0, with 64 bits.
pub fn exact_positive<'de, D: Deserializer<'de>>(d: D) -> Result<f64, D::Error> {
    Exactly(POSITIVE).deserialize(d)
}

/// Reads a coordinate of a point, with 64 bits.
pub fn exact_coordinate<'de, D: Deserializer<'de>>(d: D) -> Result<f64, D::Error> {
    Exactly(COORDINATE).deserialize(d)
}

/// Reads a count, at least 1 and at most `MAX`.
pub fn count<'de, D: Deserializer<'de>, const MAX: u32>(d: D) -> Result<u32, D::Error> {
    between::<D, u32, 1, MAX>(d)
}

/// Reads a whole number, at least `LEAST` and at most `GREATEST`.
pub fn between<'de, D, T, const LEAST: u32, const GREATEST: u32>(d: D) -> Result<T, D::Error>
where
    D: Deserializer<'de>,
    T: From<u32>,
{
    whole(d, LEAST..=GREATEST).map(T::from)
}

/// Reads a whole number of 8 bits.
pub fn byte<'de, D: Deserializer<'de>>(d: D) -> Result<u8, D::Error> {
    whole(d, 0..=u8::MAX)
}

/// Reads any unsigned 64-bit number, such as a seed.
pub fn unsigned<'de, D: Deserializer<'de>>(d: D) -> Result<u64, D::Error> {
    whole(d, 0..=u64::MAX)
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

/// Reads a coordinate, or a list of them; the text describes both in messages.
pub fn coordinate_or_list<'de, D: Deserializer<'de>>(
    d: D,
    expected: &'static str,
) -> Result<OneOrList, D::Error> {
    d.deserialize_any(OneOrListVisitor(COORDINATE, expected))
}

/// Reads a length, greater than 0, or a list of them; the text describes both in messages.
pub fn positive_or_list<'de, D: Deserializer<'de>>(
    d: D,
    expected: &'static str,
) -> Result<OneOrList, D::Error> {
    d.deserialize_any(OneOrListVisitor(POSITIVE, expected))
}

/// Reads a whole number in `range`.
///
/// # Errors
/// The value is not a whole number in `range`.
pub fn whole<'de, D, T>(d: D, range: RangeInclusive<T>) -> Result<T, D::Error>
where
    D: Deserializer<'de>,
    T: TryFrom<u64> + PartialOrd + fmt::Display,
{
    d.deserialize_any(Whole(range))
}

/// Reads a list of at least one item; `kind` names an item in the message.
pub fn non_empty<'de, D, T>(d: D, kind: &str) -> Result<Vec<T>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    let items = Vec::<T>::deserialize(d)?;
    if items.is_empty() {
        Err(D::Error::invalid_length(
            0,
            &format!("at least one {kind}").as_str(),
        ))
    } else {
        Ok(items)
    }
}

/// Reads a width and a height: `[width, height]`, or one number for both.
pub fn size<'de, D: Deserializer<'de>>(d: D) -> Result<[f32; 2], D::Error> {
    let expected = "a size [width, height], or one number for both";
    d.deserialize_any(Splat(NumberList(POSITIVE, expected)))
        .map(rounded)
}

/// Reads the radii at two ends: `[from, to]`, or one number for both.
pub fn radii<'de, D: Deserializer<'de>>(d: D) -> Result<[f32; 2], D::Error> {
    let expected = "a radius, or one for each end [from, to]";
    d.deserialize_any(Splat(NumberList(POSITIVE, expected)))
        .map(rounded)
}

/// Reads the radii at two ends, one of which may be 0: `[from, to]`.
pub fn cone_radii<'de, D: Deserializer<'de>>(d: D) -> Result<[f32; 2], D::Error> {
    let expected = "a radius for each end [from, to]";
    let radii = rounded(d.deserialize_seq(NumberList(NON_NEGATIVE, expected))?);
    if radii == [0.0; 2] {
        let message = "cannot be 0 at both ends, expected [from, to] with one greater than 0";
        return Err(D::Error::custom(message));
    }
    Ok(radii)
}

/// Rounds the numbers to 32 bits.
pub(super) fn rounded<const N: usize>(numbers: [f64; N]) -> [f32; N] {
    numbers.map(|number| number as f32)
}

/// Reads a point: `[x, y, z]`.
pub fn point<'de, D: Deserializer<'de>, T: From<DVec3>>(d: D) -> Result<T, D::Error> {
    d.deserialize_seq(NumberList(COORDINATE, "a point [x, y, z]"))
        .map(|point| DVec3::from_array(point).into())
}

/// Reads a displacement, which may be zero: `[x, y, z]`.
pub fn vector<'de, D: Deserializer<'de>>(d: D) -> Result<DVec3, D::Error> {
    d.deserialize_seq(NumberList(COORDINATE, "a vector [x, y, z]"))
        .map(DVec3::from_array)
}

/// Reads a direction, `[x, y, z]` of any length but zero; returns the unit
/// vector, and a unit vector as it is.
pub fn direction<'de, D: Deserializer<'de>, T: From<Vec3>>(d: D) -> Result<T, D::Error> {
    let found = d.deserialize_seq(NumberList(COORDINATE, "a direction [x, y, z]"))?;
    let found = Vec3::from(rounded(found));
    let is_unit = (found.length_squared() - 1.0).abs() <= 8.0 * f32::EPSILON;
    if is_unit {
        return Ok(found.into());
    }
    // Scaled first, so that no square overflows or underflows f32.
    let largest = found.abs().max_element();
    let unit = (found / largest).try_normalize();
    unit.map(T::from).ok_or_else(|| {
        D::Error::invalid_value(
            Unexpected::Other("the zero vector"),
            &"a direction [x, y, z] that is not zero",
        )
    })
}

/// Reads factors along x, y and z: `[x, y, z]`, or one number for all three.
pub fn scale<'de, D: Deserializer<'de>>(d: D) -> Result<Vec3, D::Error> {
    d.deserialize_any(Splat(NumberList(SCALE, "a factor, or three [x, y, z]")))
        .map(|factors| Vec3::from(rounded(factors)))
}

/// Reads an interval `[from, to]` of coordinates with `from < to`.
pub fn range<'de, D: Deserializer<'de>>(d: D) -> Result<[f64; 2], D::Error> {
    let [from, to] = d.deserialize_seq(NumberList(COORDINATE, "a range [from, to]"))?;
    if from < to {
        Ok([from, to])
    } else {
        Err(D::Error::custom(
            "cannot run backwards or be empty, expected a range [from, to] with from < to",
        ))
    }
}

/// Reads the least and the greatest length: `[from, to]` with `from <= to`, or
/// one number for both.
pub fn positive_range<'de, D: Deserializer<'de>>(d: D) -> Result<[f32; 2], D::Error> {
    let range = NumberList(POSITIVE, "a length, or a range [from, to]");
    let [from, to] = rounded(d.deserialize_any(Splat(range))?);
    if from <= to {
        Ok([from, to])
    } else {
        Err(D::Error::custom(
            "cannot run backwards, expected a range [from, to] with from <= to",
        ))
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
struct Exactly<A>(Number<A>);

impl<'de, A: Fn(f64) -> bool> Visitor<'de> for Exactly<A> {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.0.expected)
    }

    fn visit_f64<E: Error>(self, found: f64) -> Result<f64, E> {
        if found.is_finite() && (self.0.accepts)(found) {
            Ok(found)
        } else {
            Err(E::invalid_value(Unexpected::Float(found), &self))
        }
    }

    integers_as_f64!();
}

impl<'de, A: Fn(f64) -> bool> DeserializeSeed<'de> for Exactly<A> {
    type Value = f64;

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> Result<f64, D::Error> {
        d.deserialize_any(self)
    }
}

impl<'de, A: Fn(f64) -> bool> DeserializeSeed<'de> for Number<A> {
    type Value = f32;

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> Result<f32, D::Error> {
        d.deserialize_any(Exactly(self)).map(|found| found as f32)
    }
}

/// Reads a list of `N` numbers; the text describes the list in messages.
pub(super) struct NumberList<const N: usize>(pub Number, pub &'static str);

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

/// Reads a list of `N` numbers, or one number for all of them.
pub(super) struct Splat<const N: usize>(pub NumberList<N>);

impl<'de, const N: usize> Visitor<'de> for Splat<N> {
    type Value = [f64; N];

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.0.1)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<[f64; N], A::Error> {
        self.0.visit_seq(list)
    }

    fn visit_f64<E: Error>(self, found: f64) -> Result<[f64; N], E> {
        Exactly(self.0.0).visit_f64(found).map(|number| [number; N])
    }

    integers_as_f64!();
}

/// Reads a number, or a list of them; the text describes both in messages.
struct OneOrListVisitor(Number, &'static str);

impl<'de> Visitor<'de> for OneOrListVisitor {
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

/// Visits a whole number in a range.
struct Whole<T>(RangeInclusive<T>);

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
