//! The data set of a file.

use std::path::Path;

use hdf5_metno::{File, Group};

use super::super::super::{FileFault, Result};
use super::super::budget::Budget;
use super::super::piece::{Piece, Wanted};
use super::reader::HdfReader;
use super::rows::{Datasets, damaged, missing};
use super::values::text;
use crate::fault::cut;
use host::files;

/// Returns the times of the steps of a file; none if it has no steps.
///
/// # Errors
/// The file cannot be read or is damaged.
pub(crate) fn read_times(path: &Path) -> Result<Vec<f64>> {
    let (root, n_file_bytes) = open(path)?;
    let Ok(steps) = root.group("Steps") else {
        return Ok(Vec::new());
    };
    let mut datasets = Datasets {
        n_file_bytes,
        budget: &mut Budget::new(),
    };
    let values = datasets.open(&steps, "Values")?;
    let values = values.ok_or_else(|| missing("Values"))?;
    let n_steps = values.shape().first().copied().unwrap_or(0);
    let times = datasets.rows(&values, "Values", &[], 0..n_steps)?;
    Ok(times.iter().collect())
}

/// Returns the group of the data set in a file, and the file's length in bytes.
fn open(path: &Path) -> Result<(Group, u64)> {
    let n_file_bytes = files::open(path)?.metadata()?.len();
    let file = File::open(path).map_err(|error| damaged("VTKHDF", &error))?;
    let root = file.group("VTKHDF");
    Ok((
        root.map_err(|error| damaged("VTKHDF", &error))?,
        n_file_bytes,
    ))
}

/// Reads a time step of a file, counted from 0, with the wanted arrays.
///
/// # Errors
/// The file cannot be read or is damaged, lacks the step, or is of another kind.
pub(in super::super) fn read(
    path: &Path,
    step: usize,
    wanted: &Wanted,
    budget: &mut Budget,
) -> Result<Vec<Piece>> {
    let (root, n_file_bytes) = open(path)?;
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
