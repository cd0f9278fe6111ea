//! `tiles.vti`: every tile as a cell.

use std::io::{self, Seek, Write};

use super::RenderingView;
use super::file::{FileContent, OutputFile};
use render::schedule::{Schedule, TileRun};
use scene::config::{CostMode, OptionalOutput};
use tracer::cost::Metric;
use vtk::appended;
use vtk::array::{Array, Entry};
use vtk::data_set::DataSet;
use vtk::encoding::Encoding;

/// The file.
pub(super) const FILE: OutputFile = OutputFile {
    name: "tiles.vti",
    is_wanted: |request| request.has(OptionalOutput::Schedule),
    content: FileContent::Written(|job, out| {
        let RenderingView { schedule, film, .. } = job.rendering;
        write(schedule, film.cost, job.encoding(), out)
    }),
};

/// Writes the schedule as ImageData with one cell per tile, which covers the tile's pixels in
/// `frame.vti`, where pixel centers have integer coordinates. VTK orders rows from bottom to top
/// and the grid from top to bottom, so the grid's last row is written first. Tiles that the
/// picture's right or lower edge cuts are written as whole squares.
pub fn write(
    schedule: &Schedule,
    cost: CostMode,
    encoding: impl Into<Encoding>,
    out: &mut (impl Write + Seek),
) -> io::Result<()> {
    let grid = &schedule.grid;
    let spacing = f64::from(grid.tile_size);
    let top = f64::from(grid.height) - 0.5;
    let mut cell_data = times(schedule);
    if schedule.n_ranks() > 1 {
        cell_data.push(array("rank", schedule, |_, run| {
            unless_missing(run, run.rank)
        }));
    }
    if cost.has_counters() {
        cell_data.extend(counters(schedule));
    }
    let cells = DataSet::ImageCells {
        size: [grid.n_columns, grid.n_rows],
        origin: [-0.5, top - f64::from(grid.n_rows) * spacing],
        spacing,
        cell_data,
    };
    appended::write(&cells, encoding.into(), out)
}

/// Returns the time span and the thread of each tile.
fn times(schedule: &Schedule) -> Vec<Array<'_>> {
    let time = |name, ns: fn(&TileRun) -> u64| {
        let times = array(name, schedule, move |_, run| ns(run) as f64);
        times.in_unit(Metric::TIME.unit_label())
    };
    vec![
        time("start_ns", |run| run.start_ns),
        time("end_ns", |run| run.end_ns),
        time("duration_ns", TileRun::duration_ns),
        time("film_ns", |run| run.film_ns),
        time("warm_up_ns", |run| run.warm_up_ns),
        time("waiting_ns", |run| run.waiting_ns),
        array("thread", schedule, |_, run| unless_missing(run, run.thread)),
        array("position", schedule, |_, run| {
            unless_missing(run, run.position)
        }),
        array("tile", schedule, |number, _| number as i32),
    ]
}

/// Returns a number of a tile; -1 if the tile was not rendered.
fn unless_missing(run: &TileRun, number: u32) -> i32 {
    if run.is_missing { -1 } else { number as i32 }
}

/// Returns the totals of the pixels' counters in each tile except samples, which equal the rays
/// without a kind; for `depth` the maximum.
fn counters(schedule: &Schedule) -> impl Iterator<Item = Array<'_>> {
    let sum = |metric: Metric| {
        let sums = array(metric.name, schedule, move |_, run| {
            metric.value(&run.counted)
        });
        sums.in_unit(metric.unit_label())
    };
    Metric::counted(false).map(sum)
}

/// Returns an array with one value per tile, given the tile's number and run.
fn array<'a, E: Entry>(
    name: &'static str,
    schedule: &'a Schedule,
    value: impl Fn(usize, &TileRun) -> E + Copy + Sync + 'a,
) -> Array<'a> {
    let n_columns = schedule.grid.n_columns as usize;
    let runs = &schedule.runs;
    Array::new(name, runs.len(), move || {
        let upward = (0..runs.len()).step_by(n_columns).rev();
        upward
            .flat_map(move |first| first..first + n_columns)
            .map(move |number| value(number, &runs[number]))
    })
}
