//! `frame.vti`: every pixel, hit or not.

use std::io::{self, Seek, Write};

use super::file::{FileContent, OutputFile};
use crate::film::{Column, Film};
use crate::vtk::appended;
use crate::vtk::array::Array;
use crate::vtk::data_set::DataSet;
use crate::vtk::encoding::Encoding;

/// The file.
pub(crate) const FILE: OutputFile = OutputFile {
    name: "frame.vti",
    is_wanted: |_| true,
    content: FileContent::Written(|job, out| {
        let film = job.rendering.film;
        job.reserve(n_pixels(film) * bytes_per_point(film), out);
        write(film, job.encoding_of_pixels(), out)
    }),
};

/// Writes the film as ImageData with one point per pixel. VTK orders rows from bottom
/// to top, the film from top to bottom: its last row is written first.
pub fn write(
    film: &Film,
    encoding: impl Into<Encoding>,
    out: &mut (impl Write + Seek),
) -> io::Result<()> {
    appended::write(&image(film), encoding.into(), out)
}

/// Returns the film as an image.
pub(super) fn image(film: &Film) -> DataSet<'_> {
    let array = |column| {
        column_array(column, n_pixels(film), |column, out| {
            write_rows(film, column, out)
        })
    };
    DataSet::Image {
        size: [film.grid.width, film.grid.height],
        point_data: film.columns().map(array).collect(),
    }
}

fn n_pixels(film: &Film) -> u64 {
    u64::from(film.grid.width) * u64::from(film.grid.height)
}

/// The bytes of a point in all arrays of the film.
pub(super) fn bytes_per_point(film: &Film) -> u64 {
    film.columns().map(|column| column.stride() as u64).sum()
}

/// Creates the array of a column with `n` entries, which `write` writes.
pub(super) fn column_array<'a>(
    column: Column,
    n: u64,
    write: impl Fn(&Column, &mut dyn Write) -> io::Result<()> + 'a,
) -> Array<'a> {
    Array {
        name: column.name,
        scalar: column.scalar,
        n_components: column.n_components,
        n_bytes: n * column.stride() as u64,
        unit: column.unit,
        write: Box::new(move |out| write(&column, out)),
    }
}

fn write_rows(film: &Film, column: &Column, out: &mut dyn Write) -> io::Result<()> {
    let row_bytes = film.grid.width as usize * column.stride();
    let mut buffer = Vec::new();
    for strip in film.strips.iter().rev() {
        for row in column
            .bytes(film, strip, &mut buffer)
            .chunks_exact(row_bytes)
            .rev()
        {
            out.write_all(row)?;
        }
    }
    Ok(())
}
