//! Rows of datasets as numbers.

use std::ops::Range;

use hdf5_metno::types::{FloatSize, IntSize, TypeDescriptor};
use hdf5_metno::{Dataset, Group, H5Type, Hyperslab, Selection, SliceOrIndex};
use ndarray::{ArrayD, IxDyn};

use super::super::super::{FileFault, Result};
use super::super::budget::Budget;
use super::super::numbers::Numbers;
use crate::fault::cut;
use vtk::ArrayValues;

/// Maximum expansion of a byte by zlib, rounded up; other filters of HDF5 expand less.
const MAX_INFLATION: u64 = 1100;

/// The datasets of a file.
pub(super) struct Datasets<'a> {
    /// Length of the file in bytes.
    pub(super) n_file_bytes: u64,
    pub(super) budget: &'a mut Budget,
}

impl Datasets<'_> {
    /// Opens the dataset of this name, if the group has one.
    ///
    /// # Errors
    /// Its sizes exceed the data that the file stores for it.
    pub(super) fn open(&self, group: &Group, name: &str) -> Result<Option<Dataset>> {
        if !group.link_exists(name) {
            return Ok(None);
        }
        let dataset = group.dataset(name).map_err(|error| damaged(name, &error))?;
        let shape = dataset.get_shape().map_err(|error| damaged(name, &error))?;
        let kind = dataset.dtype().map_err(|error| damaged(name, &error))?;
        let n_bytes = bytes_of(&shape, kind.size());
        let n_chunk_bytes = bytes_of(&dataset.chunk().unwrap_or_default(), kind.size());
        let n_stored = dataset.storage_size();
        let is_inflated = dataset.is_chunked() && !dataset.filters().is_empty();
        let most = if is_inflated {
            n_stored.saturating_mul(MAX_INFLATION)
        } else {
            n_stored
        };
        let has_room = n_bytes.is_some_and(|n| n <= most)
            && n_stored <= self.n_file_bytes
            && (n_bytes == Some(0) || n_chunk_bytes.is_some_and(|n| n <= most.max(1)));
        if !has_room {
            let problem = format!("the dataset `{}` is larger than its data", cut(name));
            return Err(FileFault::new(problem, "a file that is not damaged"));
        }
        Ok(Some(dataset))
    }

    /// Reads all numbers of the dataset of this name; none if it does not exist.
    ///
    /// # Errors
    /// The dataset is damaged, or is not numeric.
    pub(super) fn list(&mut self, group: &Group, name: &str) -> Result<Option<Vec<i64>>> {
        let Some(dataset) = self.open(group, name)? else {
            return Ok(None);
        };
        let n_rows = dataset.shape().first().copied().unwrap_or(1);
        let numbers = self.rows(&dataset, name, &[], 0..n_rows)?;
        Ok(Some(numbers.iter().map(|number| number as i64).collect()))
    }

    /// Reads rows of a dataset at the leading indices `before`. A row is a tuple of all numbers in
    /// the remaining dimensions.
    ///
    /// # Errors
    /// The dataset lacks these rows, is not numeric, is damaged, or is too large for the
    /// memory.
    pub(super) fn rows(
        &mut self,
        dataset: &Dataset,
        name: &str,
        before: &[usize],
        rows: Range<usize>,
    ) -> Result<Numbers> {
        // Check that the rows exist.
        let shape = dataset.shape();
        let is_inside = before.len() < shape.len()
            && before.iter().zip(&shape).all(|(i, n)| i < n)
            && rows.end <= shape[before.len()];
        if !is_inside {
            let problem = format!("the dataset `{}` has the shape {shape:?}", cut(name));
            let place = [before, &[rows.end]].concat();
            return Err(FileFault::new(problem, format!("at least {place:?}")));
        }
        // Select them.
        let row = &shape[before.len() + 1..];
        let slices = (before.iter().map(|&i| at(i, 1)))
            .chain([at(rows.start, rows.len())])
            .chain(row.iter().map(|&n| at(0, n)));
        let selection = Selection::from(Hyperslab::from(slices.collect::<Vec<_>>()));
        // Read the numbers in their type.
        let n_components: usize = row.iter().product();
        let kind = dataset.dtype().map_err(|error| damaged(name, &error))?;
        self.budget.take_of::<u8>(
            (rows.len())
                .saturating_mul(n_components)
                .saturating_mul(2 * kind.size()),
        )?;
        let values = match kind
            .to_descriptor()
            .map_err(|error| damaged(name, &error))?
        {
            TypeDescriptor::Integer(IntSize::U1) => read(dataset, selection, ArrayValues::I8),
            TypeDescriptor::Integer(IntSize::U2) => read(dataset, selection, ArrayValues::I16),
            TypeDescriptor::Integer(IntSize::U4) => read(dataset, selection, ArrayValues::I32),
            TypeDescriptor::Integer(IntSize::U8) => read(dataset, selection, ArrayValues::I64),
            TypeDescriptor::Unsigned(IntSize::U1) => read(dataset, selection, ArrayValues::U8),
            TypeDescriptor::Unsigned(IntSize::U2) => read(dataset, selection, ArrayValues::U16),
            TypeDescriptor::Unsigned(IntSize::U4) => read(dataset, selection, ArrayValues::U32),
            TypeDescriptor::Unsigned(IntSize::U8) => read(dataset, selection, ArrayValues::U64),
            TypeDescriptor::Float(FloatSize::U4) => read(dataset, selection, ArrayValues::F32),
            TypeDescriptor::Float(FloatSize::U8) => read(dataset, selection, ArrayValues::F64),
            _ => {
                let problem = format!("the dataset `{}` has no numbers", cut(name));
                let expected = "integers or floats of up to 64 bits";
                return Err(FileFault::new(problem, expected));
            }
        };
        let numbers = Numbers::new(values.map_err(|error| damaged(name, &error))?);
        Ok(numbers.in_tuples_of(n_components))
    }
}

/// Creates the fault of a dataset that cannot be read.
pub(super) fn damaged(name: &str, error: &hdf5_metno::Error) -> FileFault {
    let problem = format!("cannot read `{}`: {error}", cut(name));
    FileFault::new(problem, "a VTKHDF file that is not damaged")
}

/// Creates the fault of a missing dataset or attribute.
pub(super) fn missing(name: &str) -> FileFault {
    let problem = format!("it has no dataset `{name}`");
    FileFault::new(problem, "the datasets of the VTKHDF format")
}

fn at(start: usize, count: usize) -> SliceOrIndex {
    SliceOrIndex::SliceCount {
        start,
        step: 1,
        count,
        block: 1,
    }
}

fn bytes_of(shape: &[usize], n_number_bytes: usize) -> Option<u64> {
    let product = shape
        .iter()
        .try_fold(n_number_bytes, |n, side| n.checked_mul(*side));
    product.and_then(|n| u64::try_from(n).ok())
}

fn read<T: H5Type + Copy>(
    dataset: &Dataset,
    selection: Selection,
    values: fn(Vec<T>) -> ArrayValues,
) -> hdf5_metno::Result<ArrayValues> {
    let numbers: ArrayD<T> = dataset.read_slice::<T, _, IxDyn>(selection)?;
    Ok(values(numbers.into_iter().collect()))
}
