//! `rays.pvsm`: rays in the cloud of the scene, by kind and by cost.

use glam::{DVec3, Vec3};

use crate::paraview::{Axis, ColorScale, Panels, StateValue, ViewCamera, fill};
use crate::writers::distances::Distances;
use crate::writers::rays::{CLOUD, FILE, Rays};
use host::folder::OutputFolder;
use render::attribution::TracedRay;
use tracer::cost::{Metric, RayKind};

const RAYS: &str = include_str!("rays.pvsm");

/// Maximum length of rays that are shown, in radii of the scene: a plane has hits up to its
/// horizon, and ParaView clips points 1000 times nearer than the farthest one.
const LONGEST: f32 = 50.0;
/// Maximum distance from the center, in radii, of points that must be in view: on rays, and in the
/// scene.
const FRAMED: [f32; 2] = [1.1, 0.8];
/// Maximum number of rays drawn as wide lines; more would cover each other.
const FEW: usize = 300;
/// The sides to choose from, as parts of the scene's camera's directions to the right and upward.
const SIDES: [[f32; 2]; 4] = [[0.75, 0.4], [-0.75, 0.4], [0.75, 0.9], [-0.75, 0.9]];
/// The view's vertical angle in degrees.
const VIEW_ANGLE: f32 = 30.0;
/// Length of an arrow's head as a fraction of the view's height, for few and for many rays.
const HEADS: [f32; 2] = [0.03, 0.012];
/// The colors of the kinds of rays, by their numbers: a palette for color-blind readers (Okabe and
/// Ito, 2008).
const KIND_COLORS: [[f32; 3]; RayKind::ALL.len()] = [
    [0.0, 0.45, 0.70],
    [0.90, 0.62, 0.0],
    [0.84, 0.37, 0.0],
    [0.0, 0.62, 0.45],
    [0.34, 0.71, 0.91],
];

/// Returns the state for these rays.
pub(in crate::writers) fn ray_state(rays: &Rays, folder: &OutputFolder) -> String {
    let path_of = |file| folder.path_of(file).to_string_lossy().into_owned();
    let size = rays.plane().size.map(f64::from);
    let camera = ViewCamera::new(rays.plane(), None);
    // A plane's hits beyond the scene would make the rest small.
    let (center, radius) = rays.sphere_in_world();
    let beyond = camera.position().distance(center) + f64::from(radius);
    let max_distance = Distances::collect(rays.cloud()).max_shown.min(beyond);
    let view = SideView::new(rays, &camera, max_distance as f32);
    let cost = cost_axis(rays);
    let is_present = |kind: &RayKind| rays.iter().any(|ray| ray.kind == *kind);
    let kinds: Vec<RayKind> = RayKind::ALL.into_iter().filter(is_present).collect();
    let head = HEADS[usize::from(rays.n > FEW)] * view.height;
    let number = |key: &str| -> Option<f64> {
        match key {
            "hits.max_distance" => Some(max_distance),
            "rays.line_width" => Some(if rays.n <= FEW { 3.0 } else { 1.0 }),
            "rays.max_length" => Some((LONGEST * radius).into()),
            "rays.head" => Some(head.into()),
            _ => view.number(key.strip_prefix("rays.")?),
        }
    };
    fill(RAYS, |key| {
        let color = |kind: &RayKind| KIND_COLORS[*kind as usize].map(|channel| channel.to_string());
        let name = |kind: &RayKind| [(*kind as usize).to_string(), kind.name().to_owned()];
        match key {
            FILE => Some(path_of(FILE).into()),
            CLOUD => Some(path_of(CLOUD).into()),
            "rays.caption" => Some(format!("{}: the kind of each ray", rays.name()).into()),
            "panels2.outer" => view.panels.direction("outer").map(|n| n.to_string().into()),
            "rays.kinds" => Some(StateValue::Many(kinds.iter().flat_map(name).collect())),
            "rays.kind_colors" => Some(StateValue::Many(kinds.iter().flat_map(color).collect())),
            // The start of the arrow's head, which ends at the end of the ray.
            "rays.to_head" => Some(format!("direction*(0.5*length-{})", 0.5 * head).into()),
            _ => match key.strip_prefix("rays.cost.") {
                Some(key) => cost.value(key),
                None => match number(key) {
                    Some(number) => Some(number.to_string().into()),
                    None => camera.value(size, key),
                },
            },
        }
    })
}

/// Returns the metric that colors the right view: the first one that differs between rays, since a
/// small hierarchy is one node, and there may be no clock.
fn cost_axis(rays: &Rays) -> Axis {
    let high = |value: fn(&TracedRay) -> f32| color_maximum(rays.iter().map(value).collect());
    let axis =
        |array, name, high: f32| Axis::new(array, name, ColorScale::Linear, [0.0, high.into()]);
    if let Some(high) = high(|ray| ray.time_ns) {
        return axis(Metric::TIME.name, "Time of each ray", high).in_time_unit();
    }
    if let Some(high) = high(|ray| ray.node_visits as f32) {
        return axis(
            Metric::NODE_VISITS.name,
            "BVH nodes visited by each ray",
            high,
        );
    }
    let high = high(|ray| ray.primitive_tests as f32);
    axis(
        Metric::PRIMITIVE_TESTS.name,
        "Primitive tests of each ray",
        high.unwrap_or(1.0),
    )
}

