//! Mistakes in a YAML text.

use std::ops::Range;

use super::field_path::FieldPath;
use host::text::Diagnostic;

/// A mistake in a scene, not yet connected to a line of the text.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// The position of the mistake.
    pub spot: Spot,
    /// The mistake, in one line.
    pub message: String,
    /// The expected value; the label beside the caret.
    pub expected: String,
    /// How to correct it, if that is not obvious.
    pub help: Option<String>,
}

/// The position of a mistake.
#[derive(Debug, Clone, PartialEq)]
pub enum Spot {
    /// The value at a path.
    Value(FieldPath),
    /// The key at the end of a path.
    Key(FieldPath),
    /// A range of bytes of the text.
    Bytes(Range<usize>),
}

impl Fault {
    /// Creates a fault at the value at `path`.
    pub fn new(path: FieldPath, message: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::at(Spot::Value(path), message, expected)
    }

    /// Creates a fault at the key at the end of `path`.
    pub fn at_key(
        path: FieldPath,
        message: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::at(Spot::Key(path), message, expected)
    }

    /// Creates a fault at a range of bytes of the text.
    pub fn at_bytes(
        bytes: Range<usize>,
        message: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::at(Spot::Bytes(bytes), message, expected)
    }

    fn at(spot: Spot, message: impl Into<String>, expected: impl Into<String>) -> Self {
        Self {
            spot,
            message: message.into(),
            expected: expected.into(),
            help: None,
        }
    }

    /// Adds advice on how to correct it.
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Returns the same fault in a text with `n_bytes` more before it.
    pub(super) fn moved(mut self, n_bytes: usize) -> Self {
        if let Spot::Bytes(bytes) = &mut self.spot {
            *bytes = bytes.start + n_bytes..bytes.end + n_bytes;
        }
        self
    }

    /// Converts to a diagnostic without an excerpt, for a mistake outside of any
    /// text, such as on the command line.
    pub fn without_place(self) -> Diagnostic {
        let diagnostic = Diagnostic::new(self.message);
        match self.help {
            Some(help) => diagnostic.with_help(help),
            None => diagnostic,
        }
    }
}
