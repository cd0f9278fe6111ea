//! `diff.vti`: the change of every metric in every pixel.

use std::io::{self, Seek, Write};
use std::ops::Range;

use super::file::DiffFile;
use super::{Diff, Side, picture, ratio};
use host::provenance::RunId;
use host::text::Diagnostic;
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

/// Writes an ImageData with one point per pixel, like `frame.vti`: `pixel_x` and `pixel_y` of B;
/// `…_difference`, B - A, and `…_ratio`, B / A, of every metric; `RGB_difference`, the greatest
/// difference of a color channel; `object` and `tile` of B.
fn write(
    diff: &Diff,
    sides: &[Side; 2],
    run: RunId,
    out: &mut (impl Write + Seek),
) -> io::Result<()> {
    let names: Vec<(Metric, [String; 2])> = diff
        .totals
        .0
        .iter()
        .map(|total| {
            let names = ["difference", "ratio"].map(|what| format!("{}_{what}", total.metric.name));
            (total.metric, names)
        })
        .collect();
    let [a, b] = sides;
    let axes = ["pixel_x", "pixel_y"].into_iter().enumerate();
    let coordinates = |(axis, name)| array(name, b, move |rows| Ok(b.coordinates(axis, rows)));
    let mut arrays: Vec<Array> = axes.map(coordinates).collect();
    for (metric, [difference, ratio]) in &names {
        arrays.push(differences(*metric, difference, sides));
        arrays.push(ratios(*metric, ratio, sides));
    }
    arrays.push(array("RGB_difference", b, move |rows| {
        let colors = [a.colors(rows.clone())?, b.colors(rows)?];
        Ok(picture::by_pixel(&colors[0], &colors[1]))
    }));
    for name in ["object", "tile"] {
        arrays.push(array(name, b, move |rows| b.ids(name, rows)));
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
fn differences<'a>(metric: Metric, name: &'a str, sides: &'a [Side; 2]) -> Array<'a> {
    let differences = move |rows| {
        let pairs = costs(sides, metric, rows)?;
        Ok(pairs.map(|[a, b]| b - a))
    };
    let [_, b] = sides;
    let differences = match metric.unit {
        MetricUnit::Count => array(name, b, move |rows| {
            Ok(differences(rows)?.map(|count| count as i64).collect())
        }),
        MetricUnit::Nanoseconds | MetricUnit::Ratio => array(name, b, move |rows| {
            Ok(differences(rows)?.map(|value| value as f32).collect())
        }),
    };
    differences.in_unit(metric.unit_label())
}

/// Creates the array of a metric's ratios.
fn ratios<'a>(metric: Metric, name: &'a str, sides: &'a [Side; 2]) -> Array<'a> {
    array(name, &sides[1], move |rows| {
        let pairs = costs(sides, metric, rows)?;
        Ok(pairs.map(|pair| ratio(pair) as f32).collect())
    })
}

/// Reads the costs of the pixels in `rows`, of A and B.
fn costs(
    [a, b]: &[Side; 2],
    metric: Metric,
    rows: Range<u32>,
) -> Result<impl Iterator<Item = [f64; 2]>, Diagnostic> {
    let a = a.costs(metric, rows.clone())?;
    let b = b.costs(metric, rows)?;
    Ok(a.into_iter().zip(b).map(|(a, b)| [a, b]))
}

/// Creates an array with one entry per compared pixel. `entries` returns the entries of some rows, the
/// upper row first; the file has the bottom row first, as VTK orders them.
fn array<'a, E: Entry>(
    name: &'a str,
    side: &'a Side,
    entries: impl Fn(Range<u32>) -> Result<Vec<E>, Diagnostic> + Sync + 'a,
) -> Array<'a> {
    let [width, height] = side.size().map(|n| n as usize);
    Array {
        name,
        scalar: E::SCALAR,
        n_components: E::N_COMPONENTS,
        n_bytes: (width * height * size_of::<E>()) as u64,
        unit: None,
        write: Box::new(move |out| {
            side.bands().rev().try_for_each(|rows| {
                // Fails only if another program has changed the file since.
                let entries = entries(rows).map_err(|error| io::Error::other(error.to_string()))?;
                let mut bottom_up = entries.chunks_exact(width).rev();
                bottom_up.try_for_each(|row| out.write_all(bytemuck::cast_slice(row)))
            })
        }),
    }
}
