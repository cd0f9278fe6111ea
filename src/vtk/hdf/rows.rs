//! Datasets of rows, written in chunks while an array generates its bytes.

use std::io::{self, Write};

use bytemuck::{AnyBitPattern, NoUninit};
use hdf5_metno::types::{FixedAscii, TypeDescriptor};
use hdf5_metno::{Dataset, Extent, Group, H5Type, Hyperslab, Location, Selection, SliceOrIndex};
use ndarray::{ArrayView, IxDyn};
use vtkio::model::ScalarType;

use crate::array::Array;
use base::stop;

/// Approximate bytes per chunk: partial readers inflate whole chunks.
const CHUNK: usize = 1 << 18;
/// A fast compression level of zlib.
const LEVEL: u8 = 2;

/// Longest text of an attribute.
const TEXT: usize = 32;

/// The location of an array's rows in a dataset.
pub(super) struct Place {
    /// The indices before the row's index: the step, in images over time.
    pub(super) before: Vec<usize>,
    /// The index of the first row.
    pub(super) first_row: usize,
    /// Entries per row: `None` in lists, the columns in images.
    pub(super) row: Option<usize>,
    /// The size of the dataset's dimensions up to the rows once the array is written.
    pub(super) size: Vec<usize>,
}

impl Place {
    /// Returns the location of `n` entries in a list, after `first` others.
    pub(super) fn of_list(first: usize, n: usize) -> Self {
        Self {
            before: Vec::new(),
            first_row: first,
            row: None,
            size: vec![first + n],
        }
    }
}

/// Calls a generic function with the Rust type of an array's numbers.
macro_rules! with_type {
    ($scalar:expr, $function:ident($($argument:expr),*)) => {
        match $scalar {
            ScalarType::U8 | ScalarType::Bit => $function::<u8>($($argument),*),
            ScalarType::I8 => $function::<i8>($($argument),*),
            ScalarType::U16 => $function::<u16>($($argument),*),
            ScalarType::I16 => $function::<i16>($($argument),*),
            ScalarType::U32 => $function::<u32>($($argument),*),
            ScalarType::I32 => $function::<i32>($($argument),*),
            ScalarType::U64 => $function::<u64>($($argument),*),
            ScalarType::I64 => $function::<i64>($($argument),*),
            ScalarType::F32 => $function::<f32>($($argument),*),
            ScalarType::F64 => $function::<f64>($($argument),*),
        }
    };
}

/// Writes an array as rows of the dataset of this name, which is created or extended.
///
/// # Errors
/// The array has another length, an error of HDF5, or a signal to stop.
pub(super) fn write(group: &Group, name: &str, array: &Array, place: &Place) -> io::Result<()> {
    let row: Vec<usize> = (place.row.into_iter())
        .chain((array.n_components > 1).then_some(array.n_components))
        .collect();
    let row_bytes = row.iter().product::<usize>() * array.scalar.size();
    let rows_per_chunk = (CHUNK / row_bytes).max(1);
    // Extend the dataset, or create it.
    let dataset = match group.dataset(name) {
        Ok(dataset) => {
            let shape = [&place.size[..], &row].concat();
            dataset.resize(shape).map_err(io::Error::other)?;
            dataset
        }
        Err(_) => with_type!(
            array.scalar,
            create(group, name, &place.size, &row, rows_per_chunk)
        )?,
    };
    // Write the rows in chunks while the array generates its bytes.
    let mut rows = HdfRows {
        dataset: &dataset,
        scalar: array.scalar,
        place,
        row,
        next_row: place.first_row,
        chunk_bytes: rows_per_chunk * row_bytes,
        row_bytes,
        buffer: Vec::new(),
    };
    array.write_to(&mut rows)?;
    rows.flush_rows()
}

/// Marks the dataset of this name as the array that VTK uses as `what`, such as its normals.
pub(super) fn set_attribute(group: &Group, name: &str, what: &str) -> io::Result<()> {
    let dataset = group.dataset(name);
    let set = dataset.and_then(|dataset| set_text(&dataset, "Attribute", what));
    set.map_err(io::Error::other)
}

