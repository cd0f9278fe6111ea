//! VTK XML files → arrays by name.
//!
//! Opening a file checks its header against the file's length, which detects
//! truncated files. A damaged number never makes the reader allocate more memory
//! than the arrays in the file have. Arrays are read and decompressed on request.

mod blocks;
mod contents;
mod fields;
mod header;
mod reader;
mod values;

pub use header::{
    DataArrayElement, DataArraysElement, ImagePieceElement, VtkHeader, extent_of, size_of_extent,
};
pub use reader::{ArrayLocation, VtkReader};
pub use values::{ArrayValues, Scalar};
pub use values::{Selection, scalar_of};
