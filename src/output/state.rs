//! `geometry.pvsm` and `heatmap.pvsm`: ParaView's states for this output.
//!
//! The states in the repository's `paraview/` folder are the templates. Each
//! value that hangs on the output carries its key there:
//!
//! ```xml
//! <Element index="0" value="$RAYCOST_OUT/frame.vti" fill="frame.vti"/>
//! ```
//!
//! Here the values take their places and the keys go.

use glam::Vec3;

use super::cost_picture::Range;
use super::{OutputFolder, Rendering, vtk};
use crate::camera::{ImagePlane, Projection};
use crate::film::Film;

const GEOMETRY: &str = include_str!("../../paraview/geometry.pvsm");
const HEATMAP: &str = include_str!("../../paraview/heatmap.pvsm");

/// The states of one output, in ASCII.
pub(super) struct States {
    hits: String,
    frame: String,
    has_cost: bool,
    camera: Camera,
    /// Width and height of the picture.
    size: [f64; 2],
    cost_range: [f64; 2],
    visits_range: [f64; 2],
    /// Hits farther away are not shown.
    max_distance: f64,
}

/// The template with every `value="…" fill="KEY"` replaced by
/// `value="VALUE"`; a key that `value` does not know keeps what the template
/// has. Values are escaped to ASCII.
fn fill(template: &str, value: impl Fn(&str) -> Option<String>) -> String {
    let mut filled = String::with_capacity(template.len());
    for line in template.split_inclusive('\n') {
        let Some((element, key, rest)) = marked(line) else {
            filled += line;
            continue;
        };
        let (before, old) = element.rsplit_once(" value=\"").unwrap_or((element, ""));
        let new = value(key).map_or_else(|| old.to_owned(), |text| escape(&text));
        filled += &format!("{before} value=\"{new}\"{rest}");
    }
    filled
}

/// `<Element … value="OLD` and `KEY` and what follows its quote, of a line
/// that has a key.
fn marked(line: &str) -> Option<(&str, &str, &str)> {
    let (element, mark) = line.split_once("\" fill=\"")?;
    let (key, rest) = mark.split_once('"')?;
    Some((element, key, rest))
}

/// XML text in ASCII, other characters by their numbers: a PNG's text chunk
/// holds no more.
fn escape(text: &str) -> String {
    let mut escaped = String::new();
    for character in text.chars() {
        match character {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            ' '..='~' => escaped.push(character),
            other => escaped += &format!("&#{};", u32::from(other)),
        }
    }
    escaped
}

