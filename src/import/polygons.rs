//! Triangulates polygons.
//!
//! Readers add polygons as fans. Once all vertices are known, ears replace the fans of concave
//! polygons: Meisters, "Polygons Have Ears" (The American Mathematical Monthly 82(6), 1975). A hole
//! belongs to a polygon that reaches it along an edge and returns along the same edge (a keyhole).
//! All corners remain corners of triangles, so that no gap opens beside a neighbor that shares them,
//! and `n` corners always make `n - 2` triangles.

use std::collections::VecDeque;
use std::f64::consts::PI;
use std::ops::Range;

use glam::{DVec2, DVec3, Vec3};

/// The polygons of a mesh with more than three corners.
#[derive(Debug, Default)]
pub(super) struct Polygons(Vec<Range<usize>>);

impl Polygons {
    /// Adds the polygon whose fan these triangles are.
    pub(super) fn add(&mut self, fan: Range<usize>) {
        if fan.len() > 1 {
            self.0.push(fan);
        }
    }

    /// Replaces the fans of concave polygons: in the triangles, three indices of vertices each, and
    /// in arrays with indices of attributes at the same corners, which may end earlier.
    pub(super) fn triangulate(
        &self,
        vertices: &[Vec3],
        triangles: &mut [[u32; 3]],
        attributes: &mut [&mut Vec<[u32; 3]>],
    ) {
        let mut corners = Vec::new();
        for fan in &self.0 {
            let ears = &mut triangles[fan.clone()];
            read_corners(ears, &mut corners);
            let polygon = FlatPolygon::new(vertices, &corners);
            if polygon.is_convex() {
                continue;
            }
            EarCutter::new(&polygon).cut(ears);
            for of_all in attributes.iter_mut() {
                if let Some(values) = of_all.get_mut(fan.clone()) {
                    let mut at_corners = Vec::new();
                    read_corners(values, &mut at_corners);
                    for (value, ear) in values.iter_mut().zip(&*ears) {
                        *value = ear.map(|corner| at_corners[corner as usize]);
                    }
                }
            }
            for ear in ears {
                *ear = ear.map(|corner| corners[corner as usize]);
            }
        }
    }
}

/// Reads the corners of a fan.
fn read_corners(fan: &[[u32; 3]], corners: &mut Vec<u32>) {
    corners.clear();
    corners.extend(&fan[0][..2]);
    corners.extend(fan.iter().map(|[.., last]| *last));
}

/// A polygon as seen along its normal, counterclockwise.
struct FlatPolygon<'a> {
    vertices: &'a [Vec3],
    /// Indices of vertices.
    corners: &'a [u32],
    axes: [DVec3; 2],
    /// The distance that is lost in the rounding of vertices.
    tolerance: f64,
}

/// The rounding errors of a polygon's vertices beside their coordinates: four units in the last
/// place of 24 bits.
const ROUNDING: f64 = 1.0 / (1 << 22) as f64;

impl<'a> FlatPolygon<'a> {
    fn new(vertices: &'a [Vec3], corners: &'a [u32]) -> Self {
        let at = |corner: &u32| vertices[*corner as usize].as_dvec3();
        // Newell's normal: the sum over a fan.
        let first = at(&corners[0]);
        let area = |pair: &[u32]| (at(&pair[0]) - first).cross(at(&pair[1]) - first);
        let normal: DVec3 = corners.windows(2).map(area).sum();
        let normal = normal.normalize_or(DVec3::Z);
        let right = normal.any_orthonormal_vector();
        let size = |corner: &u32| at(corner).abs().max_element();
        Self {
            vertices,
            corners,
            axes: [right, normal.cross(right)],
            tolerance: ROUNDING * corners.iter().map(size).fold(0.0, f64::max),
        }
    }

    /// Returns the place of a corner in the plane.
    fn at(&self, corner: u32) -> DVec2 {
        let vertex = self.vertices[self.corners[corner as usize] as usize].as_dvec3();
        let [x, y] = self.axes.map(|axis| axis.dot(vertex));
        DVec2::new(x, y)
    }

    /// Returns true if it is convex, but for rounding errors, and winds once.
    fn is_convex(&self) -> bool {
        let n = self.corners.len() as u32;
        let mut turn = 0.0;
        for i in 0..n {
            let corners = [i, (i + 1) % n, (i + 2) % n].map(|corner| self.at(corner));
            let is_reflex = height(corners) < -self.tolerance;
            if is_reflex || height(corners).is_nan() {
                return false;
            }
            let [a, b, c] = corners;
            turn += libm::atan2((b - a).perp_dot(c - b), (b - a).dot(c - b));
        }
        turn < 3.0 * PI
    }
}

