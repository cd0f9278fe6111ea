//! VTK XML files → arrays by name.
//!
//! [`parse`] and [`ArrayEncoding`] read the elements and the arrays of any VTK XML file in memory.
//!
//! [`VtkReader`] reads files that raycost wrote, which may be larger than the memory. Opening one
//! checks its header against the file's length, which detects truncated files. Arrays are read and
//! decompressed on request.
//!
//! A damaged number never makes a reader allocate more memory than the arrays in the file have.

mod document;
mod values;
mod encoded;
mod blocks;
mod header;
mod reader;
mod contents;
mod fields;

pub use document::{Element, MAX_DEPTH, XmlFault, parse};
pub use encoded::{ArrayEncoding, EncodedBytes};
pub use header::{DataArrayElement, VtkHeader, extent_of, size_of_extent};
pub use reader::{ArrayLocation, VtkReader};
pub(crate) use values::vtk_type;
pub use values::{ArrayValues, Scalar, Selection, scalar_of};
pub use vtkio::model::{ByteOrder, ScalarType};
