//! The values of the keys in ParaView states.

mod attribution;
mod tiles;
mod rays;

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use attribution::AttributionValues;
pub(super) use rays::ray_state;
use tiles::TileValues;

use super::{FRAME_PVTI, FRAME_VTI, HITS_PVTU, HITS_VTU, RenderingView, files, time_notes};
use crate::chart::Range;
use crate::paraview::{Axis, ColorScale, Panels, StateValue, ViewCamera, fill, value_of_panels};
use base::numbers::capitalized;
use host::folder::OutputFolder;
use tracer::cost::Metric;

/// The template of `geometry.pvsm`.
pub(super) const GEOMETRY_TEMPLATE: &str = include_str!("geometry.pvsm");

/// The states of a rendering's folder.
pub(super) struct States<'a> {
    folder: &'a OutputFolder,
    values: StateValues,
    /// True if cloud and frame are in pieces.
    is_in_pieces: bool,
}

/// The values of a rendering, or of several, for all states.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StateValues {
    /// Scene, size and samples of the picture, such as `glass: 800 × 500 pixels, 4 samples per pixel`.
    #[serde(default)]
    subject: String,
    /// The axis of the files' preferred cost metric, or of the distance if they have no cost.
    cost: Axis,
    counter: Option<Axis>,
    camera: ViewCamera,
    /// Width and height of the picture.
    size: [f64; 2],
    schedule: TileValues,
    has_hits: bool,
    /// True if tiles or renderings are missing.
    #[serde(default)]
    is_partial: bool,
    /// The limits of the times, if these are shown.
    #[serde(default)]
    time_notes: Vec<String>,
    /// Maximum distance of hits that are shown.
    max_distance: f64,
    attribution: AttributionValues,
}

impl<'a> States<'a> {
    /// Computes the values for this rendering's files in this folder.
    pub(super) fn new(rendering: &RenderingView, folder: &'a OutputFolder) -> Self {
        Self {
            folder,
            values: StateValues::new(rendering),
            is_in_pieces: rendering.bands.is_some(),
        }
    }

    /// Returns the values without the paths of the files.
    pub(super) fn values(&self) -> &StateValues {
        &self.values
    }

    /// Returns the state `geometry.pvsm` with the names of files instead of their paths, so that a
    /// picture has the same bytes in any folder.
    pub(super) fn geometry(&self) -> String {
        self.with_paths(GEOMETRY_TEMPLATE, |file| file.into())
    }

    /// Returns a template with its keys replaced by values, in ASCII.
    pub(super) fn filled(&self, template: &str) -> String {
        self.with_paths(template, |file| self.folder.path_of(file))
    }

    fn with_paths(&self, template: &str, path_of: impl Fn(&str) -> PathBuf) -> String {
        if self.is_in_pieces {
            self.values.filled(&with_pieces(template), path_of)
        } else {
            self.values.filled(template, path_of)
        }
    }
}

impl StateValues {
    /// Returns the values of a rendering.
    fn new(rendering: &RenderingView) -> Self {
        let (film, survey) = (rendering.film, rendering.survey);
        let size = [film.grid.width, film.grid.height].map(f64::from);
        let n_labels = Panels::new(3, size).n_labels();
        let distances = &survey.distances;
        let [cost, counter] = survey.shown;
        let cost = cost.map_or_else(
            || range_axis("distance", "Distance from the camera", survey.shown_range),
            |first| metric_axis(first, survey.shown_range),
        );
        let counter = counter.map(|second| metric_axis(second, survey.counter_range));
        Self {
            subject: subject(rendering),
            cost: cost.with_labels(n_labels),
            counter: counter.map(|counter| counter.with_labels(n_labels)),
            camera: ViewCamera::new(&rendering.image_plane(), distances.median),
            size,
            schedule: TileValues::new(rendering.schedule, n_labels),
            has_hits: distances.median.is_some(),
            is_partial: rendering.partial.is_some(),
            time_notes: match survey.shown[0] {
                Some(metric) if metric.is_timed() => time_notes(rendering),
                _ => Vec::new(),
            },
            max_distance: distances.max_shown,
            attribution: AttributionValues::new(rendering),
        }
    }

    /// Returns the values for the files of both: axes that span all values, and the camera of the
    /// first.
    pub fn spanning(&self, other: &Self) -> Self {
        let counters = self.counter.as_ref().zip(other.counter.as_ref());
        Self {
            subject: self.subject.clone(),
            cost: self.cost.spanning(&other.cost),
            counter: counters.map(|(a, b)| a.spanning(b)),
            camera: self.camera.clone(),
            size: self.size,
            schedule: self.schedule.spanning(&other.schedule),
            has_hits: self.has_hits || other.has_hits,
            is_partial: self.is_partial || other.is_partial,
            time_notes: match &self.time_notes[..] {
                [] => other.time_notes.clone(),
                notes => notes.to_vec(),
            },
            max_distance: self.max_distance.max(other.max_distance),
            attribution: self.attribution.spanning(&other.attribution),
        }
    }

