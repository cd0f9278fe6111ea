//! The rows of an element, one at a time.

use std::fmt;
use std::marker::PhantomData;

use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, Error, SeqAccess, Visitor};

use crate::import::{FileFault, Result};

/// Calls `each` with each row `T` of an element.
pub(super) struct Rows<'a, T, F> {
    each: F,
    /// Number of rows begun.
    n_rows: &'a mut u64,
    /// The fault that `each` returned.
    fault: &'a mut Option<FileFault>,
    row: PhantomData<T>,
}

impl<'a, T, F: FnMut(T) -> Result<()>> Rows<'a, T, F> {
    pub(super) fn new(each: F, n_rows: &'a mut u64, fault: &'a mut Option<FileFault>) -> Self {
        Self {
            each,
            n_rows,
            fault,
            row: PhantomData,
        }
    }
}

impl<'de, T: Deserialize<'de>, F: FnMut(T) -> Result<()>> DeserializeSeed<'de> for Rows<'_, T, F> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> std::result::Result<(), D::Error> {
        d.deserialize_seq(self)
    }
}

impl<'de, T: Deserialize<'de>, F: FnMut(T) -> Result<()>> Visitor<'de> for Rows<'_, T, F> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("rows of an element")
    }

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut rows: A) -> std::result::Result<(), A::Error> {
        loop {
            *self.n_rows += 1;
            let Some(row) = rows.next_element()? else {
                return Ok(());
            };
            (self.each)(row).map_err(|fault| {
                // serde-ply's error cannot carry the fault.
                *self.fault = Some(fault);
                A::Error::custom("")
            })?;
        }
    }
}
