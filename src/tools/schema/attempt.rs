//! Attempts to parse a value at a path of a file that has nothing else.

use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use scene::yaml::{FieldPath, Step, refusal};

/// The parser's answer to a value.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Outcome {
    /// It accepts the value; that the file lacks others is no fault of the value.
    Accepted,
    /// It refuses the value, or one inside of it at this path.
    Refused(Vec<Step>, String),
}

impl Outcome {
    pub(super) fn is_accepted(&self) -> bool {
        *self == Self::Accepted
    }

    /// The message about the value itself, not about one inside of it.
    pub(super) fn own_message(&self) -> Option<&str> {
        match self {
            Self::Refused(below, message) if below.is_empty() => Some(message),
            _ => None,
        }
    }

    /// The message about the value or one inside of it.
    pub(super) fn message(&self) -> Option<&str> {
        match self {
            Self::Refused(_, message) => Some(message),
            Self::Accepted => None,
        }
    }
}

/// Parses a `T` whose value at `path` is `value`.
pub(super) fn attempt<T: DeserializeOwned>(path: &[Step], value: Value) -> Outcome {
    let wrap = |inside: Value, step: &Step| match step {
        Step::Key(key) => Value::Object(Map::from_iter([(key.clone(), inside)])),
        Step::Index(_) => Value::Array(vec![inside]),
    };
    let file = path.iter().rev().fold(value, wrap);
    match refusal::<T>(&file.to_string()) {
        Some((FieldPath(found), message)) if found.starts_with(path) => {
            Outcome::Refused(found[path.len()..].to_vec(), message)
        }
        // Of a choice, such as a word that takes no value.
        Some((_, message)) if message.starts_with("invalid type") => {
            Outcome::Refused(Vec::new(), message)
        }
        // The value was read; then the file turned out to lack others.
        _ => Outcome::Accepted,
    }
}

/// The words in backquotes behind the word "expected".
pub(super) fn quoted(message: &str) -> impl Iterator<Item = &str> {
    let expected = message
        .split_once(", expected ")
        .map_or("", |(_, expected)| expected);
    expected.split('`').skip(1).step_by(2)
}
