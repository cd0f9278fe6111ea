//! Attempts to parse a value at a path of an otherwise empty file.

use serde_json::{Map, Value};

use scene::yaml::{FieldPath, Step, YamlFile, refusal};

/// The parser's answer to a value.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Outcome {
    /// The value is accepted; missing others do not count against it.
    Accepted,
    /// The value is refused, or a value inside it at this path.
    Refused(Vec<Step>, String),
}

impl Outcome {
    pub(super) fn is_accepted(&self) -> bool {
        *self == Self::Accepted
    }

    /// Returns the message about the value itself, not about a value inside it.
    pub(super) fn own_message(&self) -> Option<&str> {
        match self {
            Self::Refused(below, message) if below.is_empty() => Some(message),
            _ => None,
        }
    }

    /// Returns the message about the value or a value inside it.
    pub(super) fn message(&self) -> Option<&str> {
        match self {
            Self::Refused(_, message) => Some(message),
            Self::Accepted => None,
        }
    }
}

/// Parses a `T` whose value at `path` is `value`.
pub(super) fn attempt<T: YamlFile>(path: &[Step], value: Value) -> Outcome {
    let wrap = |inside: Value, step: &Step| match step {
        Step::Key(key) => Value::Object(Map::from_iter([(key.clone(), inside)])),
        Step::Index(_) => Value::Array(vec![inside]),
    };
    let file = path.iter().rev().fold(value, wrap);
    match refusal::<T>(&file.to_string()) {
        Some((FieldPath(found), message)) if found.starts_with(path) => {
            Outcome::Refused(found[path.len()..].to_vec(), message)
        }
        // From a choice, such as a word that takes no value.
        Some((_, message)) if message.starts_with("invalid type") => {
            Outcome::Refused(Vec::new(), message)
        }
        // The value was read; then others were missing.
        _ => Outcome::Accepted,
    }
}

/// Returns the words in backquotes after the word "expected".
pub(super) fn quoted(message: &str) -> impl Iterator<Item = &str> {
    let expected = message
        .split_once(", expected ")
        .map_or("", |(_, expected)| expected);
    expected.split('`').skip(1).step_by(2)
}
