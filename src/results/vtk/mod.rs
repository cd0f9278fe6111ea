//! VTK XML files → arrays by name.
//!
//! A file is opened by its header, which is checked against the file's length:
//! one that was cut short is found then, and no damaged number makes a reader
//! take more memory than the file has bytes. An array is read when asked for.

mod data;
mod file;
mod header;
mod values;

pub use data::{Array, ArrayInfo, Frame, Hits};
pub use values::{Number, Values};
