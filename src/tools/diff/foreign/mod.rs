//! An output, and a picture or a cost map of another program → their differences.
//!
//! A [`ForeignFile`] holds colors, linear light or one cost per pixel; its format is recognized by
//! its first bytes. Colors and light are compared as those of two outputs are. A cost has the unit
//! of the other program: a [`CostAgreement`] compares its distribution over the pixels. The size of
//! the output bounds the memory of each reader.

mod source;
mod png;
mod netpbm;
mod npy;
mod exr;
mod file;
mod agreement;
mod comparison;
mod report;
mod files;

pub use agreement::{CostAgreement, ObjectShare};
pub use comparison::{ForeignDiff, ForeignDifference, in_order};
pub use file::{ForeignContent, ForeignFile};
pub use files::{to_json, write};
pub use report::report;
