//! Stand-in for the HDF5 writer in a program built without HDF5.

use std::io;
use std::path::Path;

use crate::data_set::DataSet;
use crate::field::Field;

/// A writer that cannot exist.
pub enum NoHdfWriter {}

impl NoHdfWriter {
    /// Always fails.
    pub fn create(_: &Path, _: Option<&[f64]>) -> io::Result<Self> {
        Err(io::ErrorKind::Unsupported.into())
    }

    /// Never called: there is no value.
    pub fn append(&mut self, _: &DataSet, _: &[Field]) -> io::Result<()> {
        match *self {}
    }

    /// Never called: there is no value.
    pub fn finish(self) -> io::Result<()> {
        match self {}
    }
}
