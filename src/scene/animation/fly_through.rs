//! A camera that moves along a smooth path.

use std::fmt;
use std::sync::OnceLock;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::yaml::{Fault, FieldPath};
use world::kinds;
use world::values::{self, NonEmpty};

/// Moves the camera along a smooth path through all eyes, at constant speed.
///
/// ```
/// # use raycost_scene::animation::FlyThrough;
/// let path: FlyThrough = raycost_scene::yaml::from_str("
/// { eyes: [[0, 1, 6], [3, 1, 3], [3, 1, -3]], targets: [[0, 0, 0]] }
/// ").unwrap();
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[schemars(transform = world::values::expected::<Self>)]
#[serde(
    deny_unknown_fields,
    expecting = "a path such as { eyes: [[0, 1, 6], [3, 1, 3]] }"
)]
pub struct FlyThrough {
    /// Points of the path, at least two; the camera starts at the first.
    #[serde(with = "Points")]
    pub eyes: Vec<[f64; 3]>,
    /// Points that the camera looks at: one for all frames, or one per eye. Without targets the
    /// camera looks ahead along the path.
    #[serde(default, with = "Points")]
    pub targets: Vec<[f64; 3]>,
    #[serde(skip)]
    path: MeasuredPath,
}

/// The path through all eyes, measured for the first frame. It follows from the eyes: settings with
/// and without it are equal, and print the same.
#[derive(Clone, Default)]
struct MeasuredPath(OnceLock<Spline>);

impl fmt::Debug for MeasuredPath {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("MeasuredPath")
    }
}

