//! The writer of a program that was built without HDF5.

use std::io;
use std::path::Path;

use crate::data_set::DataSet;
use crate::field::Field;

/// There is none.
pub enum NoHdfWriter {}

impl NoHdfWriter {
    /// Fails.
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
