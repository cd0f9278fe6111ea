//! VTK XML files → arrays by name.
//!
//! A file is opened by its header, which is checked against the file's length:
//! one that was cut short is found then, and no damaged number makes a reader
//! take more memory than the arrays have that the file holds. An array is read,
//! and decompressed, when asked for.

mod blocks;
mod file;
mod header;
mod values;

pub(crate) use file::{Place, VtkFile};
pub(crate) use header::{DataArray, DataArrays};
pub(crate) use values::Pick;
pub use values::{Number, Values};
