//! Names: short strings that are displayed, compared and written to files.

use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, Visitor};

use crate::kinds;

/// Maximum number of characters of a name, a title or a key.
pub const MAX_NAME: usize = 256;

kinds! {
    /// A name: a text of at most [`MAX_NAME`] characters.
    pub Name: String = NameForm;
}

/// Returns true if the text has more than [`MAX_NAME`] characters.
pub fn is_long(text: &str) -> bool {
    text.len() > MAX_NAME && text.chars().nth(MAX_NAME).is_some()
}

/// A text of at most [`MAX_NAME`] characters.
pub(super) struct NameForm;

impl<'de> DeserializeSeed<'de> for NameForm {
    type Value = String;

    fn deserialize<D: Deserializer<'de>>(self, d: D) -> Result<String, D::Error> {
        d.deserialize_str(self)
    }
}

impl Visitor<'_> for NameForm {
    type Value = String;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a text")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<String, E> {
        if is_long(text) {
            return Err(E::custom(format!(
                "cannot be so long, expected a text of at most {MAX_NAME} characters"
            )));
        }
        Ok(text.to_owned())
    }
}
