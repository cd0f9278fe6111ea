//! YAML text → typed, checked values.
//!
//! Takes a scene file's text and a serde type; gives the value, or one
//! [`Diagnostic`] that points at the line. serde_yaml does the reading; the
//! event stream of saphyr-parser, walked beside it, knows where each key and
//! value stands, so that every error, whoever finds it, gets its caret.

mod color;
mod diagnostic;
mod expansion;
mod name;
mod number;
mod position;
mod source;
mod suggestion;
mod syntax;
mod translate;
mod walk;

pub use color::{ColorOr, color, hex_color, radiance};
pub use diagnostic::{Diagnostic, Fault, Spot};
pub use name::{MAX_NAME, name};
pub use number::{
    Number, coordinate, count, direction, fraction, non_empty, non_negative, point, positive,
    positive_range, range, scale, seed, vector, whole,
};
pub use position::{Path, Step};
pub use source::{Source, from_str};
pub use suggestion::did_you_mean;
