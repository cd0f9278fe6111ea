//! `hits.vtu`: the hit points of the pixels, as a cloud.

use std::io::{self, Seek, Write};
use std::ops::Range;

use vtkio::model::CellType;

use super::distances::Distances;
use super::file::{FileContent, OutputFile};
use super::frame::{bytes_per_point, column_array};
use render::film::{Column, Film, Strip};
use vtk::appended;
use vtk::array::{Array, Integers, separate_cells, types_of};
use vtk::data_set::{CellMesh, DataSet};
use vtk::encoding::Encoding;

/// The file.
pub const FILE: OutputFile = OutputFile {
    name: "hits.vtu",
    is_wanted: |request| !request.is_stored,
    content: FileContent::Written(|job, out| {
        let film = job.rendering.film;
        let per_hit = bytes_per_point(film) + Column::points(film).stride() as u64;
        let survey = job.rendering.survey;
        job.reserve(survey.n_hits * per_hit, out);
        let rows = film.row_range();
        write_rows(film, rows, &survey.distances, job.encoding_of_pixels(), out)
    }),
};

/// Writes the film's hits as an UnstructuredGrid of one vertex per hit, in the
/// order of the pixels, row 0 on top.
pub fn write(
    film: &Film,
    encoding: impl Into<Encoding>,
    out: &mut (impl Write + Seek),
) -> io::Result<()> {
    let rows = film.row_range();
    write_rows(film, rows, &Distances::collect(film), encoding.into(), out)
}

/// Writes some rows of a film as [`write`] does, starting with a strip, whose distances are known.
pub(super) fn write_rows(
    film: &Film,
    rows: Range<u32>,
    distances: &Distances,
    encoding: Encoding,
    out: &mut (impl Write + Seek),
) -> io::Result<()> {
    with_cloud(film, rows, distances, |cloud| {
        appended::write(cloud, encoding, out)
    })
}

/// Calls `write` with the cloud of some rows of a film, starting with a strip, whose distances are
/// known.
pub(super) fn with_cloud(
    film: &Film,
    rows: Range<u32>,
    distances: &Distances,
    write: impl FnOnce(&DataSet) -> io::Result<()>,
) -> io::Result<()> {
    let hits = Hits::new(film, &rows);
    let pixels = Integers::up_to(film.grid.width as usize * film.grid.height as usize);
    let n = hits.n;
    let array = |column| {
        column_array(column, n as u64, |column, out| {
            hits.write_values(column, out)
        })
    };
    let mut point_data: Vec<Array> = film.columns().map(array).collect();
    let of_cloud = [
        pixels.array("pixel", n, |out| hits.write_pixels(pixels, out)),
        Array::new("horizon", n, || {
            let distances_of_hits = hits.distances();
            distances_of_hits.map(|distance| u8::from(distances.is_horizon(distance)))
        }),
    ];
    let is_written = |array: &Array| film.extra.written.has(array.name);
    point_data.extend(of_cloud.into_iter().filter(is_written));
    write(&DataSet::Grid(vertices(
        n,
        array(Column::points(film)),
        point_data,
    )))
}

/// Returns a cloud of `n` points.
pub fn vertices<'a>(n: usize, points: Array<'a>, point_data: Vec<Array<'a>>) -> CellMesh<'a> {
    let [connectivity, offsets] = separate_cells(1, n);
    CellMesh {
        n_points: n,
        n_cells: n,
        points,
        point_data,
        cell_data: Vec::new(),
        cells: vec![connectivity, offsets, types_of(CellType::Vertex, n)],
    }
}

/// The pixels of a film with a hit, computed once for all arrays of the file.
struct Hits<'a> {
    film: &'a Film,
    /// The runs of adjacent hits in each strip, as indices into the strip.
    runs: Vec<Vec<Range<usize>>>,
    n: usize,
}

impl<'a> Hits<'a> {
    fn new(film: &'a Film, rows: &Range<u32>) -> Self {
        let runs_of = |strip: &Strip| {
            if rows.contains(&strip.first_row) {
                hit_runs(&strip.object).collect()
            } else {
                Vec::new()
            }
        };
        let runs: Vec<Vec<_>> = film.strips.iter().map(runs_of).collect();
        let n = runs.iter().flatten().map(Range::len).sum();
        Self { film, runs, n }
    }

    /// Returns the strips with hits, each with its runs.
    fn strips(&self) -> impl Iterator<Item = (&'a Strip, &[Range<usize>])> {
        self.film
            .strips
            .iter()
            .zip(self.runs.iter().map(Vec::as_slice))
            .filter(|(_, runs)| !runs.is_empty())
    }

    /// Returns the distances of the hits.
    fn distances(&self) -> impl Iterator<Item = f32> {
        self.strips().flat_map(|(strip, runs)| {
            let of_run = |run: &Range<usize>| &strip.distance[run.clone()];
            runs.iter().flat_map(of_run).copied()
        })
    }

    fn write_values(&self, column: &Column, out: &mut dyn Write) -> io::Result<()> {
        let stride = column.stride();
        let mut buffer = Vec::new();
        self.strips().try_for_each(|(strip, runs)| {
            let bytes = column.bytes(self.film, strip, &mut buffer);
            runs.iter()
                .try_for_each(|run| out.write_all(&bytes[run.start * stride..run.end * stride]))
        })
    }

    fn write_pixels(&self, integers: Integers, out: &mut dyn Write) -> io::Result<()> {
        self.strips().try_for_each(|(strip, runs)| {
            let first = strip.first_row as usize * self.film.grid.width as usize;
            runs.iter().try_for_each(|run| {
                integers.write_multiples(1, first + run.start..first + run.end, out)
            })
        })
    }
}

/// Returns the runs of adjacent pixels whose object is not -1.
fn hit_runs(objects: &[i32]) -> impl Iterator<Item = Range<usize>> {
    let mut next = 0;
    std::iter::from_fn(move || {
        let start = next + objects[next..].iter().position(|&object| object >= 0)?;
        let run = &objects[start..];
        next = start
            + run
                .iter()
                .position(|&object| object < 0)
                .unwrap_or(run.len());
        Some(start..next)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_the_hits() {
        let runs = |objects: &[i32]| hit_runs(objects).collect::<Vec<_>>();
        assert_eq!(runs(&[]), []);
        assert_eq!(runs(&[-1, -1]), []);
        assert_eq!(runs(&[0, 3, -1, 2]), [0..2, 3..4]);
        assert_eq!(runs(&[-1, 0, 0, -1, 0]), [1..3, 4..5]);
    }
}
