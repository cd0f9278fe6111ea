//! Metrics that compare the steps of a study: speedups, and differences of the pictures.

use std::path::Path;

use super::by_round::ByRound;
use super::sample::SampleStatistics;
use super::{Run, StatisticsRow, StudyPlan, StudyPoint};
use host::files;

/// The metric of a run that speedups compare.
pub(super) const STEP_TIME: &str = "render_wall_ms";
/// Maximum length in bytes of a picture that is compared.
const MAX_PICTURE: u64 = 1 << 30;

/// Returns rows of `speedup_over_step` and `speedup_over_start` for each measured step after the
/// first one, and of `picture_difference` for each step whose picture is in the folder `out`.
///
/// A speedup is a ratio of two runs of one round, which follow each other closely; its statistics
/// are those of the ratios of all rounds. Pictures are compared with that of the last step.
pub fn step_rows(plan: &StudyPlan, runs: &[Run], out: &Path) -> Vec<StatisticsRow> {
    let points = plan.points();
    let of_scenes = points.chunk_by(|a, b| a.scene == b.scene);
    let of_scenes = of_scenes.filter(|of_scene| of_scene[0].step().is_some());
    of_scenes
        .flat_map(|of_scene| rows_of(of_scene, plan, runs, out))
        .collect()
}

fn rows_of(
    points: &[StudyPoint],
    plan: &StudyPlan,
    runs: &[Run],
    out: &Path,
) -> Vec<StatisticsRow> {
    let times = points
        .iter()
        .map(|point| ByRound::new(plan, runs, &point.values, STEP_TIME));
    let measured: Vec<_> = points
        .iter()
        .zip(times)
        .filter(|(_, times)| !times.is_empty())
        .collect();
    let last = points.last().and_then(|point| read_picture(out, point));
    let mut rows = Vec::new();
    let mut add = |point: &StudyPoint, metric: &str, values: &[f64]| {
        let statistics = SampleStatistics::from_values(values);
        rows.extend(statistics.map(|statistics| StatisticsRow {
            point: point.values.clone(),
            metric: metric.to_owned(),
            statistics,
            first_is_slow: false,
            oversubscribed: false,
        }));
    };
    for (number, (point, times)) in measured.iter().enumerate() {
        if number > 0 {
            let [before, start] = [number - 1, 0].map(|step| measured[step].1.over(times));
            add(point, "speedup_over_step", &before);
            add(point, "speedup_over_start", &start);
        }
        let difference = greatest_difference(read_picture(out, point).as_ref(), last.as_ref());
        add(point, "picture_difference", difference.as_slice());
    }
    rows
}

/// Reads the picture that a step has left.
fn read_picture(out: &Path, point: &StudyPoint) -> Option<image::RgbImage> {
    let bytes = files::read(&out.join(point.picture()?), MAX_PICTURE).ok()?;
    Some(image::load_from_memory(&bytes).ok()?.into_rgb8())
}

/// Returns the greatest difference of a channel of two pictures of one size, from 0 to 255.
fn greatest_difference(
    one: Option<&image::RgbImage>,
    other: Option<&image::RgbImage>,
) -> Option<f64> {
    let (one, other) = one
        .zip(other)
        .filter(|(one, other)| one.dimensions() == other.dimensions())?;
    let channels = one.as_raw().iter().zip(other.as_raw());
    channels
        .map(|(a, b)| f64::from(a.abs_diff(*b)))
        .reduce(f64::max)
}