/// Returns the distance of the second of three successive corners from the line between the others:
/// positive if it is convex, 0 if the others are one point.
fn height([before, corner, after]: [DVec2; 3]) -> f64 {
    let line = after - before;
    let area = (corner - before).perp_dot(after - before);
    if line == DVec2::ZERO {
        0.0
    } else {
        area / line.length()
    }
}

/// Cuts off ears until a triangle is left.
struct EarCutter<'a> {
    polygon: &'a FlatPolygon<'a>,
    /// The neighbors of each corner that is left.
    neighbors: Vec<[u32; 2]>,
    /// The corners that may be ears. Others become ears only after a neighbor is cut off.
    queue: VecDeque<u32>,
    states: Vec<CornerState>,
    /// The corners that were reflex or flat, some of which are cut off: any other part of the polygon
    /// in an ear has one of them.
    reflex: CornerTree,
    /// The least height of an ear.
    tolerance: f64,
    /// A corner that is left.
    first: u32,
}

/// The state of a corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum CornerState {
    /// It is not in the queue.
    Waiting,
    Queued,
    /// It is in the queue, and goes to its end once, so that ears of one corner do not follow each
    /// other: they would be narrow.
    Postponed,
    Cut,
}

impl<'a> EarCutter<'a> {
    fn new(polygon: &'a FlatPolygon<'a>) -> Self {
        let n = polygon.corners.len() as u32;
        let mut cutter = Self {
            polygon,
            neighbors: (0..n).map(|i| [(i + n - 1) % n, (i + 1) % n]).collect(),
            queue: (0..n).collect(),
            states: vec![CornerState::Queued; n as usize],
            reflex: CornerTree::default(),
            tolerance: polygon.tolerance,
            first: 0,
        };
        let is_convex = |corner: &u32| height(cutter.around(*corner)) > polygon.tolerance;
        let reflex = (0..n).filter(|corner| !is_convex(corner)).collect();
        cutter.reflex = CornerTree::new(reflex, polygon);
        cutter
    }

    /// Replaces all triangles by ears, whose indices are those of corners of the polygon.
    fn cut(mut self, triangles: &mut [[u32; 3]]) {
        let mut n_before = triangles.len();
        for n_left in (0..triangles.len()).rev() {
            let corner = self.next_ear();
            let [before, after] = self.neighbors[corner as usize];
            triangles[n_left] = [before, corner, after];
            self.remove(corner);
            if n_left < n_before / 2 {
                n_before = n_left;
                let mut reflex = std::mem::take(&mut self.reflex).corners;
                reflex.retain(|corner| !self.is_cut(*corner));
                self.reflex = CornerTree::new(reflex, self.polygon);
            }
        }
    }

    /// Returns the next corner to cut off.
    fn next_ear(&mut self) -> u32 {
        loop {
            while let Some(corner) = self.queue.pop_front() {
                let state = &mut self.states[corner as usize];
                match *state {
                    CornerState::Cut => {}
                    CornerState::Postponed => {
                        *state = CornerState::Queued;
                        self.queue.push_back(corner);
                    }
                    CornerState::Waiting | CornerState::Queued => {
                        *state = CornerState::Waiting;
                        if self.is_ear(corner) {
                            return corner;
                        }
                    }
                }
            }
            if self.tolerance == 0.0 {
                // The polygon intersects itself.
                let is_convex = |corner: &u32| height(self.around(*corner)) >= 0.0;
                return self.left().find(is_convex).unwrap_or(self.first);
            }
            // What is left may be as thin as rounding errors.
            self.tolerance = 0.0;
            self.queue = self.left().collect();
        }
    }

    /// Returns the corners that are left.
    fn left(&self) -> impl Iterator<Item = u32> {
        let next = |corner: &u32| {
            let [_, next] = self.neighbors[*corner as usize];
            (next != self.first).then_some(next)
        };
        std::iter::successors(Some(self.first), next)
    }

    fn is_cut(&self, corner: u32) -> bool {
        self.states[corner as usize] == CornerState::Cut
    }

