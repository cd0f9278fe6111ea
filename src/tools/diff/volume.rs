//! `diff.vti`: the change of every metric in every pixel.

use std::io::{self, Seek, Write};

use super::file::DiffFile;
use super::{Diff, Side, picture, ratio};
use base::provenance::RunId;
use output::writers::run_fields;
use tracer::cost::{Metric, MetricUnit};
use vtk::array::{Array, Entry};
use vtk::data_set::{DataSet, Extent};
use vtk::{Codec, Encoding, appended};

/// The file.
pub(super) const FILE: DiffFile = DiffFile {
    name: "diff.vti",
    write: |job, out| write(job.diff, job.sides, job.run, out),
};

/// Writes an ImageData with one point per pixel, like `frame.vti`: `…_difference`, B - A, and
/// `…_ratio`, B / A, of every metric; `RGB_difference`, the greatest difference of a color channel;
/// `object` and `tile` of B.
fn write(
    diff: &Diff,
    sides: &[Side; 2],
    run: RunId,
    out: &mut (impl Write + Seek),
) -> io::Result<()> {
    let pixels = Pixels { size: diff.size };
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
        arrays.push(differences(*metric, difference, sides, pixels));
        arrays.push(ratios(*metric, ratio, sides, pixels));
    }
    let [a, b] = sides;
    arrays.push(pixels.array("RGB_difference", move || {
        Ok(picture::by_pixel(&read(a.colors())?, &read(b.colors())?))
    }));
    for name in ["object", "tile"] {
        arrays.push(pixels.array(name, move || read(b.ids(name))));
    }
    let image = DataSet::Image {
        extent: Extent::of_size(diff.size),
        point_data: arrays,
    };
    let encoding = Encoding {
        codec: Codec::None,
        run: Some(run),
        fields: run_fields(&[a, b].map(|side| side.summary().scene.name.as_str()), run),
    };
    appended::write(&image, encoding, out)
}

/// Creates the array of a metric's differences: of times and ratios as 32-bit floats, as in `frame.vti`, of
/// counters as 64-bit integers.
fn differences<'a>(
    metric: Metric,
    name: &'a str,
    sides: &'a [Side; 2],
    pixels: Pixels,
) -> Array<'a> {
    let differences = move || {
        let [a, b] = values(sides, metric)?;
        io::Result::Ok(b.into_iter().zip(a).map(|(b, a)| b - a))
    };
    let differences = match metric.unit {
        MetricUnit::Count => pixels.array(name, move || {
            Ok(differences()?.map(|count| count as i64).collect())
        }),
        MetricUnit::Nanoseconds | MetricUnit::Ratio => pixels.array(name, move || {
            Ok(differences()?.map(|value| value as f32).collect())
        }),
    };
    differences.in_unit(metric.unit_label())
}

/// Creates the array of a metric's ratios.
fn ratios<'a>(metric: Metric, name: &'a str, sides: &'a [Side; 2], pixels: Pixels) -> Array<'a> {
    pixels.array(name, move || {
        let [a, b] = values(sides, metric)?;
        let pairs = a.into_iter().zip(b);
        Ok(pairs.map(|(a, b)| ratio([a, b]) as f32).collect())
    })
}

fn values([a, b]: &[Side; 2], metric: Metric) -> io::Result<[Vec<f64>; 2]> {
    Ok([read(a.values(metric))?, read(b.values(metric))?])
}

/// Converts the error of reading an array again, which happens only if another program has changed
/// the file since.
fn read<T>(found: Result<T, base::text::Diagnostic>) -> io::Result<T> {
    found.map_err(|error| io::Error::other(error.to_string()))
}

/// The pixels of the picture.
#[derive(Clone, Copy)]
struct Pixels {
    /// Width and height.
    size: [u32; 2],
}

impl Pixels {
    /// Creates an array with one entry per pixel. `entries`, row-major, row 0 on top, is called
    /// when the array is written; the file has the bottom row first, as VTK orders them.
    fn array<'a, E: Entry>(
        self,
        name: &'a str,
        entries: impl Fn() -> io::Result<Vec<E>> + 'a,
    ) -> Array<'a> {
        let [width, height] = self.size.map(|n| n as usize);
        Array {
            name,
            scalar: E::SCALAR,
            n_components: E::N_COMPONENTS,
            n_bytes: (width * height * size_of::<E>()) as u64,
            unit: None,
            write: Box::new(move |out| {
                let entries = entries()?;
                let mut bottom_up = entries.chunks_exact(width).rev();
                bottom_up.try_for_each(|row| out.write_all(bytemuck::cast_slice(row)))
            }),
        }
    }
}
