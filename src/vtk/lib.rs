//! VTK XML files: `appended::write` writes them, and `read::VtkReader` reads them.
//!
//! The header consists of vtkio's types, serialized by vtkio. The arrays follow
//! it as appended data, raw or compressed a few blocks at a time, directly from
//! their memory, so that no second copy of them exists. (vtkio's own writer
//! would hold the whole file as base64 text, and loses data beyond 2 GiB.) This
//! module knows the format, but not the meaning of the arrays.

mod codec;
pub mod array;
pub mod data_set;
mod field;
mod elements;
mod header;
pub mod encoding;
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