    /// Returns true if no other part of the polygon is in the triangle of a corner and its
    /// neighbors.
    fn is_ear(&self, corner: u32) -> bool {
        let corners = self.around(corner);
        let [before, _, after] = corners;
        let ear = Ear::new(corners, self.tolerance);
        let is_within = |reflex| !self.is_cut(reflex) && ear.contains(self.polygon.at(reflex));
        // The ends of bridges have both neighbors at one point.
        before == after || height(corners) > self.tolerance && !self.reflex.any(&ear, &is_within)
    }

    fn remove(&mut self, corner: u32) {
        let [before, after] = self.neighbors[corner as usize];
        self.neighbors[before as usize][1] = after;
        self.neighbors[after as usize][0] = before;
        self.states[corner as usize] = CornerState::Cut;
        self.first = after;
        for neighbor in [before, after] {
            let state = &mut self.states[neighbor as usize];
            match *state {
                CornerState::Waiting => {
                    *state = CornerState::Queued;
                    self.queue.push_back(neighbor);
                }
                _ => *state = CornerState::Postponed,
            }
        }
    }

    /// Returns the places of a corner between those of its neighbors.
    fn around(&self, corner: u32) -> [DVec2; 3] {
        let [before, after] = self.neighbors[corner as usize];
        [before, corner, after].map(|corner| self.polygon.at(corner))
    }
}

/// A triangle that may be an ear, counterclockwise.
struct Ear {
    corners: [DVec2; 3],
    tolerance: f64,
    /// The least and the greatest coordinates of what the tolerance makes of the triangle.
    bounds: [DVec2; 2],
}

impl Ear {
    fn new(corners: [DVec2; 3], tolerance: f64) -> Self {
        let [a, b, c] = corners;
        // Edges that all move outward by one distance scale a triangle about its incenter.
        let lengths = [b.distance(c), c.distance(a), a.distance(b)];
        let perimeter: f64 = lengths.iter().sum();
        let center = (lengths[0] * a + lengths[1] * b + lengths[2] * c) / perimeter;
        let radius = (b - a).perp_dot(c - a) / perimeter;
        let scale = 1.0 + 2.0 * tolerance / radius;
        let [a, b, c] = corners.map(|corner| center + scale * (corner - center));
        Self {
            corners,
            tolerance,
            bounds: [a.min(b).min(c), a.max(b).max(c)],
        }
    }

    /// Returns true if a point is in the triangle or on its edges, but for rounding errors, and not at
    /// one of its corners.
    fn contains(&self, point: DVec2) -> bool {
        self.may_contain([point; 2]) && !self.corners.contains(&point)
    }

    /// Returns false if a box, given by its least and its greatest corner, is outside of an edge or of
    /// the bounds.
    fn may_contain(&self, [min, max]: [DVec2; 2]) -> bool {
        let is_near = self.bounds[0].cmple(max) & min.cmple(self.bounds[1]);
        is_near.all()
            && (0..3).all(|i| {
                let [a, b] = [self.corners[i], self.corners[(i + 1) % 3]];
                let inward = (b - a).perp();
                let farthest = DVec2::select(inward.cmpgt(DVec2::ZERO), max, min);
                (farthest - a).dot(inward) >= -self.tolerance * inward.length()
            })
    }
}

/// Corners in a tree of boxes.
#[derive(Default)]
struct CornerTree {
    corners: Vec<u32>,
    /// The least and the greatest coordinates of each node's corners: of the root at 1, and of the
    /// halves of node `n` at `2 * n` and `2 * n + 1`.
    boxes: Vec<[DVec2; 2]>,
}

/// Maximum number of corners of a leaf.
const MAX_LEAF: usize = 16;

impl CornerTree {
    fn new(mut corners: Vec<u32>, polygon: &FlatPolygon) -> Self {
        let mut boxes = Vec::new();
        Self::add_node(1, &mut corners, &mut boxes, polygon);
        Self { corners, boxes }
    }

    fn add_node(
        node: usize,
        corners: &mut [u32],
        boxes: &mut Vec<[DVec2; 2]>,
        polygon: &FlatPolygon,
    ) {
        let empty = [DVec2::INFINITY, DVec2::NEG_INFINITY];
        let places = corners.iter().map(|corner| polygon.at(*corner));
        let [min, max] = places.fold(empty, |[min, max], at| [min.min(at), max.max(at)]);
        boxes.resize(boxes.len().max(node + 1), empty);
        boxes[node] = [min, max];
        if corners.len() > MAX_LEAF {
            let axis = usize::from(max.x - min.x < max.y - min.y);
            let along = |corner: &u32| polygon.at(*corner)[axis];
            let half = corners.len() / 2;
            corners.select_nth_unstable_by(half, |a, b| along(a).total_cmp(&along(b)));
            let (low, high) = corners.split_at_mut(half);
            Self::add_node(2 * node, low, boxes, polygon);
            Self::add_node(2 * node + 1, high, boxes, polygon);
        }
    }

