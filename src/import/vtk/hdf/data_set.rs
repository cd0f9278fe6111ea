//! The data set of a file.

use std::path::Path;

use hdf5_metno::File;

use super::super::super::{FileFault, Result};
use super::super::budget::Budget;
use super::super::piece::{Piece, Wanted};
use super::reader::HdfReader;
use super::rows::{Datasets, damaged};
use super::values::text;
use crate::import::fault::cut;

/// Reads a time step of a file, the first of which is 0, and of its arrays those that are
/// wanted.
///
/// # Errors
/// A file that cannot be read or is damaged, has no such step, or is of another kind.
pub(in super::super) fn read(
    path: &Path,
    step: usize,
    wanted: &Wanted,
    budget: &mut Budget,
) -> Result<Vec<Piece>> {
    let n_file_bytes = std::fs::metadata(path)?.len();
    let file = File::open(path).map_err(|error| damaged("VTKHDF", &error))?;
    let root = file.group("VTKHDF");
    let root = root.map_err(|error| damaged("VTKHDF", &error))?;
    let kind = text(&root, "Type")?;
    let datasets = Datasets {
        n_file_bytes,
        budget,
    };
    let mut reader = HdfReader {
        steps: root.group("Steps").ok(),
        root,
        step,
        wanted,
        datasets,
    };
    reader.check_step()?;
    match kind.as_str() {
        "ImageData" => Ok(vec![reader.image()?]),
        "UnstructuredGrid" => reader.pieces(HdfReader::grid),
        "PolyData" => reader.pieces(HdfReader::polydata),
        _ => {
            let problem = format!("it is a data set of the type `{}`", cut(&kind));
            let expected = "UnstructuredGrid, PolyData or ImageData";
            Err(FileFault::new(problem, expected))
        }
    }
}