impl States {
    /// The states that show this rendering's files in this folder.
    pub(super) fn new(rendering: &Rendering, folder: &OutputFolder) -> Self {
        let film = rendering.film;
        let distances = Distances::of(film);
        let path_of = |file| folder.path_of(file).to_string_lossy().into_owned();
        Self {
            hits: path_of(vtk::HITS),
            frame: path_of(vtk::FRAME),
            has_cost: film.has_cost,
            camera: Camera::of(&rendering.scene.image_plane, distances.median),
            size: [film.width, film.height].map(f64::from),
            cost_range: cost_range(film),
            visits_range: visits_range(film),
            max_distance: distances.max_shown,
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

    fn value(&self, key: &str) -> Option<String> {
        match key {
            vtk::HITS => Some(self.hits.clone()),
            vtk::FRAME => Some(self.frame.clone()),
            "cost.array" => Some(self.cost().0.to_owned()),
            "cost.title" => Some(self.cost().1.to_owned()),
            _ => self.number(key).map(|number| number.to_string()),
        }
    }

    /// The array that the cloud is coloured by, and its title.
    fn cost(&self) -> (&'static str, &'static str) {
        match self.has_cost {
            true => ("time_ns", "Time per pixel (ns)"),
            false => ("distance", "Distance from the camera"),
        }
    }

    fn number(&self, key: &str) -> Option<f64> {
        let logarithmic = key
            .strip_prefix("time_ns.log(")
            .or_else(|| key.strip_prefix("cost.log("));
        if let Some(fraction) = logarithmic {
            let [low, high] = self.cost_range;
            return between(fraction, |f| low * (high / low).powf(f));
        }
        if let Some(fraction) = key.strip_prefix("time_ns.log10(") {
            let [low, high] = self.cost_range.map(f64::log10);
            return between(fraction, |f| low + (high - low) * f);
        }
        if let Some(fraction) = key.strip_prefix("node_visits.linear(") {
            let [low, high] = self.visits_range;
            return between(fraction, |f| low + (high - low) * f);
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
fn between(fraction: &str, interpolate: impl Fn(f64) -> f64) -> Option<f64> {
    Some(interpolate(fraction.strip_suffix(')')?.parse().ok()?))
}

/// The values that the colours of the cost span, without outliers as in
/// `cost.png`; those of the distance where no cost was measured.
fn cost_range(film: &Film) -> [f64; 2] {
    let values: Vec<f32> = match film.has_cost {
        true => film.values(|strip| &strip.time_ns).collect(),
        false => film.values(|strip| &strip.distance).collect(),
    };
    let range = Range::of(&values);
    [range.low, range.high]
}

/// Least and greatest node visits of a pixel, at least 1 apart.
fn visits_range(film: &Film) -> [f64; 2] {
    let visits = || film.values(|strip| &strip.node_visits);
    let low = f64::from(visits().min().unwrap_or(0));
    let high = f64::from(visits().max().unwrap_or(0));
    [low, high.max(low + 1.0)]
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

/// ParaView's camera for the picture as a whole, in the middle part of a view
/// of usual shape, between its caption and its colour bar.
fn picture_camera([width, height]: [f64; 2], key: &str) -> Option<f64> {
    let scale = (height / (2.0 * 0.79)).max(width / (2.0 * 0.96 * 1.1));
    match key {
        "parallel_scale" => Some(scale),
        "center.0" => Some(0.5 * (width - 1.0)),
        "center.1" => Some(0.5 * (height - 1.0) - 0.18 * scale),
        _ => None,
    }
}

/// The scene's camera as ParaView has them: never off-axis, and right-handed.
struct Camera {
    position: Vec3,
    focal_point: Vec3,
    right: Vec3,
    up: Vec3,
    /// Tangent of half the view's angle, or half its height if parallel.
    half_height: f32,
    is_parallel: bool,
    is_mirrored: bool,
}

/// Part of a view's height and width that the picture fills.
const FILLED: [f32; 2] = [0.78, 0.76];

impl Camera {
    /// The camera of the plane's rays, wide enough for all of it.
    fn of(plane: &ImagePlane, median_distance: Option<f32>) -> Self {
        let center = plane.center();
        let (position, forward, is_parallel) = match plane.projection {
            Projection::Perspective { eye } => (eye, direction(plane, eye), false),
            Projection::Parallel { direction } => (center, direction, true),
        };
        let right = plane.right.reject_from(forward).normalize();
        let mirrored_up = right.cross(forward);
        let is_mirrored = mirrored_up.dot(plane.down) > 0.0;
        let up = if is_mirrored {
            -mirrored_up
        } else {
            mirrored_up
        };
        let half = |axis: Vec3| {
            let [w, h] = plane.size.map(|n| n as f32 - 0.5);
            let corners = [(-0.5, -0.5), (w, -0.5), (-0.5, h), (w, h)];
            let extent = |(x, y)| {
                let corner = plane.point(x, y) - position;
                let depth = if is_parallel {
                    1.0
                } else {
                    corner.dot(forward)
                };
                corner.dot(axis).abs() / depth
            };
            corners.into_iter().map(extent).fold(0.0, f32::max)
        };
        let distance = median_distance.unwrap_or_else(|| center.distance(position).max(1.0));
        Self {
            position,
            focal_point: position + distance * forward,
            right,
            up,
            half_height: (half(right) / FILLED[0]).max(half(up) / FILLED[1]),
            is_parallel,
            is_mirrored,
        }
    }

    /// The value of a key without its `camera.`.
    fn number(&self, key: &str) -> Option<f64> {
        let (name, index) = match key.split_once('.') {
            Some((name, index)) => (name, index.parse().ok()?),
            None => (key, 0),
        };
        let distance = self.focal_point.distance(self.position);
        let number = match name {
            "position" => *self.position.as_ref().get(index)?,
            "focal_point" => *self.focal_point.as_ref().get(index)?,
            "view_up" => *self.up.as_ref().get(index)?,
            "view_angle" if self.is_parallel => 30.0,
            "view_angle" => 2.0 * self.half_height.atan().to_degrees(),
            "parallel_projection" => f32::from(self.is_parallel),
            "parallel_scale" if self.is_parallel => self.half_height,
            "parallel_scale" => self.half_height * distance,
            "mirror" => self.mirror(index),
            _ => return None,
        };
        Some(number.into())
    }

    /// Entry `i` of the 4 x 4 matrix, row-major, that mirrors the scene for
    /// a camera whose x, y and view direction are left-handed, in the plane
    /// through the eye at right angles to x; else of the identity.
    fn mirror(&self, i: usize) -> f32 {
        let (row, column) = (i / 4, i % 4);
        let identity = if row == column { 1.0 } else { 0.0 };
        if !self.is_mirrored || row == 3 {
            return identity;
        }
        let along_row = 2.0 * self.right[row];
        match column {
            3 => along_row * self.right.dot(self.position),
            _ => identity - along_row * self.right[column],
        }
    }
}

/// Where to look from `eye`: straight at the plane, which shows the picture
/// undistorted, if that meets the picture; else at the picture's middle.
fn direction(plane: &ImagePlane, eye: Vec3) -> Vec3 {
    let to_center = plane.center() - eye;
    let normal = plane.right.normalize().cross(plane.down.normalize());
    let straight = to_center.project_onto_normalized(normal);
    let steps = |axis: Vec3| (to_center - straight).dot(axis).abs() / axis.length_squared();
    let [width, height] = plane.size.map(|n| n as f32);
    let meets_picture = steps(plane.right) <= 0.5 * width && steps(plane.down) <= 0.5 * height;
    if meets_picture { straight } else { to_center }.normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marked_values_are_replaced_and_the_marks_go() {
        let template =
            "<P>\n <E index=\"0\" value=\"old\" fill=\"a.b(0.5)\"/>\n <E value=\"1\"/>\n</P>";
        let filled = fill(template, |key| {
            assert_eq!(key, "a.b(0.5)");
            Some("<é & \"ü\">".to_owned())
        });
        let expected = "<P>\n <E index=\"0\" value=\"&lt;&#233; &amp; &quot;&#252;&quot;&gt;\"/>\n <E value=\"1\"/>\n</P>";
        assert_eq!(filled, expected);
        let kept = fill(template, |_| None);
        assert!(kept.contains("value=\"old\"/>"), "{kept}");
    }

    #[test]
    fn a_left_handed_plane_is_mirrored_about_the_eye() {
        let camera: crate::camera::Camera =
            crate::yaml::from_str("window: { eye: [3, 0, -1], x: [2, 4], y: [-1, 1], z: 0 }")
                .unwrap();
        let camera = Camera::of(&camera.image_plane(10, 10), None);
        assert!(camera.is_mirrored);
        let row: Vec<f32> = (0..4).map(|i| camera.mirror(i)).collect();
        assert_eq!(row, [-1.0, 0.0, 0.0, 6.0]);
        assert!((camera.up - Vec3::Y).length() < 1e-6);
    }

    #[test]
    fn an_off_axis_camera_looks_straight_at_its_window_where_it_can() {
        let focal_point = |eye: &str| {
            let text = format!("window: {{ eye: {eye}, x: [-1, 1], y: [-1, 1], z: 0 }}");
            let camera: crate::camera::Camera = crate::yaml::from_str(&text).unwrap();
            Camera::of(&camera.image_plane(10, 10), Some(1.0)).focal_point
        };
        assert_eq!(focal_point("[0.9, -0.5, -1]"), Vec3::new(0.9, -0.5, 0.0));
        let beside = focal_point("[4, 0, -3]");
        let to_middle = Vec3::new(3.2, 0.0, -2.4);
        assert!(beside.abs_diff_eq(to_middle, 1e-6), "{beside}");
    }

    #[test]
    fn a_look_at_camera_is_not_mirrored() {
        let camera: crate::camera::Camera =
            crate::yaml::from_str("look_at: { eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 90 }")
                .unwrap();
        let camera = Camera::of(&camera.image_plane(100, 100), Some(4.0));
        assert!(!camera.is_mirrored);
        assert!((camera.focal_point - Vec3::Z).length() < 1e-6);
        let angle = camera.number("view_angle").unwrap();
        assert!(angle > 90.0 && angle < 120.0, "{angle}");
    }
}
