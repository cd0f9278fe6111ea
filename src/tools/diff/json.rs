//! A diff as JSON: the content of the report, and all groups.

use std::io::{self, Write};

use indexmap::IndexMap;
use serde::{Serialize, Serializer};
use serde_json::{Value, json};

use super::file::DiffFile;
use super::gate::Gate;
use super::group::PixelBounds;
use super::settings::Setting;
use super::{
    CostGroup, Diff, EqualNoise, KernelTimes, LightDifference, Noise, PictureDifference, Side,
    Total, Totals, ratio,
};
use host::provenance::RunId;
use math::statistics::CONFIDENCE;
use tracer::cost::MetricUnit;

/// The file.
pub(super) const FILE: DiffFile = DiffFile {
    name: "diff.json",
    write: |job, out| write(&DiffJson::new(job.diff, job.sides, job.gate), job.run, out),
};

/// The whole diff, for JSON. A ratio B / A with A = 0 < B is infinite: null in JSON.
#[derive(Serialize)]
pub struct DiffJson<'a> {
    raycost: &'static str,
    a: Value,
    b: Value,
    image: Value,
    origin: [u32; 2],
    totals: IndexMap<&'static str, TotalJson>,
    noise: Option<&'a Noise>,
    confidence: f64,
    gate: Option<&'a Gate>,
    #[serde(serialize_with = "one_by_one")]
    objects: &'a [CostGroup],
    #[serde(serialize_with = "one_by_one")]
    objects_reached: &'a [CostGroup],
    #[serde(serialize_with = "one_by_one")]
    tiles: &'a [CostGroup],
    picture: &'a PictureDifference,
    light: Option<&'a LightDifference>,
    equal_noise: Option<EqualNoise>,
    n_pixels_of_other_objects: u64,
    n_pixels_of_other_counters: Option<u64>,
    settings: &'a [Setting],
    machine: &'a [Setting],
    kernels: &'a [KernelTimes],
}

#[derive(Serialize)]
struct TotalJson {
    a: NumberJson,
    b: NumberJson,
    difference: NumberJson,
    ratio: f64,
}

#[derive(Serialize)]
#[serde(untagged)]
enum NumberJson {
    Count(i64),
    Other(f64),
}

#[derive(Serialize)]
struct GroupJson<'a> {
    name: &'a str,
    #[serde(flatten)]
    bounds: Option<PixelBounds>,
    totals: IndexMap<&'static str, TotalJson>,
}

/// A comparison with the ID of its files in front: a file is recognized by its first bytes.
#[derive(Serialize)]
struct Stamped<'a, T> {
    raycost_run: RunId,
    #[serde(flatten)]
    comparison: &'a T,
}

impl<'a> DiffJson<'a> {
    /// Describes a diff of `sides`, and the result of `--fail-above`.
    pub fn new(diff: &'a Diff, sides: &[Side; 2], gate: Option<&'a Gate>) -> Self {
        let [a, b] = sides.each_ref().map(side);
        Self {
            raycost: env!("CARGO_PKG_VERSION"),
            a,
            b,
            image: json!({ "width": diff.size[0], "height": diff.size[1] }),
            origin: sides[0].origin(),
            totals: totals(&diff.totals, |total| diff.ratio(total)),
            noise: diff.noise.as_ref(),
            confidence: CONFIDENCE,
            gate,
            objects: &diff.objects,
            objects_reached: &diff.reached,
            tiles: &diff.tiles,
            picture: &diff.picture,
            light: diff.light.as_ref(),
            equal_noise: diff.equal_noise,
            n_pixels_of_other_objects: diff.n_other_objects,
            n_pixels_of_other_counters: diff.n_other_counts,
            settings: &diff.settings,
            machine: &diff.machine,
            kernels: &diff.kernels,
        }
    }
}

/// Writes a comparison with this ID.
pub(super) fn write(
    comparison: &impl Serialize,
    run: RunId,
    out: &mut impl Write,
) -> io::Result<()> {
    let stamped = Stamped {
        raycost_run: run,
        comparison,
    };
    serde_json::to_writer_pretty(&mut *out, &stamped)?;
    writeln!(out)
}

pub(super) fn side(side: &Side) -> Value {
    json!({ "folder": side.name(), "scene": side.summary().scene })
}

/// Returns the totals by the names of the arrays.
fn totals(totals: &Totals, ratio_of: impl Fn(&Total) -> f64) -> IndexMap<&'static str, TotalJson> {
    let total = |total: &Total| {
        let number = |value: f64| match total.metric.unit {
            MetricUnit::Count => NumberJson::Count(value as i64),
            MetricUnit::Nanoseconds | MetricUnit::Ratio => NumberJson::Other(value),
        };
        let [a, b] = total.cost;
        let json = TotalJson {
            a: number(a),
            b: number(b),
            difference: number(b - a),
            ratio: ratio_of(total),
        };
        (total.metric.name, json)
    };
    totals.0.iter().map(total).collect()
}

/// Describes each group only when it is written: a large picture has hundreds of thousands of tiles.
fn one_by_one<S: Serializer>(groups: &[CostGroup], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(groups.iter().map(|group| GroupJson {
        name: &group.name,
        bounds: group.bounds,
        totals: totals(&group.totals, |total| ratio(total.cost)),
    }))
}