/// Sets an attribute of text.
pub(super) fn set_text(at: &Location, name: &str, text: &str) -> hdf5_metno::Result<()> {
    let kind = TypeDescriptor::FixedAscii(text.len());
    let attribute = at.new_attr_builder().empty_as(&kind).create(name)?;
    let text = FixedAscii::<TEXT>::from_ascii(text).map_err(|error| error.to_string())?;
    attribute.write_scalar(&text)
}

/// Creates a dataset without its creation time, so that equal runs write equal bytes.
fn create<T: H5Type>(
    group: &Group,
    name: &str,
    size: &[usize],
    row: &[usize],
    rows_per_chunk: usize,
) -> io::Result<Dataset> {
    let (n_rows, before) = size
        .split_last()
        .map_or((0, size), |(n, before)| (*n, before));
    let is_list = before.is_empty();
    let mut chunk = vec![1; before.len()];
    // Lists grow; the number of rows of an image is fixed.
    chunk.push(if is_list {
        rows_per_chunk
    } else {
        rows_per_chunk.min(n_rows).max(1)
    });
    chunk.extend(row);
    let extents: Vec<Extent> = (size.iter().chain(row).enumerate())
        .map(|(i, &n)| {
            if i == 0 {
                Extent::resizable(n)
            } else {
                n.into()
            }
        })
        .collect();
    let builder = group
        .new_dataset::<T>()
        .chunk(chunk)
        .shuffle()
        .deflate(LEVEL);
    let builder = builder.with_dcpl(|plist| plist.obj_track_times(false));
    builder
        .shape(extents)
        .create(name)
        .map_err(io::Error::other)
}

/// Collects rows and writes them chunk by chunk.
struct HdfRows<'a> {
    dataset: &'a Dataset,
    scalar: ScalarType,
    place: &'a Place,
    /// The size of the dimensions after the rows.
    row: Vec<usize>,
    next_row: usize,
    chunk_bytes: usize,
    row_bytes: usize,
    buffer: Vec<u8>,
}

impl HdfRows<'_> {
    /// Writes the collected rows.
    fn flush_rows(&mut self) -> io::Result<()> {
        stop::check().map_err(io::Error::other)?;
        with_type!(self.scalar, write_rows(self))
    }
}

fn write_rows<T: H5Type + AnyBitPattern + NoUninit>(rows: &mut HdfRows) -> io::Result<()> {
    let n_rows = rows.buffer.len() / rows.row_bytes;
    if n_rows == 0 {
        return Ok(());
    }
    let Place { before, .. } = rows.place;
    let numbers: Vec<T> = bytemuck::pod_collect_to_vec(&rows.buffer);
    let ones = before.iter().map(|_| 1);
    let shape: Vec<usize> = ones
        .chain([n_rows])
        .chain(rows.row.iter().copied())
        .collect();
    let at = |start, count| SliceOrIndex::SliceCount {
        start,
        step: 1,
        count,
        block: 1,
    };
    let slices: Vec<SliceOrIndex> = (before.iter().map(|&i| at(i, 1)))
        .chain([at(rows.next_row, n_rows)])
        .chain(rows.row.iter().map(|&n| at(0, n)))
        .collect();
    let view = ArrayView::from_shape(IxDyn(&shape), &numbers).map_err(io::Error::other)?;
    let slab = Selection::from(Hyperslab::from(slices));
    rows.dataset
        .write_slice(view, slab)
        .map_err(io::Error::other)?;
    rows.next_row += n_rows;
    rows.buffer.clear();
    Ok(())
}

impl Write for HdfRows<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = bytes.len().min(self.chunk_bytes - self.buffer.len());
        self.buffer.extend_from_slice(&bytes[..n]);
        if self.buffer.len() == self.chunk_bytes {
            self.flush_rows()?;
        }
        Ok(n)
    }

    /// Does nothing: only full chunks are written before the end.
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
