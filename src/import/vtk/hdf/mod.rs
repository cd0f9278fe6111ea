//! VTKHDF files: data sets in HDF5, a single one or one per time step.
//!
//! The format is VTK's ("VTKHDF format specification", docs.vtk.org), up to version 2.8. The
//! library is the system's libhdf5, behind the cargo feature `hdf5`. A damaged file may claim any
//! sizes: they are compared with the stored data before memory is allocated.

#[cfg(feature = "hdf5")]
mod rows;
#[cfg(feature = "hdf5")]
mod values;
#[cfg(feature = "hdf5")]
mod reader;
#[cfg(feature = "hdf5")]
mod attributes;
#[cfg(feature = "hdf5")]
mod cells;
#[cfg(feature = "hdf5")]
mod image;
#[cfg(feature = "hdf5")]
mod data_set;

#[cfg(feature = "hdf5")]
pub(super) use data_set::read;
#[cfg(feature = "hdf5")]
pub(in super::super) use data_set::read_times;

use std::path::Path;

#[cfg(not(feature = "hdf5"))]
use super::super::{FileFault, Result};
#[cfg(not(feature = "hdf5"))]
use super::budget::Budget;
#[cfg(not(feature = "hdf5"))]
use super::piece::{Piece, Wanted};

/// The extension of the files, in lower case.
pub(super) const EXTENSION: &str = "vtkhdf";

/// Returns true if the file's extension is VTKHDF's.
pub(in super::super) fn is_hdf(path: &Path) -> bool {
    super::extension(path) == EXTENSION
}

/// Returns no times: this program was built without HDF5, which the reader reports.
#[cfg(not(feature = "hdf5"))]
pub(in super::super) fn read_times(_: &Path) -> Result<Vec<f64>> {
    Ok(Vec::new())
}

/// Fails: this program was built without HDF5.
#[cfg(not(feature = "hdf5"))]
pub(super) fn read(_: &Path, _: usize, _: &Wanted, _: &mut Budget) -> Result<Vec<Piece>> {
    let problem = "it is VTKHDF, and this raycost was built without HDF5";
    let expected = "a raycost built with libhdf5 and `--features hdf5`, or another format of VTK";
    Err(FileFault::new(problem, expected))
}
