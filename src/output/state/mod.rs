//! `geometry.pvsm`, `heatmap.pvsm` and the others: ParaView's states for this
//! output.
//!
//! The states in the repository's `paraview/` folder are the templates. Each
//! value that hangs on the output carries its key there:
//!
//! ```xml
//! <Element index="0" value="$RAYCOST_OUT/frame.vti" fill="frame.vti"/>
//! ```
//!
//! Here the values take their places and the keys go.

mod camera;
mod ledger;
mod rays;
mod template;

use camera::Camera;
pub(crate) use camera::picture_camera;
use ledger::LedgerValues;
pub(super) use rays::of_rays;
pub(crate) use template::fill;

use super::cost_picture::Range;
use super::measure::Measure;
use super::{OutputFolder, Rendering, vtk};
use crate::film::Film;
use crate::schedule::Schedule;

const GEOMETRY: &str = include_str!("../../../paraview/geometry.pvsm");
const HEATMAP: &str = include_str!("../../../paraview/heatmap.pvsm");
const OVERVIEW: &str = include_str!("../../../paraview/overview.pvsm");
const SCHEDULE: &str = include_str!("../../../paraview/schedule.pvsm");
const SURFACE: &str = include_str!("../../../paraview/surface.pvsm");
const BVH: &str = include_str!("../../../paraview/bvh.pvsm");

/// The states of one output, in ASCII.
pub(super) struct States {
    hits: String,
    frame: String,
    tiles: String,
    nodes: String,
    surface: String,
    /// What tells most of the cost, and what comes next.
    measures: Option<[Measure; 2]>,
    camera: Camera,
    /// Width and height of the picture.
    size: [f64; 2],
    cost_range: [f64; 2],
    counter_range: [f64; 2],
    schedule_ranges: ScheduleRanges,
    /// Hits farther away are not shown.
    max_distance: f64,
    ledger: LedgerValues,
}

impl States {
    /// The states that show this rendering's files in this folder.
    pub(super) fn new(rendering: &Rendering, folder: &OutputFolder) -> Self {
        let film = rendering.film;
        let measures = Measure::best_two(film);
        let ((distances, counter_range), cost_range) = rayon::join(
            || (Distances::of(film), counter_range(film, measures)),
            || cost_range(film, measures),
        );
        let path_of = |file| folder.path_of(file).to_string_lossy().into_owned();
        Self {
            hits: path_of(vtk::HITS),
            frame: path_of(vtk::FRAME),
            tiles: path_of(vtk::TILES),
            nodes: path_of(vtk::NODES),
            surface: path_of(vtk::SURFACE),
            measures,
            camera: Camera::of(&rendering.scene.image_plane, distances.median),
            size: [film.grid.width, film.grid.height].map(f64::from),
            cost_range,
            counter_range,
            schedule_ranges: ScheduleRanges::of(rendering.schedule),
            max_distance: distances.max_shown,
            ledger: LedgerValues::of(rendering),
        }
    }

    /// The cloud in its colours and by its cost.
    pub(super) fn geometry(&self) -> String {
        fill(GEOMETRY, |key| self.value(key))
    }

    /// The cost of all pixels.
    pub(super) fn heatmap(&self) -> String {
        fill(HEATMAP, |key| self.value(key))
    }

    /// Picture, cost, cloud and histogram on one page.
    pub(super) fn overview(&self) -> String {
        fill(OVERVIEW, |key| self.value(key))
    }

    /// When each tile was rendered, and by which thread.
    pub(super) fn schedule(&self) -> String {
        fill(SCHEDULE, |key| self.value(key))
    }

    /// The scene's surface by its cost.
    pub(super) fn surface(&self) -> String {
        fill(SURFACE, |key| self.value(key))
    }

    /// The dearest boxes of the hierarchy.
    pub(super) fn bvh(&self) -> String {
        fill(BVH, |key| self.value(key))
    }

    fn value(&self, key: &str) -> Option<String> {
        match key {
            vtk::NODES => Some(self.nodes.clone()),
            vtk::SURFACE => Some(self.surface.clone()),
            vtk::HITS => Some(self.hits.clone()),
            vtk::FRAME => Some(self.frame.clone()),
            vtk::TILES => Some(self.tiles.clone()),
            "cost.array" => Some(self.cost().0.to_owned()),
            "cost.title" => Some(self.cost().1.to_owned()),
            "cost.log10" => Some(format!("log10({})", self.cost().0)),
            "cost.log10.title" => Some(format!("{}, log scale", self.cost().1)),
            "counter.array" => Some(self.measures?[1].array.to_owned()),
            "counter.title" => Some(self.measures?[1].axis.to_owned()),
            _ => self
                .ledger
                .value(key)
                .or_else(|| self.number(key).map(|number| number.to_string())),
        }
    }

