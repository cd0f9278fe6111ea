//! VTKHDF files: data sets in HDF5, a single one or one per time step.
//!
//! The format is VTK's ("VTKHDF format specification", docs.vtk.org): version 1.0 for a single data
//! set, which ParaView 5.11 reads, and 2.0 for steps. All point and cell arrays are chunked,
//! byte-shuffled and deflated. The library is the system's libhdf5, behind the cargo feature
//! `hdf5`; without it, [`HdfWriter`] cannot be created.

#[cfg(feature = "hdf5")]
mod fields;
#[cfg(feature = "hdf5")]
mod rows;
#[cfg(feature = "hdf5")]
mod steps;
#[cfg(feature = "hdf5")]
mod writer;
#[cfg(not(feature = "hdf5"))]
mod absent;

use std::io;
use std::path::Path;

#[cfg(not(feature = "hdf5"))]
pub use absent::NoHdfWriter as HdfWriter;
#[cfg(feature = "hdf5")]
pub use writer::HdfWriter;

use crate::data_set::DataSet;
use crate::field::Field;

/// True if this program was built with HDF5.
pub const IS_BUILT: bool = cfg!(feature = "hdf5");

/// Writes a data set, either an image of points or a grid, to a new file.
///
/// # Errors
/// The errors of HDF5.
pub fn write(data_set: &DataSet, fields: &[Field], path: &Path) -> io::Result<()> {
    let mut file = HdfWriter::create(path, None)?;
    let units = Field::units(data_set);
    let fields: Vec<Field> = fields.iter().cloned().chain(units).collect();
    file.append(data_set, &fields)?;
    file.finish()
}
