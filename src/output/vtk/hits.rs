//! `hits.vtu`: the pixels that see something, as a cloud of points.

use std::io::{self, Write};
use std::ops::Range;

use vtkio::model::{CellType, ScalarType};

use super::appended::{self, Array};
use super::header::DataSet;
use crate::film::{Column, Film, Strip, columns};

/// The file's name.
pub const FILE: &str = "hits.vtu";

/// Numbers that are made at one go.
const CHUNK: usize = 1 << 14;

/// The points themselves, an array beside those of all pixels.
const POINTS: Column = Column {
    name: "Points",
    scalar: ScalarType::F32,
    n_components: 3,
    bytes: |strip| bytemuck::cast_slice(&strip.position),
};

/// Writes the film's hits as an UnstructuredGrid of one vertex a hit, in the
/// order of the pixels, row 0 on top.
pub fn write(film: &Film, out: &mut impl Write) -> io::Result<()> {
    let hits = Hits::of(film);
    let pixels = Integers::up_to(film.width as usize * film.height as usize);
    let n = hits.n;
    let column_array = |column| array(column, n, |out| hits.write_values(column, out));
    let mut point_data: Vec<Array> = columns(film.cost, film.n_repeats)
        .map(column_array)
        .collect();
    point_data.push(pixels.array("pixel", n, |out| hits.write_pixels(pixels, out)));
    let points = [column_array(&POINTS)];
    let cells = vertex_cells(n);
    let data_set = DataSet::vertices(n, &point_data, &points, &cells);
    appended::write(data_set, &[&point_data, &points, &cells], out)
}

/// Where a film's hits are. Found once: every array of the file walks them.
struct Hits<'a> {
    film: &'a Film,
    /// The runs of neighbouring hits of each strip, as indices into it.
    runs: Vec<Vec<Range<usize>>>,
    n: usize,
}

impl<'a> Hits<'a> {
    fn of(film: &'a Film) -> Self {
        let runs: Vec<Vec<_>> = film
            .strips
            .iter()
            .map(|strip| hit_runs(&strip.object).collect())
            .collect();
        let n = runs.iter().flatten().map(Range::len).sum();
        Self { film, runs, n }
    }

    /// Each strip with its runs.
    fn strips(&self) -> impl Iterator<Item = (&'a Strip, &[Range<usize>])> {
        self.film
            .strips
            .iter()
            .zip(self.runs.iter().map(Vec::as_slice))
    }

    fn write_values(&self, column: &Column, out: &mut dyn Write) -> io::Result<()> {
        let stride = column.stride();
        self.strips().try_for_each(|(strip, runs)| {
            let bytes = (column.bytes)(strip);
            runs.iter()
                .try_for_each(|run| out.write_all(&bytes[run.start * stride..run.end * stride]))
        })
    }

    fn write_pixels(&self, integers: Integers, out: &mut dyn Write) -> io::Result<()> {
        self.strips().try_for_each(|(strip, runs)| {
            let first = strip.first_row as usize * self.film.width as usize;
            runs.iter()
                .try_for_each(|run| integers.write(first + run.start..first + run.end, out))
        })
    }
}

/// The runs of neighbouring pixels whose object is not -1.
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

/// One VTK_VERTEX a point: `connectivity` 0, 1, …; `offsets`, the ends of the
/// cells, 1, 2, …
fn vertex_cells(n: usize) -> [Array<'static>; 3] {
    let ids = Integers::up_to(n);
    let types = Array {
        name: "types",
        scalar: ScalarType::U8,
        n_components: 1,
        n_bytes: n as u64,
        write: Box::new(move |out| {
            let vertices = [CellType::Vertex as u8; CHUNK];
            (0..n)
                .step_by(CHUNK)
                .try_for_each(|i| out.write_all(&vertices[..CHUNK.min(n - i)]))
        }),
    };
    [
        ids.array("connectivity", n, move |out| ids.write(0..n, out)),
        ids.array("offsets", n, move |out| ids.write(1..n + 1, out)),
        types,
    ]
}

fn array<'a>(
    column: &Column,
    n: usize,
    write: impl Fn(&mut dyn Write) -> io::Result<()> + 'a,
) -> Array<'a> {
    Array {
        name: column.name,
        scalar: column.scalar,
        n_components: column.n_components,
        n_bytes: (n * column.stride()) as u64,
        write: Box::new(write),
    }
}

/// Whole numbers in as few bytes as they need: ParaView loads 32-bit cells a
/// third faster than 64-bit ones.
#[derive(Clone, Copy)]
enum Integers {
    I32,
    I64,
}

impl Integers {
    /// For numbers from 0 to `largest`.
    fn up_to(largest: usize) -> Self {
        match i32::try_from(largest) {
            Ok(_) => Self::I32,
            Err(_) => Self::I64,
        }
    }

    fn array<'a>(
        self,
        name: &'static str,
        n: usize,
        write: impl Fn(&mut dyn Write) -> io::Result<()> + 'a,
    ) -> Array<'a> {
        let (scalar, n_bytes) = match self {
            Self::I32 => (ScalarType::I32, 4 * n as u64),
            Self::I64 => (ScalarType::I64, 8 * n as u64),
        };
        Array {
            name,
            scalar,
            n_components: 1,
            n_bytes,
            write: Box::new(write),
        }
    }

    fn write(self, numbers: Range<usize>, out: &mut dyn Write) -> io::Result<()> {
        for first in numbers.clone().step_by(CHUNK) {
            let chunk = first..numbers.end.min(first + CHUNK);
            match self {
                Self::I32 => {
                    let chunk: Vec<i32> = chunk.map(|n| n as i32).collect();
                    out.write_all(bytemuck::cast_slice(&chunk))?;
                }
                Self::I64 => {
                    let chunk: Vec<i64> = chunk.map(|n| n as i64).collect();
                    out.write_all(bytemuck::cast_slice(&chunk))?;
                }
            }
        }
        Ok(())
    }
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

    #[test]
    fn integers_beyond_32_bits_are_64_bits_wide() {
        let bytes = |integers: Integers, numbers| {
            let mut out = Vec::new();
            integers.write(numbers, &mut out).unwrap();
            out
        };
        assert_eq!(bytes(Integers::up_to(i32::MAX as usize), 7..9).len(), 8);
        let wide = bytes(Integers::up_to(1 << 31), (1 << 31)..(1 << 31) + 2);
        assert_eq!(wide[..8], (1_i64 << 31).to_ne_bytes());
    }
}
