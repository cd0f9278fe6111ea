//! VTK's files: data sets → bytes, and bytes → arrays by name. It does not know what the arrays
//! mean.
//!
//! Read [`mod@array`] and [`data_set`], what is written; [`appended::write`], which writes a header
//! of vtkio's types and behind it the arrays, raw or compressed a few blocks at a time, from
//! their memory, so that no second copy exists (vtkio's own writer would hold the file as
//! base64, and loses data beyond 2 GiB); and [`read::VtkReader`]. [`parallel`] lists the pieces
//! of a data set, [`hdf`] writes VTKHDF.

mod codec;
pub mod array;
pub mod data_set;
mod field;
pub mod encoding;
mod elements;
mod header;
pub mod compressed;
pub mod appended;
pub mod parallel;
pub mod hdf;
pub mod read;

pub use codec::Codec;
pub use codec::Compressor;
pub use encoding::Encoding;
pub use field::{Field, FieldValues};
pub use read::{ArrayValues, Scalar};
