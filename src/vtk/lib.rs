//! VTK files: data sets → bytes, and bytes → arrays by name. The meaning of the arrays is up to
//! other crates.
//!
//! Read first [`mod@array`] and [`data_set`], the input; then [`appended::write`], which writes a
//! header of vtkio's types followed by the arrays, raw or compressed a few blocks at a time,
//! straight from their memory, so that no second copy exists (vtkio's own writer would hold the
//! file as base64, and loses data beyond 2 GiB); then [`read::VtkReader`]. [`parallel`] lists the
//! pieces of a data set, [`hdf`] writes VTKHDF.

mod codec;
pub mod array;
mod windows;
pub mod data_set;
mod field;
pub mod encoding;
mod elements;
mod header;
pub mod compressed;
pub mod appended;
pub mod hdf;
pub mod read;
pub mod parallel;

pub use codec::Codec;
pub use codec::Compressor;
pub use encoding::Encoding;
pub use field::{Field, FieldValues};
pub use read::{ArrayValues, Scalar};
