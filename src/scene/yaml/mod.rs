//! YAML text → typed, checked values.
//!
//! [`Source::parse`] takes a scene file's text and a serde type, and returns the value or one
//! [`Diagnostic`](host::text::Diagnostic) that points at a line. serde_yaml deserializes; the
//! events of saphyr-parser give the position of each key and value, so that every error, including
//! one found later, is shown in its place.

mod field_path;
mod fault;
mod quote;
mod expansion;
mod syntax;
mod walk;
mod position;
mod json;
mod tree;
mod setting;
mod translate;
mod deserialize;
mod source;
mod meant;
mod misplaced;
mod mistakes;
mod origins;
mod include;
mod document;

pub use deserialize::{Refusal, YamlFile, deserialize};
pub use document::{Document, Folders};
pub use fault::{Fault, Spot};
pub use field_path::{FieldPath, Step};
pub use json::{json_of, quoted, to_yaml};
pub use origins::Merging;
pub use source::{Source, from_str};
