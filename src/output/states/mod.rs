//! The values of the keys in ParaView states.

mod attribution;
mod tiles;
mod rays;

use attribution::AttributionValues;
pub(super) use rays::of_rays;
use tiles::TileValues;

use super::{RenderingView, files};
use crate::chart::Range;
use crate::cost::Metric;
use crate::film::Film;
use crate::folder::OutputFolder;
use crate::paraview::{Axis, ColorScale, Panels, StateValue, ViewCamera, fill, value_of_panels};
use crate::statistics::floats_at;
use crate::text::numbers::capitalized;

/// The template of `geometry.pvsm`.
pub(super) const GEOMETRY_TEMPLATE: &str = include_str!("../../../paraview/geometry.pvsm");

/// The values of a rendering for all states.
pub(super) struct States<'a> {
    folder: &'a OutputFolder,
    /// The axis of the preferred cost metric, or of the distance if no cost was
    /// measured.
    cost: Axis,
    /// Its values.
    cost_range: Range,
    counter: Option<Axis>,
    camera: ViewCamera,
    /// Width and height of the picture.
    size: [f64; 2],
    schedule: TileValues,
    has_hits: bool,
    /// Largest distance of hits that are shown.
    max_distance: f64,
    attribution: AttributionValues,
}

impl<'a> States<'a> {
    /// Computes the values for this rendering's files in this folder.
    pub(super) fn new(rendering: &RenderingView, folder: &'a OutputFolder) -> Self {
        let film = rendering.film;
        let size = [film.grid.width, film.grid.height].map(f64::from);
        let n_labels = Panels::of(3, size).n_labels();
        let metrics = film.heatmap_metrics();
        let ((distances, counter), cost) = rayon::join(
            || {
                (
                    Distances::of(film),
                    metrics.map(|[_, second]| counter_axis(film, second)),
                )
            },
            || cost_axis(film, metrics.map(|[first, _]| first)),
        );
        let (cost, cost_range) = cost;
        Self {
            folder,
            cost: cost.with_labels(n_labels),
            cost_range,
            counter: counter.map(|counter| counter.with_labels(n_labels)),
            camera: ViewCamera::of(&rendering.scene.image_plane, distances.median),
            size,
            schedule: TileValues::of(rendering.schedule, n_labels),
            has_hits: distances.median.is_some(),
            max_distance: distances.max_shown,
            attribution: AttributionValues::of(rendering),
        }
    }

    /// The range of the preferred cost metric.
    pub(super) fn cost_range(&self) -> &Range {
        &self.cost_range
    }

    /// The state `geometry.pvsm`.
    pub(super) fn geometry(&self) -> String {
        self.filled(GEOMETRY_TEMPLATE)
    }

    /// Returns a template with its keys replaced by values, in ASCII.
    pub(super) fn filled(&self, template: &str) -> String {
        fill(template, |key| self.value(key))
    }

    fn value(&self, key: &str) -> Option<StateValue> {
        if files().any(|file| file.name == key) {
            let path = self.folder.path_of(key);
            return Some(path.to_string_lossy().into_owned().into());
        }
        match key {
            "hits.max_distance" => return Some(self.max_distance.to_string().into()),
            "hits.caption" if !self.has_hits => {
                return Some("True colors: no ray met anything".into());
            }
            _ => {}
        }
        if let Some(value) = self.camera.value(self.size, key) {
            return Some(value);
        }
        let part = key.split_once('.');
        match part? {
            ("cost", key) => self.cost.value(key),
            ("counter", key) => self.counter.as_ref()?.value(key),
            ("tiles", key) => self.schedule.value(key),
            _ => (self.attribution.value(key)).or_else(|| value_of_panels(self.size, key)),
        }
    }
}

/// Returns the axis of the preferred cost metric, without outliers as in
/// `cost.png`, and the range of its values.
fn cost_axis(film: &Film, metric: Option<Metric>) -> (Axis, Range) {
    let axis = |array, name, range: Range| {
        Axis::new(
            array,
            name,
            ColorScale::Logarithmic,
            [range.low, range.high],
        )
    };
    let Some(metric) = metric else {
        let range = Range::of(film.rows(|strip| &strip.distance).flatten());
        let axis = axis("distance", "Distance from the camera", range);
        return (axis, range);
    };
    let range = Range::of(&film.metric(metric));
    let axis = axis(metric.name, &capitalized(metric.title), range);
    let axis = if metric.is_timed() {
        axis.of_time()
    } else {
        axis
    };
    (axis, range)
}

/// Returns the axis of a metric from the 0.5 % to the 99.5 % quantile; its ends differ
/// by at least 1.
fn counter_axis(film: &Film, metric: Metric) -> Axis {
    let counts = film.metric(metric);
    let indices = [1, 199].map(|part| counts.len().saturating_sub(1) * part / 200);
    let [low, high] = floats_at(&counts, indices)
        .unwrap_or_default()
        .map(f64::from);
    let ends = [low, high.max(low + 1.0)];
    Axis::new(
        metric.name,
        &capitalized(metric.title),
        ColorScale::Linear,
        ends,
    )
}

/// The distances of the hits along their camera rays.
struct Distances {
    /// The lower median; `None` without hits.
    median: Option<f32>,
    /// Largest distance that is shown. ParaView clips points 1000 times nearer than
    /// the farthest one, and a plane has hits up to its horizon.
    max_shown: f64,
}

impl Distances {
    fn of(film: &Film) -> Self {
        let mut distances = Vec::new();
        for row in film.rows(|strip| &strip.distance) {
            distances.extend(row.iter().filter(|distance| distance.is_finite()));
        }
        let last = distances.len().saturating_sub(1);
        let indices = [1, 50, 99, 100].map(|percent| last * percent / 100);
        let Some([near, median, far, farthest]) = floats_at(&distances, indices) else {
            return Self {
                median: None,
                max_shown: 1.0,
            };
        };
        let cut = f64::from(near) * 300.0;
        Self {
            median: Some(median),
            max_shown: cut.max(far.into()).min(2.0 * f64::from(farthest)),
        }
    }
}
