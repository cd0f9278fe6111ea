//! `diff.vti`: what every cost of every pixel changed by.

use std::io::{self, Seek, Write};

use vtkio::model::ScalarType;

use super::measure::{Measure, ratio};
use super::{Diff, Side, picture};
use crate::provenance::RunId;
use crate::vtk::array::Array;
use crate::vtk::header::DataSet;
use crate::vtk::{Codec, Encoding, appended};

/// The file's name.
pub(super) const FILE: &str = "diff.vti";

/// Writes an ImageData with one point a pixel, as `frame.vti`: `…_difference`,
/// B - A, and `…_ratio`, B / A, of every cost; the greatest difference of a
/// color channel; B's objects and tiles.
pub(super) fn write(
    diff: &Diff,
    sides: &[Side; 2],
    run: RunId,
    out: &mut (impl Write + Seek),
) -> io::Result<()> {
    let [width, height] = diff.size;
    let n_pixels = u64::from(width) * u64::from(height);
    let in_frame = Upward(width as usize);
    let names: Vec<(Measure, [String; 2])> = diff
        .totals
        .0
        .iter()
        .map(|total| {
            let names =
                ["difference", "ratio"].map(|what| format!("{}_{what}", total.measure.array));
            (total.measure, names)
        })
        .collect();
    let mut arrays = Vec::new();
    for (measure, [difference, ratio]) in &names {
        arrays.push(differences(*measure, difference, sides, in_frame, n_pixels));
        arrays.push(ratios(*measure, ratio, sides, in_frame, n_pixels));
    }
    arrays.push(Array {
        name: "RGB_difference",
        scalar: ScalarType::U8,
        n_components: 1,
        n_bytes: n_pixels,
        write: Box::new(move |out| {
            let [a, b] = sides;
            let apart = picture::by_pixel(&read(a.colors())?, &read(b.colors())?);
            in_frame.write(&apart, out)
        }),
    });
    for name in ["object", "tile"] {
        arrays.push(Array {
            name,
            scalar: ScalarType::I32,
            n_components: 1,
            n_bytes: 4 * n_pixels,
            write: Box::new(move |out| in_frame.write(&read(sides[1].ids(name))?, out)),
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

/// Exact: of times as 32-bit floats, as the times are; of counts as integers
/// wide enough for any.
fn differences<'a>(
    measure: Measure,
    name: &'a str,
    sides: &'a [Side; 2],
    in_frame: Upward,
    n_pixels: u64,
) -> Array<'a> {
    let (scalar, width) = match measure {
        Measure::TIME => (ScalarType::F32, 4),
        _ => (ScalarType::I64, 8),
    };
    Array {
        name,
        scalar,
        n_components: 1,
        n_bytes: width * n_pixels,
        write: Box::new(move |out| {
            let [a, b] = values(sides, measure)?;
            let difference = a.iter().zip(&b).map(|(a, b)| b - a);
            match measure {
                Measure::TIME => {
                    let times: Vec<f32> = difference.map(|time| time as f32).collect();
                    in_frame.write(&times, out)
                }
                _ => {
                    let counts: Vec<i64> = difference.map(|count| count as i64).collect();
                    in_frame.write(&counts, out)
                }
            }
        }),
    }
}

fn ratios<'a>(
    measure: Measure,
    name: &'a str,
    sides: &'a [Side; 2],
    in_frame: Upward,
    n_pixels: u64,
) -> Array<'a> {
    Array {
        name,
        scalar: ScalarType::F32,
        n_components: 1,
        n_bytes: 4 * n_pixels,
        write: Box::new(move |out| {
            let [a, b] = values(sides, measure)?;
            let pairs = a.iter().zip(&b);
            let ratios: Vec<f32> = pairs.map(|(&a, &b)| ratio([a, b]) as f32).collect();
            in_frame.write(&ratios, out)
        }),
    }
}

fn values([a, b]: &[Side; 2], measure: Measure) -> io::Result<[Vec<f64>; 2]> {
    Ok([read(a.values(measure))?, read(b.values(measure))?])
}

/// What was read before, so that only a change behind our back is an error.
fn read<T>(found: Result<T, crate::text::Diagnostic>) -> io::Result<T> {
    found.map_err(|error| io::Error::other(error.to_string()))
}

/// Rows of this many pixels, the last one first: VTK's rows go up.
#[derive(Clone, Copy)]
struct Upward(usize);

impl Upward {
    fn write<T: bytemuck::NoUninit>(self, values: &[T], out: &mut dyn Write) -> io::Result<()> {
        let mut rows = values.chunks_exact(self.0).rev();
        rows.try_for_each(|row| out.write_all(bytemuck::cast_slice(row)))
    }
}
