//! The writer of a program that was built without HDF5.

use std::io;
use std::path::Path;

use crate::vtk::data_set::DataSet;
use crate::vtk::field::Field;

/// There is none.
pub(crate) enum NoHdfWriter {}

impl NoHdfWriter {
    /// Fails.
    pub(crate) fn create(_: &Path, _: Option<&[f64]>) -> io::Result<Self> {
        Err(io::ErrorKind::Unsupported.into())
    }

    pub(crate) fn append(&mut self, _: &DataSet, _: &[Field]) -> io::Result<()> {
        match *self {}
    }

    pub(crate) fn finish(self) -> io::Result<()> {
        match self {}
    }
}
