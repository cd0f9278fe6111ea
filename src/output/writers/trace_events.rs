//! `trace.json`: the timeline of the run in Chrome's Trace Event Format, which ui.perfetto.dev and
//! chrome://tracing display.
//!
//! "Trace Event Format", docs.google.com/document/d/1CvAClvFfyA5R-PhYUmn5OOQtYMH4h6I0nSsKchNAySU.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::ops::Range;
use std::time::Instant;

use serde_json::{Value, json};

use super::RenderingView;
use super::file::{FileContent, OutputFile};
use host::provenance::{KEY, RunId};
use render::instruments::Stages;
use render::schedule::{Tile, TileRun};
use scene::config::OptionalOutput;
use tracer::cost::Metric;

/// The file.
pub(super) const FILE: OutputFile = OutputFile {
    name: "trace.json",
    is_wanted: |request| request.has(OptionalOutput::Schedule),
    content: FileContent::Written(|job, out| write(job.rendering, job.stages, job.run, out)),
};

/// The row of the stages in the timeline; the rows of the threads follow.
const STAGES: u32 = 0;

/// Writes the stages so far, every tile in the row of its thread, and the paths on a device in the
/// row of their multiprocessor, one event per line of text.
/// Times are in microseconds since the start of the program.
fn write(
    rendering: &RenderingView,
    stages: &Stages,
    run: RunId,
    out: &mut impl Write,
) -> io::Result<()> {
    let schedule = rendering.schedule;
    let has_counters = rendering.film.cost.has_counters();
    let since_begin = |moment: Instant| (moment - stages.begin).as_nanos() as u64;
    let names = name_rows(rendering);
    // Convert stages and tiles to events.
    let of_stages = stages.ended.iter().map(|stage| {
        let [start, end] = [stage.span.start, stage.span.end].map(since_begin);
        event(stage.name, (0, STAGES), start..end, json!({}))
    });
    let begin_ns = since_begin(schedule.begin);
    let of_tiles = schedule.rendered().map(|(number, run)| {
        let tile = schedule.grid.tile(number);
        let span = begin_ns + run.start_ns..begin_ns + run.end_ns;
        let args = arguments(&tile, run, has_counters);
        let line = (run.rank, line_of(run.thread));
        event(&format!("tile {number}"), line, span, args)
    });
    // Convert the runs of the device's multiprocessors, in a process after the ranks.
    let device = rendering.device.iter();
    let of_device = device
        .flat_map(|device| &device.multiprocessors)
        .map(|run| {
            let [start, end] = [run.begin, run.end].map(since_begin);
            let line = (schedule.n_ranks(), run.number);
            event("paths", line, start..end, json!({ "paths": run.paths }))
        });
    // Write the header, then one event per line.
    let partial = rendering.partial;
    let partial = partial.map(|partial| format!(",\"partial\":\"{partial}\""));
    let partial = partial.unwrap_or_default();
    writeln!(
        out,
        "{{\"displayTimeUnit\":\"ns\",\"otherData\":{{\"{KEY}\":\"{run}\"{partial}}},\"traceEvents\":["
    )?;
    for (i, event) in names
        .into_iter()
        .chain(of_stages)
        .chain(of_tiles)
        .chain(of_device)
        .enumerate()
    {
        if i > 0 {
            writeln!(out, ",")?;
        }
        serde_json::to_writer(&mut *out, &event)?;
    }
    writeln!(out, "\n]}}")
}

/// Returns the row of a thread.
fn line_of(thread: u32) -> u32 {
    STAGES + 1 + thread
}

/// Returns the names of the processes, one per rank, and of their rows.
fn name_rows(rendering: &RenderingView) -> Vec<Value> {
    let schedule = rendering.schedule;
    let runs = schedule.rendered().map(|(_, run)| (run.rank, run.thread));
    let used: BTreeSet<(u32, u32)> = runs.collect();
    let idle = (0..schedule.n_threads)
        .filter(|&thread| !used.iter().any(|(_, busy)| *busy == thread))
        .map(|thread| (0, thread));
    let threads: BTreeSet<(u32, u32)> = idle.chain(used.iter().copied()).collect();
    let of_rank = |rank: u32| match rank {
        0 => format!("raycost {}", rendering.name),
        rank => format!("rank {rank}"),
    };
    let ranks =
        (0..schedule.n_ranks()).map(|rank| name("process_name", (rank, STAGES), &of_rank(rank)));
    let stages = [name("thread_name", (0, STAGES), "stages")];
    let threads = threads.into_iter().map(|(rank, thread)| {
        let line = (rank, line_of(thread));
        name("thread_name", line, &format!("thread {thread}"))
    });
    ranks
        .chain(stages)
        .chain(threads)
        .chain(name_multiprocessors(rendering))
        .collect()
}

/// Returns the names of the device, which follows the ranks, and of its rows.
fn name_multiprocessors(rendering: &RenderingView) -> Vec<Value> {
    let Some(device) = rendering
        .device
        .filter(|device| !device.multiprocessors.is_empty())
    else {
        return Vec::new();
    };
    let process = rendering.schedule.n_ranks();
    let numbers = device.multiprocessors.iter().map(|run| run.number);
    let numbers: BTreeSet<u32> = numbers.collect();
    let rows = numbers.into_iter().map(|number| {
        let text = format!("multiprocessor {number}");
        name("thread_name", (process, number), &text)
    });
    let device = [name("process_name", (process, 0), &device.name)];
    device.into_iter().chain(rows).collect()
}

/// Returns a metadata event: the name of a rank's process or of one of its rows.
fn name(kind: &str, (rank, line): (u32, u32), name: &str) -> Value {
    json!({ "ph": "M", "name": kind, "pid": rank + 1, "tid": line, "args": { "name": name } })
}

/// Returns a complete event in a row of a rank's process; its time span is in nanoseconds.
fn event(name: &str, (rank, line): (u32, u32), span_ns: Range<u64>, arguments: Value) -> Value {
    json!({
        "ph": "X",
        "name": name,
        "pid": rank + 1,
        "tid": line,
        "ts": span_ns.start as f64 / 1e3,
        "dur": (span_ns.end - span_ns.start) as f64 / 1e3,
        "args": arguments,
    })
}

/// Returns the arguments of a tile's event, which viewers show for the selected event.
fn arguments(tile: &Tile, run: &TileRun, has_counters: bool) -> Value {
    let mut arguments = json!({
        "position": run.position,
        "x": tile.columns[0],
        "y": tile.rows[0],
        "n_pixels": tile.n_pixels(),
        "film_ns": run.film_ns,
        "warm_up_ns": run.warm_up_ns,
        "waiting_ns": run.waiting_ns,
    });
    if has_counters {
        for metric in Metric::counted(false) {
            arguments[metric.name] = metric.value(&run.counted).into();
        }
    }
    arguments
}
