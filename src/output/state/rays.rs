//! `rays.pvsm`: rays in the cloud of the scene, by kind and by cost.

use glam::Vec3;

use super::camera::Camera;
use super::template::fill;
use super::{Distances, between};
use crate::observe::TracedRay;
use crate::output::OutputFolder;
use crate::output::reach::Reach;
use crate::output::traced::CLOUD;
use crate::output::vtk::{self, Rays};

const RAYS: &str = include_str!("../../../paraview/rays.pvsm");

/// Rays longer than this, in radii of the scene, are not shown: a plane has
/// hits up to its horizon, and ParaView clips all that is 1000 times nearer
/// than the farthest point.
const LONGEST: f32 = 50.0;
/// How far from the middle the points are that the view is to hold, in radii.
const FRAMED: f32 = 1.5;
/// So many rays are drawn as wide lines; more would cover each other.
const FEW: usize = 300;
/// The view's vertical angle in degrees.
const VIEW_ANGLE: f32 = 30.0;
/// Part of half a view's height that the rays fill, in both directions: the
/// view is higher than wide, and has a legend below.
const FILLED: f32 = 0.6;

/// The state that shows these rays.
pub(in crate::output) fn of_rays(rays: &Rays, folder: &OutputFolder) -> String {
    let path_of = |file| folder.path_of(file).to_string_lossy().into_owned();
    let camera = Camera::of(rays.plane(), None);
    let view = SideView::of(rays, &camera);
    let cost = Cost::of(rays);
    let max_distance = Distances::of(rays.cloud()).max_shown;
    let number = |key: &str| -> Option<f64> {
        if let Some(fraction) = key.strip_prefix("rays.cost.linear(") {
            return between(fraction, |f| f * f64::from(cost.high));
        }
        match key {
            "hits.max_distance" => Some(max_distance),
            "rays.line_width" => Some(if rays.n <= FEW { 3.0 } else { 1.0 }),
            "rays.max_length" => Some((LONGEST * rays.reach.radius).into()),
            _ => view
                .number(key.strip_prefix("rays.").unwrap_or_default())
                .or_else(|| camera.number(key.strip_prefix("camera.")?)),
        }
    };
    fill(RAYS, |key| match key {
        vtk::RAYS => Some(path_of(vtk::RAYS)),
        CLOUD => Some(path_of(CLOUD)),
        "rays.cost.array" => Some(cost.array.to_owned()),
        "rays.cost.title" => Some(cost.title.to_owned()),
        _ => number(key).map(|number| number.to_string()),
    })
}

/// What the right view is coloured by.
struct Cost {
    array: &'static str,
    title: &'static str,
    /// The end of the colours, greater than 0: the greatest value, but for one
    /// in 200, which may be an interruption by the system.
    high: f32,
}

impl Cost {
    /// The first measure that is not the same for all rays: a small hierarchy is
    /// one node, and there may be no clock.
    fn of(rays: &Rays) -> Self {
        let time: fn(&TracedRay) -> f32 = |ray| ray.time_ns;
        let measures = [
            ("time_ns", "Time of each ray (ns)", time),
            ("node_visits", "BVH nodes visited by each ray", |ray| {
                ray.node_visits as f32
            }),
            ("primitive_tests", "Primitive tests of each ray", |ray| {
                ray.primitive_tests as f32
            }),
        ];
        let [.., (array, title, _)] = measures;
        let varied = |(array, title, value)| {
            let high = high(rays.iter().map(value).collect())?;
            Some(Self { array, title, high })
        };
        measures.into_iter().find_map(varied).unwrap_or(Self {
            array,
            title,
            high: 1.0,
        })
    }
}

/// Where the colours of these values end; `None` if all are the same.
fn high(mut values: Vec<f32>) -> Option<f32> {
    values.sort_unstable_by(f32::total_cmp);
    let [low, .., high] = values[..] else {
        return None;
    };
    let rank = values.len() - 1 - values.len() / 200;
    (low < high).then(|| values[rank].max(1.0))
}

/// A camera that sees rays from their side: from where they start they are
/// points. In the world as ParaView shows it, mirrored for some scenes.
struct SideView {
    position: Vec3,
    focal_point: Vec3,
    up: Vec3,
}

impl SideView {
    fn of(rays: &Rays, camera: &Camera) -> Self {
        let [right, up, forward] = camera.axes();
        let back = (0.75 * right + 0.4 * up - 0.6 * forward).normalize();
        let to_right = up.cross(back).normalize();
        let axes = [to_right, back.cross(to_right), back];
        // Each point's coordinates from the ball's middle along these axes.
        let Reach { center, radius } = rays.reach;
        let center = camera.mirrored(center);
        let seen: Vec<Vec3> = rays
            .iter()
            .flat_map(|ray| rays.line(ray))
            .map(|point| camera.mirrored(point) - center)
            .filter(|point| point.length() <= FRAMED * radius)
            .map(|point| Vec3::from(axes.map(|axis| axis.dot(point))))
            .collect();
        let least = seen.iter().copied().reduce(Vec3::min).unwrap_or(Vec3::ZERO);
        let most = seen.iter().copied().reduce(Vec3::max).unwrap_or(Vec3::ZERO);
        let middle = 0.5 * (least + most);
        let tangent = FILLED * (0.5 * VIEW_ANGLE.to_radians()).tan();
        let needed = |point: &Vec3| {
            let off = (*point - middle).abs();
            off.x.max(off.y) / tangent + point.z - middle.z
        };
        let distance = seen.iter().map(needed).fold(0.1 * radius, f32::max);
        let in_world = |v: Vec3| v.x * axes[0] + v.y * axes[1] + v.z * axes[2];
        let focal_point = center + in_world(middle);
        Self {
            position: focal_point + distance * back,
            focal_point,
            up,
        }
    }

    /// The value of a key without its `rays.`.
    fn number(&self, key: &str) -> Option<f64> {
        let (name, index) = key.split_once('.')?;
        let vector = match name {
            "position" => self.position,
            "focal_point" => self.focal_point,
            "view_up" => self.up,
            _ => return None,
        };
        let number = *vector.as_ref().get(index.parse::<usize>().ok()?)?;
        Some(number.into())
    }
}
