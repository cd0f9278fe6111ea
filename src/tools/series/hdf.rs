//! Cloud and frame of all frames as VTKHDF, one step per frame.
//!
//! The steps are read from the VTK files of the frames, one array at a time.

use std::io;
use std::path::Path;

use super::{SeriesFrame, frame_folder};
use host::folder::{Replace, WriteError, write_file_at};
use host::text::Diagnostic;
use output::writers::vertices;
use vtk::array::Array;
use vtk::data_set::{DataSet, Extent};
use vtk::hdf::HdfWriter;
use vtk::read::{DataArrayElement, VtkReader};

/// The files, and the frames' files that are their steps.
pub(super) const FILES: [(&str, &str); 2] = [
    ("series_hits.vtkhdf", "hits.vtu"),
    ("series_frame.vtkhdf", "frame.vti"),
];

/// Writes the files into the folder of the series. Returns their names.
///
/// # Errors
/// If a file of a frame cannot be read, or a file of the series cannot be written.
pub(super) fn write(frames: &[SeriesFrame], folder: &Path) -> Result<Vec<String>, WriteError> {
    let times: Vec<f64> = frames.iter().map(|frame| frame.time).collect();
    let mut written = Vec::new();
    for (name, of_frame) in FILES {
        // The name does not reveal HDF5's content; the table beside it does.
        write_file_at(&folder.join(name), Replace::Known, |path| {
            let mut file = HdfWriter::create(path, Some(&times))?;
            for frame in frames {
                let step = folder.join(frame_folder(frame.number)).join(of_frame);
                append(&mut file, &step)?;
            }
            file.finish()
        })?;
        written.push(name.to_owned());
    }
    Ok(written)
}

/// Appends the data set of a VTK file.
fn append(file: &mut HdfWriter, path: &Path) -> io::Result<()> {
    let (reader, header) = VtkReader::open(path).map_err(failure)?;
    let data_set = match (&header.image, &header.grid) {
        (Some(image), _) => {
            let size = image.size().unwrap_or_default();
            let n = size.map(u64::from).iter().product();
            let point_data = arrays(&reader, &image.point_data, n)?;
            let extent = Extent::of_size(size);
            DataSet::Image { extent, point_data }
        }
        (None, Some(grid)) => {
            let n = grid.n_points;
            let point_data = arrays(&reader, &grid.point_data, n)?;
            let mut points = arrays(&reader, &grid.points, n)?;
            let points = points.pop().ok_or(io::ErrorKind::InvalidData)?;
            DataSet::Grid(vertices(n as usize, points, point_data))
        }
        (None, None) => return Err(io::ErrorKind::InvalidData.into()),
    };
    let fields = reader.fields(&header.field_data).map_err(failure)?;
    file.append(&data_set, &fields)
}

/// Returns the arrays of `n` entries.
fn arrays<'a>(
    reader: &'a VtkReader,
    elements: &'a [DataArrayElement],
    n: u64,
) -> io::Result<Vec<Array<'a>>> {
    let one = |element| array(reader, element, n).map_err(failure);
    elements.iter().map(one).collect()
}

/// Returns an array of `n` entries that is read when it is written.
fn array<'a>(
    reader: &'a VtkReader,
    element: &'a DataArrayElement,
    n: u64,
) -> Result<Array<'a>, Diagnostic> {
    let place = reader.place(element, n)?;
    let n_components = element.n_components as usize;
    Ok(Array {
        name: &element.name,
        scalar: place.scalar,
        n_components,
        n_bytes: n * (n_components * place.scalar.size()) as u64,
        unit: None,
        write: Box::new(move |out| {
            let values = reader.read(&place).map_err(failure)?;
            out.write_all(values.bytes())
        }),
    })
}

fn failure(fault: Diagnostic) -> io::Error {
    io::Error::other(fault.to_string())
}
