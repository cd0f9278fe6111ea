//! `diff.vti`: the change of every metric in every pixel.

use std::io::{self, Seek, Write};

use vtkio::model::ScalarType;

use super::file::DiffFile;
use super::{Diff, Side, picture, ratio};
use crate::cost::Metric;
use crate::provenance::RunId;
use crate::vtk::array::Array;
use crate::vtk::data_set::DataSet;
use crate::vtk::{Codec, Encoding, appended};

/// The file.
pub(super) const FILE: DiffFile = DiffFile {
    name: "diff.vti",
    write: |job, out| write(job.diff, job.sides, job.run, out),
};

/// Writes an ImageData with one point per pixel, as `frame.vti`: `…_difference`,
/// B - A, and `…_ratio`, B / A, of every metric; `RGB_difference`, the greatest
/// difference of a color channel; `object` and `tile` of B.
fn write(
    diff: &Diff,
    sides: &[Side; 2],
    run: RunId,
    out: &mut (impl Write + Seek),
) -> io::Result<()> {
    let [width, height] = diff.size;
    let n_pixels = u64::from(width) * u64::from(height);
    let rows = BottomUp(width as usize);
    let names: Vec<(Metric, [String; 2])> = diff
        .totals
        .0
        .iter()
        .map(|total| {
            let names = ["difference", "ratio"].map(|what| format!("{}_{what}", total.metric.name));
            (total.metric, names)
        })
        .collect();
    let mut arrays = Vec::new();
    for (metric, [difference, ratio]) in &names {
        arrays.push(differences(*metric, difference, sides, rows, n_pixels));
        arrays.push(ratios(*metric, ratio, sides, rows, n_pixels));
    }
    arrays.push(Array {
        name: "RGB_difference",
        scalar: ScalarType::U8,
        n_components: 1,
        n_bytes: n_pixels,
        write: Box::new(move |out| {
            let [a, b] = sides;
            let difference = picture::by_pixel(&read(a.colors())?, &read(b.colors())?);
            rows.write(&difference, out)
        }),
    });
    for name in ["object", "tile"] {
        arrays.push(Array {
            name,
            scalar: ScalarType::I32,
            n_components: 1,
            n_bytes: 4 * n_pixels,
            write: Box::new(move |out| rows.write(&read(sides[1].ids(name))?, out)),
        });
    }
    let image = DataSet::Image {
        size: diff.size,
        point_data: arrays,
    };
    let encoding = Encoding {
        codec: Codec::None,
        run: Some(run),
    };
    appended::write(&image, encoding, out)
}

/// The differences of a metric: of times as 32-bit floats, as in `frame.vti`, of
/// counters as 64-bit integers.
fn differences<'a>(
    metric: Metric,
    name: &'a str,
    sides: &'a [Side; 2],
    rows: BottomUp,
    n_pixels: u64,
) -> Array<'a> {
    let (scalar, width) = match metric {
        Metric::TIME => (ScalarType::F32, 4),
        _ => (ScalarType::I64, 8),
    };
    Array {
        name,
        scalar,
        n_components: 1,
        n_bytes: width * n_pixels,
        write: Box::new(move |out| {
            let [a, b] = values(sides, metric)?;
            let difference = a.iter().zip(&b).map(|(a, b)| b - a);
            match metric {
                Metric::TIME => {
                    let times: Vec<f32> = difference.map(|time| time as f32).collect();
                    rows.write(&times, out)
                }
                _ => {
                    let counts: Vec<i64> = difference.map(|count| count as i64).collect();
                    rows.write(&counts, out)
                }
            }
        }),
    }
}

fn ratios<'a>(
    metric: Metric,
    name: &'a str,
    sides: &'a [Side; 2],
    rows: BottomUp,
    n_pixels: u64,
) -> Array<'a> {
    Array {
        name,
        scalar: ScalarType::F32,
        n_components: 1,
        n_bytes: 4 * n_pixels,
        write: Box::new(move |out| {
            let [a, b] = values(sides, metric)?;
            let pairs = a.iter().zip(&b);
            let ratios: Vec<f32> = pairs.map(|(&a, &b)| ratio([a, b]) as f32).collect();
            rows.write(&ratios, out)
        }),
    }
}

fn values([a, b]: &[Side; 2], metric: Metric) -> io::Result<[Vec<f64>; 2]> {
    Ok([read(a.values(metric))?, read(b.values(metric))?])
}

/// Converts the error of reading an array again, which happens only if another
/// program has changed the file since.
fn read<T>(found: Result<T, crate::text::Diagnostic>) -> io::Result<T> {
    found.map_err(|error| io::Error::other(error.to_string()))
}

/// Writes rows of this many pixels, the bottom row first, as VTK orders them.
#[derive(Clone, Copy)]
struct BottomUp(usize);

impl BottomUp {
    fn write<T: bytemuck::NoUninit>(self, values: &[T], out: &mut dyn Write) -> io::Result<()> {
        let mut bottom_up = values.chunks_exact(self.0).rev();
        bottom_up.try_for_each(|row| out.write_all(bytemuck::cast_slice(row)))
    }
}