    /// Returns true if a corner is within an ear.
    fn any(&self, ear: &Ear, is_within: &impl Fn(u32) -> bool) -> bool {
        self.any_in(1, &self.corners, ear, is_within)
    }

    fn any_in(
        &self,
        node: usize,
        corners: &[u32],
        ear: &Ear,
        is_within: &impl Fn(u32) -> bool,
    ) -> bool {
        if !ear.may_contain(self.boxes[node]) {
            return false;
        }
        if corners.len() <= MAX_LEAF {
            return corners.iter().any(|corner| is_within(*corner));
        }
        let (low, high) = corners.split_at(corners.len() / 2);
        self.any_in(2 * node, low, ear, is_within)
            || self.any_in(2 * node + 1, high, ear, is_within)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use glam::DQuat;
    use proptest::prelude::*;

    use super::super::mesh::fan;
    use super::*;

    /// The triangles of one polygon.
    fn triangulated(vertices: &[Vec3]) -> Vec<[u32; 3]> {
        let corners: Vec<u32> = (0..vertices.len() as u32).collect();
        let mut triangles: Vec<_> = fan(&corners).collect();
        let mut polygons = Polygons::default();
        polygons.add(0..triangles.len());
        polygons.triangulate(vertices, &mut triangles, &mut []);
        triangles
    }

    /// Makes sure that triangles cover a polygon once: their areas as vectors always sum to the
    /// polygon's, the shoelace formula, and their sizes only if none is turned over.
    fn check(vertices: &[Vec3]) -> Result<Vec<[u32; 3]>, TestCaseError> {
        let triangles = triangulated(vertices);
        prop_assert_eq!(triangles.len(), vertices.len() - 2);
        let at = |i: usize| vertices[i % vertices.len()].as_dvec3();
        let shoelace: DVec3 = (0..vertices.len()).map(|i| at(i).cross(at(i + 1))).sum();
        let sizes = triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.map(|corner| at(corner as usize));
            (b - a).cross(c - a).length()
        });
        let (size, expected) = (sizes.sum::<f64>(), shoelace.length());
        prop_assert!(
            (size - expected).abs() < 1e-4 * expected,
            "{size} {expected}"
        );
        Ok(triangles)
    }

    /// Moves a polygon to a plane.
    fn placed(polygon: &[[f64; 2]], [axis, shift]: [[f64; 3]; 2], angle: f64) -> Vec<Vec3> {
        let turn = DQuat::from_axis_angle(DVec3::from(axis).normalize_or(DVec3::X), angle);
        let place = |[x, y]: &[f64; 2]| turn * DVec3::new(*x, *y, 0.0) + DVec3::from(shift);
        polygon.iter().map(|point| place(point).as_vec3()).collect()
    }

    /// The corners around a center at these distances, counterclockwise from the right.
    fn star(radii: &[f64]) -> Vec<[f64; 2]> {
        let angle = |i| TAU * i as f64 / radii.len() as f64;
        let numbered = radii.iter().enumerate();
        numbered
            .map(|(i, radius)| [radius * angle(i).cos(), radius * angle(i).sin()])
            .collect()
    }

    /// Removes the crossings of a polygon: turns the way between two edges that cross around.
    fn untangled(mut polygon: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
        let n = polygon.len();
        let left = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
            let [a, b, c] = [a, b, c].map(DVec2::from);
            (b - a).perp_dot(c - a) > 0.0
        };
        let crossing = |p: &[[f64; 2]]| {
            let pairs = (0..n).flat_map(|i| (i + 2..n).map(move |j| [i, j]));
            pairs.into_iter().find(|[i, j]| {
                let [a, b, c, d] = [p[*i], p[i + 1], p[*j], p[(j + 1) % n]];
                (j + 1) % n != *i
                    && left(a, b, c) != left(a, b, d)
                    && left(c, d, a) != left(c, d, b)
            })
        };
        while let Some([i, j]) = crossing(&polygon) {
            polygon[i + 1..=j].reverse();
        }
        polygon
    }

    fn plane() -> impl Strategy<Value = ([[f64; 3]; 2], f64)> {
        let vector = |size: f64| prop::array::uniform3(-size..size);
        ((vector(1.0), vector(5.0)), 0.0..TAU).prop_map(|((a, b), angle)| ([a, b], angle))
    }

    proptest! {
        #[test]
        fn triangles_cover_a_polygon_once(
            points in prop::collection::vec(prop::array::uniform2(-1.0..1.0), 3..40),
            (plane, angle) in plane(),
        ) {
            check(&placed(&untangled(points), plane, angle))?;
        }

        #[test]
        fn triangles_leave_out_the_hole_of_a_keyhole(
            outer in prop::collection::vec(1.1..3.0, 3..30),
            hole in prop::collection::vec(0.2..0.5, 3..30),
            (plane, angle) in plane(),
        ) {
            let outer = star(&outer);
            let mut hole = star(&hole);
            // Chords of few corners come near the center.
            hole.iter_mut().flatten().for_each(|number| *number *= 0.9);
            hole[1..].reverse();
            let way = [&outer[..], &outer[..1], &hole[..], &hole[..1]].concat();
            check(&placed(&way, plane, angle))?;
        }

        /// Corners on straight edges stay corners of triangles with an area.
        #[test]
        fn triangles_on_a_lattice_have_areas(heights in prop::collection::vec(1_u32..5, 2..12)) {
            // Rectangles are convex.
            prop_assume!(heights.iter().any(|height| *height != heights[0]));
            let mut polygon: Vec<[f64; 2]> = (0..=heights.len()).map(|x| [x as f64, 0.0]).collect();
            let mut last = 0;
            for (x, height) in heights.into_iter().enumerate().rev() {
                let turns: Vec<u32> = if last < height {
                    (last + 1..=height).collect()
                } else {
                    (height..last).rev().chain([height]).collect()
                };
                polygon.extend(turns.iter().map(|y| [x as f64 + 1.0, f64::from(*y)]));
                polygon.push([x as f64, f64::from(height)]);
                last = height;
            }
            polygon.extend((1..last).rev().map(|y| [0.0, f64::from(y)]));
            polygon.dedup();
            let vertices = placed(&polygon, [[1.0, 0.0, 0.0], [0.0; 3]], 0.0);
            for triangle in check(&vertices)? {
                let [a, b, c] = triangle.map(|corner| vertices[corner as usize]);
                prop_assert!((b - a).cross(c - a).length() > 0.5, "{polygon:?} {triangle:?}");
            }
        }
    }

    #[test]
    fn convex_polygons_stay_fans_and_tangled_ones_end() {
        let corners: Vec<u32> = (0..9).collect();
        let far_away = |polygon: &[[f64; 2]]| placed(polygon, [[1.0, 2.0, 3.0], [9.0; 3]], 1.0);
        let fan: Vec<_> = fan(&corners).collect();
        assert_eq!(triangulated(&far_away(&star(&[2.0; 9]))), fan);
        // A star that winds twice, one that crosses itself, and points on a line.
        let around = star(&[1.0; 9]);
        let twice: Vec<[f64; 2]> = (0..9).map(|i| around[2 * i % 9]).collect();
        assert_eq!(triangulated(&far_away(&twice)).len(), 7);
        let crossing: Vec<[f64; 2]> = (0..9).map(|i| around[i * i % 9]).collect();
        assert_eq!(triangulated(&far_away(&crossing)).len(), 7);
        let line: Vec<[f64; 2]> = (0..9).map(|i| [f64::from(i), 0.0]).collect();
        assert_eq!(triangulated(&far_away(&line)).len(), 7);
        assert_eq!(triangulated(&[Vec3::NAN; 9]).len(), 7);
    }

    #[test]
    fn attributes_follow_their_corners() {
        let dart = [[0.0, 0.0], [2.0, 1.0], [0.5, 1.0], [1.0, 2.0]];
        let vertices = placed(&dart, [[1.0; 3], [0.0; 3]], 0.0);
        let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
        let mut uvs = vec![[10, 11, 12], [10, 12, 13]];
        let mut normals = Vec::new();
        let mut polygons = Polygons::default();
        polygons.add(0..2);
        polygons.triangulate(&vertices, &mut triangles, &mut [&mut uvs, &mut normals]);
        for (triangle, uvs) in triangles.iter().zip(&uvs) {
            assert_eq!(triangle.map(|corner| corner + 10), *uvs);
        }
        assert!(
            triangles
                .iter()
                .all(|triangle| triangle.contains(&2) && triangle.contains(&0))
        );
    }
}
