//! The field data of VTK files: the scene, the run, the camera and the time.

use super::Survey;
use crate::paraview::ViewCamera;
use host::provenance::{self, RunId};
use scene::config::Config;
use vtk::Field;
use world::camera::{ImagePlane, Projection};

/// Maximum number of bytes of a list of names: they stand in the header of the file, whose readers
/// have limits.
const MAX_NAMES: usize = 1 << 17;

/// VTK's name for the time of a data set.
const TIME: &str = "TimeValue";

/// Returns the field data of a run: the scenes' names, raycost's version and the run's ID.
pub fn run(scenes: &[&str], run: RunId) -> Vec<Field> {
    vec![
        Field::texts("scene", scenes.iter().copied()),
        Field::texts("raycost_version", [env!("CARGO_PKG_VERSION")]),
        Field::texts(provenance::KEY, [run.to_string()]),
    ]
}

/// Returns the camera: position, direction and upward direction, which are unit vectors, in world
/// space; columns and rows of the picture; the horizontal and the vertical angle of view, in
/// degrees, or the picture's width and height if the rays are parallel.
pub(super) fn camera(plane: &ImagePlane) -> [Field; 5] {
    let camera = ViewCamera::new(plane, None);
    let [_, up, forward] = camera.axes();
    let vector = |name, v: glam::Vec3| Field::floats(name, v.to_array());
    let extent = match plane.projection {
        Projection::Perspective => {
            let degrees = camera.half().map(|half| 2.0 * half.atan().to_degrees());
            Field::floats("camera_fov_deg", degrees)
        }
        Projection::Parallel { .. } => {
            Field::floats("camera_size", camera.half().map(|half| 2.0 * half))
        }
        Projection::Panorama { .. } => Field::floats("camera_fov_deg", [360.0, 180.0]),
    };
    [
        Field::floats("camera_position", camera.position().to_array()),
        vector("camera_direction", forward),
        vector("camera_up", up),
        extent,
        Field::integers("resolution", plane.size.map(|n| n as i32)),
    ]
}

/// Returns the names that the numbers in the arrays `object` and `material` stand for, where they
/// take at most [`MAX_NAMES`].
pub(super) fn names(config: &Config) -> impl Iterator<Item = Field> {
    let objects: Vec<String> = config.object_labels().collect();
    let materials = config.materials.keys().cloned().collect();
    let lists = [("object_names", objects), ("material_names", materials)];
    let is_short = |(_, names): &(&str, Vec<String>)| {
        names.iter().map(String::len).sum::<usize>() <= MAX_NAMES
    };
    lists
        .into_iter()
        .filter(is_short)
        .map(|(name, names)| Field::texts(name, names))
}

/// Returns the time of a frame, as VTK and ParaView know it.
pub(super) fn time(time: f64) -> Field {
    Field::floats(TIME, [time])
}

/// Returns the range of the colors of `cost.png`, which excludes outliers, as `time_ns_range`;
/// `None` without cost, or if the files leave it out.
pub(super) fn cost_range(survey: &Survey) -> Option<Field> {
    let [metric, _] = survey.metrics?;
    let range = survey.range;
    (survey.shown[0] == Some(metric)).then(|| {
        let name = format!("{}_range", metric.name);
        Field::floats(name, [range.low, range.high])
    })
}
