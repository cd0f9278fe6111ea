//! The values of the keys in ParaView states.

mod attribution;
mod tiles;
mod rays;

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use attribution::AttributionValues;
pub(super) use rays::of_rays;
use tiles::TileValues;

use super::distances::Distances;
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

/// The states of a rendering's folder.
pub(super) struct States<'a> {
    folder: &'a OutputFolder,
    values: StateValues,
    /// The range of the preferred cost metric.
    cost_range: Range,
    distances: Distances,
}

/// The values of a rendering, or of several, for all states.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct StateValues {
    /// The axis of the preferred cost metric, or of the distance if no cost was
    /// measured.
    cost: Axis,
    counter: Option<Axis>,
    camera: ViewCamera,
    /// Width and height of the picture.
    size: [f64; 2],
    schedule: TileValues,
    has_hits: bool,
    /// Whether tiles or renderings are missing.
    #[serde(default)]
    is_partial: bool,
    /// Largest distance of hits that are shown.
    max_distance: f64,
    attribution: AttributionValues,
}

impl<'a> States<'a> {
    /// Computes the values for this rendering's files in this folder.
    pub(super) fn new(rendering: &RenderingView, folder: &'a OutputFolder) -> Self {
        let (values, cost_range, distances) = StateValues::of(rendering);
        Self {
            folder,
            values,
            cost_range,
            distances,
        }
    }

    /// The range of the preferred cost metric.
    pub(super) fn cost_range(&self) -> &Range {
        &self.cost_range
    }

    /// How far the hits are.
    pub(super) fn distances(&self) -> &Distances {
        &self.distances
    }

    /// The values without the paths of the files.
    pub(super) fn values(&self) -> &StateValues {
        &self.values
    }

    /// The state `geometry.pvsm`.
    pub(super) fn geometry(&self) -> String {
        self.filled(GEOMETRY_TEMPLATE)
    }

    /// Returns a template with its keys replaced by values, in ASCII.
    pub(super) fn filled(&self, template: &str) -> String {
        self.values
            .filled(template, |file| self.folder.path_of(file))
    }
}

impl StateValues {
    /// The values of a rendering, the range of its preferred cost metric, and how far its
    /// hits are.
    fn of(rendering: &RenderingView) -> (Self, Range, Distances) {
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
        let values = Self {
            cost: cost.with_labels(n_labels),
            counter: counter.map(|counter| counter.with_labels(n_labels)),
            camera: ViewCamera::of(&rendering.scene.image_plane, distances.median),
            size,
            schedule: TileValues::of(rendering.schedule, n_labels),
            has_hits: distances.median.is_some(),
            is_partial: rendering.partial.is_some(),
            max_distance: distances.max_shown,
            attribution: AttributionValues::of(rendering),
        };
        (values, cost_range, distances)
    }

    /// The values for the files of both: axes that span all values, and the camera of the
    /// first.
    pub(crate) fn spanning(&self, other: &Self) -> Self {
        let counters = self.counter.as_ref().zip(other.counter.as_ref());
        Self {
            cost: self.cost.spanning(&other.cost),
            counter: counters.map(|(a, b)| a.spanning(b)),
            camera: self.camera.clone(),
            size: self.size,
            schedule: self.schedule.spanning(&other.schedule),
            has_hits: self.has_hits || other.has_hits,
            is_partial: self.is_partial || other.is_partial,
            max_distance: self.max_distance.max(other.max_distance),
            attribution: self.attribution.spanning(&other.attribution),
        }
    }

    /// Returns a template with its keys replaced by values, in ASCII; `path_of` returns the
    /// path of a file.
    pub(crate) fn filled(&self, template: &str, path_of: impl Fn(&str) -> PathBuf) -> String {
        fill(template, |key| {
            if files().any(|file| file.name == key) {
                return Some(path_of(key).to_string_lossy().into_owned().into());
            }
            self.value(key)
        })
    }

    /// The value of a key; titles say if the picture is partial.
    fn value(&self, key: &str) -> Option<StateValue> {
        let value = self.value_of_whole(key);
        let is_title = ["cost.title", "counter.title", "hits.caption"].contains(&key);
        match value {
            Some(StateValue::One(title)) if self.is_partial && is_title => {
                Some(format!("{title} (partial picture)").into())
            }
            value => value,
        }
    }

    fn value_of_whole(&self, key: &str) -> Option<StateValue> {
        match key {
            "hits.max_distance" => return Some(self.max_distance.to_string().into()),
            "hits.caption" if !self.has_hits => {
                return Some("True colors: no ray met anything".into());
            }
            "hits.caption" if self.is_partial => return Some("True colors".into()),
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