/// Returns the upper end of the colors: the 99.5 % quantile, since greater values may
/// be interruptions by the system. `None` if all values are equal.
fn color_maximum(mut values: Vec<f32>) -> Option<f32> {
    values.sort_unstable_by(f32::total_cmp);
    let [low, .., high] = values[..] else {
        return None;
    };
    let rank = values.len() - 1 - values.len() / 200;
    (low < high).then(|| values[rank].max(1.0))
}

/// A camera that sees rays from the side, and the scene around them: seen from their origin they
/// would be points. In the world as ParaView shows it, mirrored for some scenes.
struct SideView {
    position: DVec3,
    focal_point: DVec3,
    up: Vec3,
    /// World units from the lower to the upper edge, in the middle.
    height: f32,
    panels: Panels,
}

impl SideView {
    /// Chooses the side on which rays and scene fill the view most.
    fn new(rays: &Rays, camera: &ViewCamera, max_distance: f32) -> Self {
        let (center, radius) = rays.sphere_in_world();
        let center = camera.mirrored(center);
        let space = rays.plane().space;
        let ends = rays.iter().flat_map(|ray| rays.line(ray));
        let ends = ends.map(|point| (space.world_point(point), FRAMED[0]));
        let hits = shown_points(rays, max_distance).map(|point| (point, FRAMED[1]));
        let seen: Vec<Vec3> = ends
            .chain(hits)
            .map(|(point, within)| ((camera.mirrored(point) - center).as_vec3(), within))
            .filter(|(point, within)| point.length() <= within * radius)
            .map(|(point, _)| point)
            .collect();
        let views = SIDES.map(|side| Self::from_side(side, camera, &seen, center, radius));
        let nearest = views
            .into_iter()
            .min_by(|a, b| a.height.total_cmp(&b.height));
        nearest.expect("`SIDES` is not empty")
    }

    /// Returns the view from a side of points that are relative to the center of a ball.
    fn from_side(
        [aside, above]: [f32; 2],
        camera: &ViewCamera,
        points: &[Vec3],
        center: DVec3,
        radius: f32,
    ) -> Self {
        let [right, up, forward] = camera.axes();
        let back = (aside * right + above * up - 0.6 * forward).normalize();
        let to_right = up.cross(back).normalize();
        let axes = [to_right, back.cross(to_right), back];
        // Project each point onto these axes, from the center of the ball.
        let on_axes = |point: &Vec3| Vec3::from(axes.map(|axis| axis.dot(*point)));
        let seen: Vec<Vec3> = points.iter().map(on_axes).collect();
        let least = seen.iter().copied().reduce(Vec3::min).unwrap_or(Vec3::ZERO);
        let most = seen.iter().copied().reduce(Vec3::max).unwrap_or(Vec3::ZERO);
        let middle = 0.5 * (least + most);
        let extent = (most - least).max(Vec3::splat(0.05 * radius));
        let panels = Panels::new(2, [extent.x, extent.y].map(f64::from));
        let tangent = (0.5 * VIEW_ANGLE.to_radians()).tan();
        let needed = |point: &Vec3| {
            let size = (*point - middle).abs() * 2.0;
            let half_height = panels.panel().half_height([size.x, size.y].map(f64::from));
            half_height as f32 / tangent + point.z - middle.z
        };
        let distance = seen.iter().map(needed).fold(0.1 * radius, f32::max);
        let in_world = |v: Vec3| v.x * axes[0] + v.y * axes[1] + v.z * axes[2];
        let focal_point = center + in_world(middle).as_dvec3();
        Self {
            position: focal_point + (distance * back).as_dvec3(),
            focal_point,
            up,
            height: 2.0 * distance * tangent,
            panels,
        }
    }

    /// Returns the value of a key without the prefix `rays.`.
    fn number(&self, key: &str) -> Option<f64> {
        let (name, index) = key.split_once('.')?;
        let vector = match name {
            "position" => self.position,
            "focal_point" => self.focal_point,
            "view_up" => self.up.as_dvec3(),
            _ => return None,
        };
        vector.as_ref().get(index.parse::<usize>().ok()?).copied()
    }
}

/// Returns the points of the cloud that are shown.
fn shown_points<'a>(rays: &Rays<'a>, max_distance: f32) -> impl Iterator<Item = DVec3> + use<'a> {
    let (plane, film) = (rays.plane(), rays.cloud());
    let [columns, rows] = plane.size.map(|n| n as f32);
    let scale = [
        columns / film.grid.width as f32,
        rows / film.grid.height as f32,
    ];
    let rows = film.rows(|strip| &strip.distance).zip(0_u16..);
    rows.flat_map(move |(row, y)| {
        let y = (f32::from(y) + 0.5) * scale[1] - 0.5;
        let hits = row
            .iter()
            .zip(0_u16..)
            .filter(move |(distance, _)| **distance <= max_distance);
        hits.map(move |(distance, x)| {
            let ray = plane.ray((f32::from(x) + 0.5) * scale[0] - 0.5, y);
            plane
                .space
                .world_point(ray.at(plane.space.length(*distance)))
        })
    })
}
