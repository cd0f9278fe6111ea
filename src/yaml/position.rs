//! Where each key and value of a YAML text stands.

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

/// The way from the root of a YAML tree to one of its values.
#[derive(Debug, Clone, Default, PartialEq, Eq, Hash)]
pub struct Path(pub Vec<Step>);

impl Path {
    /// The path one key further down.
    pub fn key(mut self, key: impl Into<String>) -> Self {
        self.0.push(Step::Key(key.into()));
        self
    }

    /// The path one index further down.
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

/// Where a value and its key stand, in bytes of the text.
#[derive(Debug)]
pub(super) struct Place {
    /// Whether it is the value that was looked for, not one around it.
    pub is_exact: bool,
    /// Whether nothing stands where the value should.
    pub is_empty: bool,
    key: Option<Range<usize>>,
    /// Empty for a block collection too: it has no character of its own.
    value: Range<usize>,
}

impl Place {
    /// The bytes to show of the value: its key where nothing of it can be seen.
    pub fn value(self) -> Range<usize> {
        match self.value.is_empty() {
            true => self.key.unwrap_or(self.value),
            false => self.value,
        }
    }

    /// The bytes of the key; of the value around it if that is all there is.
    pub fn key(self) -> Range<usize> {
        match (self.is_exact, self.key.clone()) {
            (true, Some(key)) => key,
            _ => self.value(),
        }
    }

    /// The value as it is written in `text`, without a block collection's.
    pub fn written<'t>(&self, text: &'t str) -> &'t str {
        &text[self.value.clone()]
    }

    /// Whether a comment follows on the same line.
    pub fn is_before_comment(&self, text: &str) -> bool {
        let rest = &text[self.value.end..];
        rest.trim_start_matches([' ', ':']).starts_with('#')
    }
}

/// Checks what serde_yaml does not, or not with a position: syntax, one
/// document, keys that are words and different in one mapping, no tags.
pub(super) fn check(text: &str) -> Result<(), Fault> {
    syntax::check_characters(text)?;
    let mut is_empty = true;
    walk(text, |node| {
        is_empty &= node.path.is_empty() && node.is_empty
    })?;
    match is_empty {
        false => Ok(()),
        // Behind all comments: none of them is what is wrong.
        true => Err(Fault::of_bytes(
            text.len()..text.len(),
            "the scene is empty",
            "expected sections such as `image: …`",
        )
        .with_help("begin with `image: { width: 400, height: 300 }`")),
    }
}

/// The place of the value at `path`, or of its nearest ancestor in the text.
pub(super) fn locate(text: &str, path: &Path) -> Option<Place> {
    let mut deepest: Option<(usize, Place)> = None;
    // An error ends the walk; what was found before it stands.
    let _ = walk(text, |node| {
        let depth = node.path.len();
        if path.0.starts_with(node.path) && deepest.as_ref().is_none_or(|(best, _)| depth > *best) {
            let place = Place {
                is_exact: depth == path.0.len(),
                is_empty: node.is_empty,
                key: node.key.map(|span| syntax::bytes(text, span)),
                value: syntax::bytes(text, node.value),
            };
            deepest = Some((depth, place));
        }
    });
    deepest.map(|(_, place)| place)
}