    /// The array that the cloud is coloured by, and its title: the distance
    /// where no cost was measured.
    fn cost(&self) -> (&'static str, &'static str) {
        match self.measures {
            Some([cost, _]) => (cost.array, cost.axis),
            None => ("distance", "Distance from the camera"),
        }
    }

    fn number(&self, key: &str) -> Option<f64> {
        if let Some(fraction) = key.strip_prefix("cost.log(") {
            let [low, high] = self.cost_range;
            return between(fraction, |f| low * (high / low).powf(f));
        }
        if let Some(fraction) = key.strip_prefix("cost.log10(") {
            let [low, high] = self.cost_range.map(f64::log10);
            return between(fraction, |f| low + (high - low) * f);
        }
        if let Some(fraction) = key.strip_prefix("counter.linear(") {
            let [low, high] = self.counter_range;
            return between(fraction, |f| low + (high - low) * f);
        }
        if let Some(rest) = key.strip_prefix("tiles.") {
            return self.schedule_ranges.number(rest);
        }
        if let Some(rest) = key.strip_prefix("image.") {
            return picture_camera(self.size, rest);
        }
        if key == "hits.max_distance" {
            return Some(self.max_distance);
        }
        self.camera.number(key.strip_prefix("camera.")?)
    }
}

/// The interpolated value for the text behind `log(` or `linear(`: a fraction
/// from 0 to 1 and a closing bracket.
pub(crate) fn between(fraction: &str, interpolate: impl Fn(f64) -> f64) -> Option<f64> {
    Some(interpolate(fraction.strip_suffix(')')?.parse().ok()?))
}

/// The values that the colours of the cost span, without outliers as in
/// `cost.png`; those of the distance where no cost was measured.
fn cost_range(film: &Film, measures: Option<[Measure; 2]>) -> [f64; 2] {
    let range = match measures {
        Some([cost, _]) => Range::of(&cost.of(film)),
        None => Range::of(film.rows(|strip| &strip.distance).flatten()),
    };
    [range.low, range.high]
}

/// Least and greatest value of the second measure, at least 1 apart.
fn counter_range(film: &Film, measures: Option<[Measure; 2]>) -> [f64; 2] {
    let counts = measures.map_or_else(Vec::new, |[_, counter]| counter.of(film));
    let least = counts.iter().copied().reduce(f32::min);
    let low = f64::from(least.unwrap_or(0.0));
    let high = counts.iter().copied().map(f64::from);
    [low, high.fold(low + 1.0, f64::max)]
}

/// The values that the colours of the tiles span.
struct ScheduleRanges {
    /// Without outliers: a thread that was interrupted shows no more than that.
    duration_ns: Range,
    last_start_ns: f64,
    last_thread: f64,
}

impl ScheduleRanges {
    fn of(schedule: &Schedule) -> Self {
        let runs = &schedule.runs;
        let durations: Vec<f32> = runs.iter().map(|run| run.duration_ns() as f32).collect();
        let last_start = runs.iter().map(|run| run.start_ns).max();
        Self {
            duration_ns: Range::of(&durations),
            last_start_ns: last_start.unwrap_or(0).max(1) as f64,
            last_thread: f64::from(schedule.n_threads - 1).max(1.0),
        }
    }

    /// The value of a key without its `tiles.`.
    fn number(&self, key: &str) -> Option<f64> {
        let (name, fraction) = key.split_once('(')?;
        match name {
            "duration.log" => {
                let Range { low, high, .. } = self.duration_ns;
                between(fraction, |f| low * (high / low).powf(f))
            }
            "start.linear" => between(fraction, |f| self.last_start_ns * f),
            "thread.linear" => between(fraction, |f| self.last_thread * f),
            _ => None,
        }
    }
}

/// How far the hits are along their camera rays.
struct Distances {
    /// `None` without hits.
    median: Option<f32>,
    /// Where the cloud is cut off, so that the near hits are seen: ParaView
    /// clips all that is 1000 times nearer than the farthest point, and a
    /// plane has hits up to its horizon.
    max_shown: f64,
}

impl Distances {
    fn of(film: &Film) -> Self {
        let mut distances: Vec<f32> = film
            .values(|strip| &strip.distance)
            .filter(|distance| distance.is_finite())
            .collect();
        if distances.is_empty() {
            return Self {
                median: None,
                max_shown: 1.0,
            };
        }
        let n = distances.len();
        let mut quantile = |percent: usize| {
            let rank = (n - 1) * percent / 100;
            *distances.select_nth_unstable_by(rank, f32::total_cmp).1
        };
        let [near, median, far, farthest] = [1, 50, 99, 100].map(&mut quantile);
        let cut = f64::from(near) * 300.0;
        Self {
            median: Some(median),
            max_shown: cut.max(far.into()).min(2.0 * f64::from(farthest)),
        }
    }
}
