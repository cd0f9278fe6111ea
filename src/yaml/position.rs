//! The positions of keys and values in a YAML text.

use std::fmt;
use std::ops::Range;

use super::diagnostic::Fault;
use super::syntax;
use super::walk::walk;

/// One step down a YAML tree.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Step {
    /// Into a mapping.
    Key(String),
    /// Into a sequence, 0 is the first.
    Index(usize),
}

/// The path from the root of a YAML tree to one of its values.
#[derive(Debug, Clone, Default, PartialEq, Eq, Hash)]
pub struct Path(pub Vec<Step>);

impl Path {
    /// Appends a key.
    pub fn key(mut self, key: impl Into<String>) -> Self {
        self.0.push(Step::Key(key.into()));
        self
    }

    /// Appends an index.
    pub fn index(mut self, index: usize) -> Self {
        self.0.push(Step::Index(index));
        self
    }
}

/// `objects[2].sphere.radius`
impl fmt::Display for Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (depth, step) in self.0.iter().enumerate() {
            match step {
                Step::Key(key) if depth == 0 => write!(f, "{key}")?,
                Step::Key(key) => write!(f, ".{key}")?,
                Step::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}

/// The byte ranges of a value and its key in the text.
#[derive(Debug)]
pub(super) struct Location {
    /// Whether this is the requested value, not an ancestor of it.
    pub is_exact: bool,
    /// Whether the value is missing.
    pub is_empty: bool,
    key: Option<Range<usize>>,
    /// Also empty for a block collection, which has no character of its own.
    value: Range<usize>,
}

impl Location {
    /// Returns the bytes of the value, or of its key if the value has none.
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

    /// Whether a comment follows on the same line.
    pub fn is_before_comment(&self, text: &str) -> bool {
        let rest = &text[self.value.end..];
        rest.trim_start_matches([' ', ':']).starts_with('#')
    }
}

/// Checks what serde_yaml does not check, or reports without a position:
/// syntax, a single document, scalar keys, no duplicate keys, no tags.
pub(super) fn check(text: &str) -> Result<(), Fault> {
    syntax::check_characters(text)?;
    let mut is_empty = true;
    walk(text, |node| {
        is_empty &= node.path.is_empty() && node.is_empty
    })?;
    if is_empty {
        // At the end of the text: the comments before it are not the mistake.
        Err(Fault::of_bytes(
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
pub(super) fn locate(text: &str, path: &Path) -> Option<Location> {
    let mut deepest: Option<(usize, Location)> = None;
    // After a syntax error the values before it remain valid.
    let _ = walk(text, |node| {
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
