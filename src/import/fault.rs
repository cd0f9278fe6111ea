//! The faults of geometry files, with their positions.

use std::borrow::Cow;
use std::fmt;
use std::io;
use std::path::Path;

use host::text::{Diagnostic, why_missing};

/// A fault in a geometry file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileFault {
    /// The path of the file as given; empty until it is known.
    pub(super) file: String,
    /// The position in the file, if it is known.
    pub location: Option<FileLocation>,
    /// The problem.
    pub problem: String,
    /// The expected value, as it follows the word "expected".
    pub expected: String,
}

/// A position in a geometry file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FileLocation {
    /// A line of a text file, counted from 1.
    Line(u64),
    /// An element of a binary file: its kind and its number, counted from 0.
    Element(String, u64),
}

/// Maximum number of characters that a message quotes from a file: enough to find them, and less
/// than a line of a file that is not geometry at all.
const MAX_QUOTED: usize = 24;

/// Truncates a word of a file for a message.
pub(super) fn cut(word: &str) -> Cow<'_, str> {
    match word.char_indices().nth(MAX_QUOTED) {
        None => Cow::Borrowed(word),
        Some((end, _)) => Cow::Owned(format!("{}…", &word[..end])),
    }
}

/// The expectation for a file that the system does not open.
pub(super) const READABLE: &str = "a file that can be read";

impl FileFault {
    /// Creates a fault of the file as a whole.
    pub(super) fn new(problem: impl Into<String>, expected: impl Into<String>) -> Self {
        Self {
            file: String::new(),
            location: None,
            problem: problem.into(),
            expected: expected.into(),
        }
    }

    /// Creates the fault of a mesh without materials whose object has none either.
    pub fn without_materials(path: &Path) -> Self {
        let problem = "it has no materials of its own";
        Self::new(problem, "a `material` for the object").in_file(path)
    }

    /// Creates the fault of a file whose points have no radius.
    pub fn without_radius(path: &Path) -> Self {
        let expected = "a `radius` for all points, or `radius: { array: … }`";
        Self::new("its points have no radius", expected).in_file(path)
    }

    /// Returns the same fault at this position, unless a position is known already.
    pub(super) fn at(mut self, location: FileLocation) -> Self {
        self.location.get_or_insert(location);
        self
    }

    /// Returns the same fault in this file, unless it is in another file that this one names.
    pub(super) fn in_file(mut self, path: &Path) -> Self {
        if self.file.is_empty() {
            self.file = path.display().to_string();
        }
        self
    }

    /// Returns the diagnostic of a file that the command line names.
    pub fn of_argument(&self) -> Diagnostic {
        let help = self.why_missing().unwrap_or_else(|| self.expectation());
        Diagnostic::new(self.message()).with_help(help)
    }

    /// Returns the expected value as a part of a sentence.
    pub fn expectation(&self) -> String {
        format!("expected {}", self.expected)
    }

    /// Returns the likely reason why the system does not open the file, if one is known.
    pub fn why_missing(&self) -> Option<String> {
        let is_missing = self.expected == READABLE;
        is_missing.then(|| why_missing(Path::new(&self.file)))?
    }

    /// Returns file, position and problem in one line.
    pub fn message(&self) -> String {
        let Self { file, problem, .. } = self;
        match &self.location {
            None => format!("`{file}`: {problem}"),
            Some(location) => format!("`{file}`, {location}: {problem}"),
        }
    }
}

impl From<io::Error> for FileFault {
    fn from(error: io::Error) -> Self {
        let problem = format!("cannot read it: {error}");
        Self::new(problem, READABLE)
    }
}

/// Formats `line 7` or `face 12`.
impl fmt::Display for FileLocation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(number) => write!(f, "line {number}"),
            Self::Element(kind, number) => write!(f, "{kind} {number}"),
        }
    }
}

impl fmt::Display for FileFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, expected {}", self.message(), self.expected)
    }
}

impl std::error::Error for FileFault {}
