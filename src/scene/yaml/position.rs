//! The positions of keys and values in a YAML text.

use std::ops::Range;

use super::fault::Fault;
use super::field_path::FieldPath;
use super::syntax;
use super::walk::walk;

/// The byte ranges of a value and its key in the text.
#[derive(Debug)]
pub(super) struct Location {
    /// True if this is the requested value, not an ancestor of it.
    pub is_exact: bool,
    /// True if the value is missing.
    pub is_empty: bool,
    key: Option<Range<usize>>,
    /// The bytes of the value; empty also for a block collection, which has no characters of its
    /// own.
    value: Range<usize>,
}

impl Location {
    /// Creates the position of a step of a path that is not itself a value.
    pub fn from_step(step: Range<usize>) -> Self {
        Self {
            is_exact: true,
            is_empty: false,
            key: Some(step),
            value: 0..0,
        }
    }

    /// Returns the same position in a text with `n_bytes` more before it.
    pub fn moved(self, n_bytes: usize) -> Self {
        let moved = |bytes: Range<usize>| bytes.start + n_bytes..bytes.end + n_bytes;
        Self {
            key: self.key.map(moved),
            value: moved(self.value),
            ..self
        }
    }

    /// Returns the same value under this key.
    pub fn with_key(self, key: Range<usize>) -> Self {
        Self {
            key: Some(key),
            ..self
        }
    }

    /// Returns the bytes of the value, or of its key if the value is empty.
    pub fn value(self) -> Range<usize> {
        if self.value.is_empty() {
            self.key.unwrap_or(self.value)
        } else {
            self.value
        }
    }

    /// Returns the bytes of the key, or of the ancestor if only that was found.
    pub fn key(self) -> Range<usize> {
        match (self.is_exact, self.key.clone()) {
            (true, Some(key)) => key,
            _ => self.value(),
        }
    }

    /// Returns the value as written in `text`; empty for a block collection.
    pub fn written<'t>(&self, text: &'t str) -> &'t str {
        &text[self.value.clone()]
    }

    /// Returns true if the value is missing, and a comment follows on the same line.
    pub fn is_hidden_by_comment(&self, text: &str) -> bool {
        let rest = &text[self.value.end..];
        self.is_empty && rest.trim_start_matches([' ', ':']).starts_with('#')
    }
}

/// Checks the rules that serde_yaml does not check, or reports without a position: syntax, a single
/// document, scalar keys, no duplicate keys, no tags, a bounded depth. The text is the value of a
/// path of `n_levels_above` steps.
pub(super) fn check(text: &str, n_levels_above: usize) -> Result<(), Fault> {
    syntax::check_characters(text)?;
    let mut is_empty = true;
    walk(text, n_levels_above, |node| {
        is_empty &= node.path.is_empty() && node.is_empty
    })?;
    if is_empty {
        // At the end of the text: the comments before it are not the mistake.
        Err(Fault::at_bytes(
            text.len()..text.len(),
            "the scene is empty",
            "expected sections such as `image: …`",
        )
        .with_help("begin with `image: { width: 400, height: 300 }`"))
    } else {
        Ok(())
    }
}

/// Locates the value at `path`, or its nearest ancestor in the text.
pub(super) fn locate(text: &str, path: &FieldPath) -> Option<Location> {
    let mut deepest: Option<(usize, Location)> = None;
    // After a syntax error, the values before it remain valid.
    let _ = walk(text, 0, |node| {
        let depth = node.path.len();
        if path.0.starts_with(node.path) && deepest.as_ref().is_none_or(|(best, _)| depth > *best) {
            let location = Location {
                is_exact: depth == path.0.len(),
                is_empty: node.is_empty,
                key: node.key.map(|span| syntax::bytes(text, span)),
                value: syntax::bytes(text, node.value),
            };
            deepest = Some((depth, location));
        }
    });
    deepest.map(|(_, location)| location)
}