impl PartialEq for MeasuredPath {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// A point of a scene.
#[derive(Deserialize, JsonSchema)]
#[serde(transparent)]
struct Point(#[serde(with = "values::Point")] glam::DVec3);

kinds! {
    Points: Vec<[f64; 3]> = NonEmpty::<Point>::of("point")
        => |points| points.into_iter().map(|Point(point)| point.to_array()).collect();
}

/// Number of parts into which a segment is divided to measure its length.
const N_PARTS: usize = 64;

impl FlyThrough {
    pub(super) fn check(&self, path: &FieldPath) -> Result<(), Fault> {
        let [eyes, targets] = ["eyes", "targets"].map(|key| path.clone().key(key));
        let n = self.eyes.len();
        if n < 2 {
            let message = "a path has two points or more";
            return Err(Fault::new(eyes, message, "expected a list of points"));
        }
        if let Some(index) = (1..n).find(|&i| self.eyes[i] == self.eyes[i - 1]) {
            let message = "the path has the same point twice in a row";
            return Err(Fault::new(
                eyes.index(index),
                message,
                "expected another point",
            ));
        }
        if ![0, 1, n].contains(&self.targets.len()) {
            let message = format!("a path of {n} eyes has {} targets", self.targets.len());
            let expected = format!("expected one target or {n}");
            return Err(Fault::new(targets, message, expected));
        }
        Ok(())
    }

    /// Returns the eye and the target at a frame.
    pub(super) fn pose(&self, frame: u32, n_frames: u32) -> [[f64; 3]; 2] {
        let part = f64::from(frame) / f64::from((n_frames - 1).max(1));
        let spline = self.path.0.get_or_init(|| Spline::through(&self.eyes));
        let (segment, u) = spline.at_length(part, &self.eyes);
        let eye = spline.point(&self.eyes, segment, u);
        let target = match self.targets.as_slice() {
            [] => {
                // The direction of a short chord, within the path.
                let (from, to) = ((u - 1e-3).max(0.0), (u + 1e-3).min(1.0));
                let [from, to] = [from, to].map(|u| spline.point(&self.eyes, segment, u));
                let length = distance(from, to).max(f64::MIN_POSITIVE);
                [0, 1, 2].map(|i| eye[i] + (to[i] - from[i]) / length)
            }
            [one] => *one,
            many => spline.point(many, segment, u),
        };
        [eye, target]
    }
}

/// A Catmull-Rom spline with centripetal knots, after Yuksel, Schaefer and Keyser,
/// "Parameterization and Applications of Catmull-Rom Curves", 2011: it has no loops or cusps
/// between its points.
#[derive(Clone)]
struct Spline {
    /// The knots of all points, and one more on each side.
    knots: Vec<f64>,
    /// The length of the path up to each point.
    lengths: Vec<f64>,
}

/// The knots between which each level of the pyramid interpolates.
const PYRAMID: [&[(usize, usize)]; 3] = [&[(0, 1), (1, 2), (2, 3)], &[(0, 2), (1, 3)], &[(1, 2)]];

impl Spline {
    fn through(points: &[[f64; 3]]) -> Self {
        let mut knots = vec![0.0];
        let n = points.len();
        for i in 0..=n {
            // The points beyond the ends mirror the nearest segments.
            let segment = i.saturating_sub(1).min(n - 2);
            let gap = distance(points[segment], points[segment + 1]).sqrt();
            knots.push(knots[i] + gap);
        }
        let mut spline = Self {
            knots,
            lengths: vec![0.0],
        };
        for segment in 0..n - 1 {
            let length = spline.lengths_within(points, segment).last();
            spline.lengths.extend(length);
        }
        spline
    }

    /// Returns the point of a segment at `u` from 0 to 1, by the pyramid of Barry and Goldman.
    fn point(&self, points: &[[f64; 3]], segment: usize, u: f64) -> [f64; 3] {
        let mirrored =
            |at: usize, beyond: usize| [0, 1, 2].map(|i| 2.0 * points[at][i] - points[beyond][i]);
        let last = points.len() - 1;
        let at = |k: usize| match k {
            0 => mirrored(0, 1),
            k if k - 1 > last => mirrored(last, last - 1),
            k => points[k - 1],
        };
        let t: [f64; 4] = std::array::from_fn(|k| self.knots[segment + k]);
        let x = t[1] + u * (t[2] - t[1]);
        let mut row: [[f64; 3]; 4] = std::array::from_fn(|k| at(segment + k));
        for spans in PYRAMID {
            for (k, &(from, to)) in spans.iter().enumerate() {
                let share = (x - t[from]) / (t[to] - t[from]);
                let (a, b) = (row[k], row[k + 1]);
                row[k] = [0, 1, 2].map(|i| a[i] + share * (b[i] - a[i]));
            }
        }
        row[0]
    }

    /// Returns the length of the path up to the end of each part of a segment.
    fn lengths_within(&self, points: &[[f64; 3]], segment: usize) -> impl Iterator<Item = f64> {
        let n_segments = points.len() - 1;
        let end = move |part: usize| {
            let segment = (part / N_PARTS).min(n_segments - 1);
            let u = (part - segment * N_PARTS) as f64 / N_PARTS as f64;
            self.point(points, segment, u)
        };
        let first = segment * N_PARTS;
        let parts = first..first + N_PARTS;
        parts.scan(self.lengths[segment], move |length, part| {
            *length += distance(end(part), end(part + 1));
            Some(*length)
        })
    }

    /// Returns the segment and the position in it at this fraction of the path's length.
    fn at_length(&self, part: f64, points: &[[f64; 3]]) -> (usize, f64) {
        let n_segments = points.len() - 1;
        let wanted = part * self.lengths[n_segments];
        let next = self.lengths.partition_point(|length| *length <= wanted);
        let segment = (next - 1).min(n_segments - 1);
        let mut before = self.lengths[segment];
        for (part, after) in self.lengths_within(points, segment).enumerate() {
            if after > wanted {
                let within = (wanted - before) / (after - before);
                let u = part as f64 / N_PARTS as f64;
                return (segment, u + within / N_PARTS as f64);
            }
            before = after;
        }
        (segment, 1.0)
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let square = |i: usize| (a[i] - b[i]) * (a[i] - b[i]);
    (square(0) + square(1) + square(2)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(eyes: &[[f64; 3]], targets: &[[f64; 3]]) -> FlyThrough {
        FlyThrough {
            eyes: eyes.to_vec(),
            targets: targets.to_vec(),
            path: MeasuredPath::default(),
        }
    }

    #[test]
    fn a_measured_path_changes_no_fingerprint() {
        let [fresh, used] = [(); 2].map(|()| path(&[[0.0; 3], [1.0, 0.0, 2.0]], &[]));
        used.pose(1, 3);
        assert_eq!(fresh, used);
        assert_eq!(format!("{fresh:?}"), format!("{used:?}"));
    }

    #[test]
    fn a_straight_path_has_equal_steps_and_looks_ahead() {
        let path = path(&[[0.0; 3], [1.0, 0.0, 0.0], [4.0, 0.0, 0.0]], &[]);
        for frame in 0..9 {
            let [eye, target] = path.pose(frame, 9);
            let expected = 0.5 * f64::from(frame);
            assert!((eye[0] - expected).abs() < 2e-3, "{frame}: {eye:?}");
            assert!((target[0] - eye[0] - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_bent_path_passes_through_its_points_at_constant_speed() {
        let eyes = [
            [0.0, 0.0, 0.0],
            [1.0, 2.0, 0.0],
            [5.0, 2.0, 1.0],
            [5.0, -1.0, 3.0],
        ];
        let path = path(&eyes, &eyes);
        assert_eq!(path.pose(0, 1000)[0], eyes[0]);
        assert!(distance(path.pose(999, 1000)[0], eyes[3]) < 1e-9);
        let points: Vec<[f64; 3]> = (0..1000).map(|frame| path.pose(frame, 1000)[0]).collect();
        for eye in eyes {
            let nearest = points.iter().map(|point| distance(*point, eye));
            assert!(nearest.fold(f64::MAX, f64::min) < 0.01);
        }
        let steps = points.windows(2).map(|pair| distance(pair[0], pair[1]));
        let (least, most) = steps.fold((f64::MAX, 0.0), |(least, most): (f64, f64), step| {
            (least.min(step), most.max(step))
        });
        assert!(most < 1.05 * least, "{least} to {most}");
        // Targets follow the same curve.
        let [eye, target] = path.pose(400, 1000);
        assert!(distance(eye, target) < 1e-12);
    }
}
