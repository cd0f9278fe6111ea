//! The rows of an element, one at a time.

use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};

use crate::{FileFault, Result};

/// The values of a row's properties, by their indices.
#[derive(Debug, Default)]
pub(super) struct ElementRow {
    /// The numbers; 0 for lists.
    pub(super) numbers: Vec<f64>,
    /// The lists; empty for numbers.
    pub(super) lists: Vec<Vec<f64>>,
}

impl ElementRow {
    /// Returns the numbers of some properties.
    pub(super) fn numbers<const N: usize>(&self, properties: [usize; N]) -> [f64; N] {
        properties.map(|property| self.numbers[property])
    }
}

impl<'de> DeserializeSeed<'de> for &mut ElementRow {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> std::result::Result<(), D::Error> {
        d.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for &mut ElementRow {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a row")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> std::result::Result<(), A::Error> {
        let mut i = 0;
        while map.next_key::<IgnoredAny>()?.is_some() {
            if i == self.numbers.len() {
                self.numbers.push(0.0);
                self.lists.push(Vec::new());
            }
            map.next_value_seed(Property {
                number: &mut self.numbers[i],
                list: &mut self.lists[i],
            })?;
            i += 1;
        }
        Ok(())
    }
}

/// Reads the value of one property into its place.
struct Property<'a> {
    number: &'a mut f64,
    list: &'a mut Vec<f64>,
}

impl<'de> DeserializeSeed<'de> for Property<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> std::result::Result<(), D::Error> {
        d.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Property<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number or a list of numbers")
    }

    fn visit_i64<E: Error>(self, number: i64) -> std::result::Result<(), E> {
        *self.number = number as f64;
        Ok(())
    }

    fn visit_u64<E: Error>(self, number: u64) -> std::result::Result<(), E> {
        *self.number = number as f64;
        Ok(())
    }

    fn visit_f64<E: Error>(self, number: f64) -> std::result::Result<(), E> {
        *self.number = number;
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> std::result::Result<(), A::Error> {
        self.list.clear();
        while let Some(number) = list.next_element()? {
            self.list.push(number);
        }
        Ok(())
    }
}

/// Calls `each` with each row of an element.
pub(super) struct Rows<'a, F> {
    pub(super) each: F,
    /// Number of rows begun.
    pub(super) n_rows: &'a mut u64,
    /// The fault that `each` returned.
    pub(super) fault: &'a mut Option<FileFault>,
}

impl<'de, F: FnMut(&ElementRow, u64) -> Result<()>> DeserializeSeed<'de> for Rows<'_, F> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> std::result::Result<(), D::Error> {
        d.deserialize_seq(self)
    }
}

impl<'de, F: FnMut(&ElementRow, u64) -> Result<()>> Visitor<'de> for Rows<'_, F> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("rows of an element")
    }

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut rows: A) -> std::result::Result<(), A::Error> {
        let mut row = ElementRow::default();
        loop {
            *self.n_rows += 1;
            if rows.next_element_seed(&mut row)?.is_none() {
                return Ok(());
            }
            (self.each)(&row, *self.n_rows - 1).map_err(|fault| {
                // serde-ply's error cannot carry the fault.
                *self.fault = Some(fault);
                A::Error::custom("")
            })?;
        }
    }
}
