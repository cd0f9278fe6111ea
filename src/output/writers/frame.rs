//! `frame.vti`: every pixel, hit or not.

use std::io::{self, Seek, Write};
use std::ops::Range;

use super::file::{FileContent, OutputFile};
use render::film::{Column, Film};
use vtk::appended;
use vtk::array::Array;
use vtk::data_set::{DataSet, Extent};
use vtk::encoding::Encoding;

/// The file.
pub const FILE: OutputFile = OutputFile {
    name: "frame.vti",
    is_wanted: |request| !request.is_stored,
    content: FileContent::Written(|job, out| {
        let film = job.rendering.film;
        let rows = film.row_range();
        job.reserve(n_pixels(film, &rows) * bytes_per_point(film), out);
        write_rows(film, rows, job.encoding_of_pixels(), out)
    }),
};

/// Writes the film as ImageData with one point per pixel. VTK orders rows from bottom to top and
/// the film from top to bottom, so the film's last row is written first.
pub fn write(
    film: &Film,
    encoding: impl Into<Encoding>,
    out: &mut (impl Write + Seek),
) -> io::Result<()> {
    write_rows(film, film.row_range(), encoding.into(), out)
}

/// Writes some rows of a film as a piece of the image.
pub(super) fn write_rows(
    film: &Film,
    rows: Range<u32>,
    encoding: Encoding,
    out: &mut (impl Write + Seek),
) -> io::Result<()> {
    appended::write(&image(film, rows), encoding, out)
}

/// Returns some rows of a film as a piece of the image.
pub(super) fn image(film: &Film, rows: Range<u32>) -> DataSet<'_> {
    let n = n_pixels(film, &rows);
    let extent = extent(film, &rows);
    let array = |column| {
        let rows = rows.clone();
        column_array(column, n, move |column, out| {
            write_column(film, &rows, column, out)
        })
    };
    DataSet::Image {
        extent,
        point_data: film.columns().map(array).collect(),
    }
}

/// Returns the extent of rows of a film in the image.
pub(super) fn extent(film: &Film, rows: &Range<u32>) -> Extent {
    let height = film.grid.height;
    Extent {
        columns: [0, film.grid.width - 1],
        rows: [height - rows.end, height - rows.start - 1],
    }
}

fn n_pixels(film: &Film, rows: &Range<u32>) -> u64 {
    u64::from(film.grid.width) * rows.len() as u64
}

/// Returns the bytes of a point in all arrays of the film.
pub(super) fn bytes_per_point(film: &Film) -> u64 {
    film.columns().map(|column| column.stride() as u64).sum()
}

/// Creates the array of a column with `n` entries, which `write` writes.
pub(super) fn column_array<'a>(
    column: Column,
    n: u64,
    write: impl Fn(&Column, &mut dyn Write) -> io::Result<()> + Sync + 'a,
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

fn write_column(
    film: &Film,
    rows: &Range<u32>,
    column: &Column,
    out: &mut dyn Write,
) -> io::Result<()> {
    let row_bytes = film.grid.width as usize * column.stride();
    let mut buffer = Vec::new();
    for strip in film.strips.iter().rev() {
        let all = strip.first_row..strip.first_row + strip.n_rows;
        if all.end <= rows.start || all.start >= rows.end {
            continue;
        }
        let of_strip = column
            .bytes(film, strip, &mut buffer)
            .chunks_exact(row_bytes);
        for (row, y) in of_strip.zip(all).rev() {
            if rows.contains(&y) {
                out.write_all(row)?;
            }
        }
    }
    Ok(())
}