    /// Returns a template with its keys replaced by values, in ASCII; `path_of` returns the
    /// path of a file.
    pub fn filled(&self, template: &str, path_of: impl Fn(&str) -> PathBuf) -> String {
        fill(template, |key| {
            if files().any(|file| file.name == key) {
                return Some(path_of(key).to_string_lossy().into_owned().into());
            }
            self.value(key)
        })
    }

    /// Returns the value of a key; titles say if the picture is partial.
    fn value(&self, key: &str) -> Option<StateValue> {
        let value = self.value_of_whole(key);
        let is_title = ["cost.title", "counter.title", "hits.caption", "subject"].contains(&key);
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
            "hits.caption" | "subject" => return Some(self.subject.clone().into()),
            SUBJECT_AT_TIME => {
                let subject = self.subject.replace('{', "{{").replace('}', "}}");
                return Some(format!("{subject}, time {{time:g}}").into());
            }
            "histogram.title" => {
                let subject = std::iter::once(&self.subject);
                let parts: Vec<&str> = subject.chain(&self.time_notes).map(|it| &**it).collect();
                return Some(parts.join("; ").into());
            }
            "histogram.notes" => {
                let notes = self.time_notes.join("; ");
                return (!notes.is_empty()).then(|| notes.into());
            }
            "histogram.pixels" => {
                return Some((self.size[0] * self.size[1]).to_string().into());
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

/// Names the picture.
fn subject(rendering: &RenderingView) -> String {
    let (image, name) = (&rendering.config.image, rendering.name);
    let [width, height] = [image.width, image.height];
    format!(
        "{name}: {width} × {height} pixels, {} per pixel",
        image.samples()
    )
}

/// The key of the subject that ends with ParaView's time.
const SUBJECT_AT_TIME: &str = "subject.at_time";

/// Returns a template whose subject ends with ParaView's time, for a series.
pub fn with_time_in_subject(template: &str) -> String {
    let proxies = template.split_inclusive("</Proxy>");
    let replaced = proxies.map(|proxy| {
        if !proxy.contains("fill=\"subject\"") {
            return proxy.to_owned();
        }
        proxy
            .replace("\"TextSource\"", "\"TimeToTextConvertorSource\"")
            .replace("name=\"Text\"", "name=\"Format\"")
            .replace("\"subject\"", &format!("\"{SUBJECT_AT_TIME}\""))
    });
    replaced.collect()
}

/// Returns a template that reads the pieces of cloud and frame.
fn with_pieces(template: &str) -> String {
    const READERS: [(&str, &str, &str, &str); 2] = [
        (
            FRAME_VTI.name,
            FRAME_PVTI.name,
            "\"XMLImageDataReader\"",
            "\"XMLPImageDataReader\"",
        ),
        (
            HITS_VTU.name,
            HITS_PVTU.name,
            "\"XMLUnstructuredGridReader\"",
            "\"XMLPUnstructuredGridReader\"",
        ),
    ];
    let proxies = template.split_inclusive("</Proxy>");
    let replaced = proxies.map(|proxy| {
        let reads = |name: &str| proxy.contains(&format!("fill=\"{name}\""));
        match READERS.iter().find(|(one, ..)| reads(one)) {
            None => proxy.to_owned(),
            Some((one, pieces, reader, with_pieces)) => {
                proxy.replace(reader, with_pieces).replace(one, pieces)
            }
        }
    });
    with_surface(replaced.collect())
}

/// Puts a surface, which has all points, between the reader of a cloud's pieces and its consumers: a
/// threshold of ParaView 5.11 may crash at the grid of this reader, whose unset cell types look like
/// polyhedra.
fn with_surface(template: String) -> String {
    const READER: &str = "<Proxy group=\"sources\" type=\"XMLPUnstructuredGridReader\" id=\"";
    let reader = template
        .split_once(READER)
        .and_then(|it| it.1.split('"').next());
    let Some(reader) = reader else {
        return template;
    };
    // Above all others.
    let surface = format!("1000{reader}");
    let input = |id: &str| format!("<Proxy value=\"{id}\" output_port=\"0\"/>");
    let proxy = format!(
        "<Proxy group=\"filters\" type=\"DataSetSurfaceFilter\" id=\"{surface}\" servers=\"1\">
   <Property name=\"Input\" id=\"{surface}.Input\" number_of_elements=\"1\">
    {}
   </Property>
  </Proxy>
  {READER}",
        input(reader)
    );
    let name = format!("<Item id=\"{reader}\" name=");
    let names = format!("<Item id=\"{surface}\" name=\"Surface of the pieces\"/>\n   {name}");
    template
        .replace(&input(reader), &input(&surface))
        .replace(READER, &proxy)
        .replace(&name, &names)
}

/// Returns the axis of a metric without outliers, as in `cost.png`.
fn metric_axis(metric: Metric, range: Range) -> Axis {
    let axis = range_axis(metric.name, &capitalized(metric.title), range);
    if metric.is_timed() {
        axis.in_time_unit()
    } else {
        axis
    }
}

/// Returns the axis of an array over its range.
fn range_axis(array: &str, name: &str, range: Range) -> Axis {
    let ends = [range.low, range.high];
    Axis::new(array, name, ColorScale::Logarithmic, ends)
}
