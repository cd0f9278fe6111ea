//! The costs of the frames: a table, and a plot over time.

use indexmap::IndexSet;

use super::SeriesFrame;
use crate::study::Figure;
use host::provenance::{KEY, RunId, stamped};

/// The metrics that the plot may show, the preferred one first: name, unit and the factor to that
/// unit.
const PLOTTED: [(&str, &str, f64); 3] = [
    ("time_ns", "Thread time of all pixels (ms)", 1e-6),
    ("node_visits", "BVH nodes visited", 1.0),
    ("render_wall_ms", "Wall time of rendering (ms)", 1.0),
];

/// Returns one row per frame: its number, its time, the ID of its run, how its hierarchy was made
/// (built or refitted) and the expected cost, and its metrics.
pub(super) fn csv(frames: &[SeriesFrame]) -> String {
    let names: IndexSet<&String> = frames
        .iter()
        .flat_map(|frame| frame.metrics.0.keys())
        .collect();
    let mut table = vec![format!("frame,time,{KEY},hierarchy,sah_cost")];
    names.iter().for_each(|name| {
        table[0].push(',');
        table[0].push_str(name);
    });
    for frame in frames {
        let run = frame.run.map(|run| run.to_string()).unwrap_or_default();
        let (hierarchy, sah_cost) = match frame.bvh {
            None => ("", String::new()),
            Some(bvh) if bvh.is_refitted => ("refitted", bvh.sah_cost.to_string()),
            Some(bvh) => ("built", bvh.sah_cost.to_string()),
        };
        let (number, time) = (frame.number, frame.time);
        let mut row = format!("{number},{time},{run},{hierarchy},{sah_cost}");
        for name in &names {
            row.push(',');
            if let Some(value) = frame.metrics.0.get(*name) {
                row.push_str(&value.to_string());
            }
        }
        table.push(row);
    }
    table.join("\n") + "\n"
}

/// Returns the cost of the frames over time as SVG; `None` if nothing was measured.
pub(super) fn plot(title: &str, frames: &[SeriesFrame], run: RunId) -> Option<String> {
    let value = |frame: &SeriesFrame, name: &str| frame.metrics.0.get(name).copied();
    let is_measured =
        |(name, ..): &&(&str, &str, f64)| frames.iter().any(|frame| value(frame, name).is_some());
    let (name, y_title, factor) = PLOTTED.iter().find(is_measured)?;
    let point = |frame: &SeriesFrame| Some([frame.time, factor * value(frame, name)?]);
    let points = frames.iter().filter_map(point);
    let figure = Figure::line(
        &format!("{title}: cost over time"),
        ["Time", y_title],
        points,
    );
    Some(stamped(&figure.to_svg(), run))
}
