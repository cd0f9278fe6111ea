//! Clipping triangles at axis-aligned planes.

use glam::Vec3;

use super::bounds::LaneBounds;
use world::geometry::Triangle;

/// Returns the boxes around the parts of a triangle below and above `position` on an axis, both
/// including the plane; [`LaneBounds::EMPTY`] for an empty part.
///
/// Rounding may enlarge the boxes but never shrinks them: the points where edges cross the plane
/// are computed with 53 bits and rounded outward.
pub(super) fn split(triangle: &Triangle, axis: usize, position: f32) -> [LaneBounds; 2] {
    let [mut below, mut above] = [LaneBounds::EMPTY; 2];
    let [a, b, c] = triangle.vertices;
    for (from, to) in [(a, b), (b, c), (c, a)] {
        // Assign the vertex to its side, or to both.
        let vertex = LaneBounds::new(from.into(), from.into());
        if from[axis] <= position {
            below = below.union(vertex);
        }
        if from[axis] >= position {
            above = above.union(vertex);
        }
        // If the edge crosses the plane, both sides end at the crossing.
        let [lower, upper] = [from[axis].min(to[axis]), from[axis].max(to[axis])];
        if lower < position && position < upper {
            let crossing = crossing(from, to, axis, position);
            below = below.union(crossing);
            above = above.union(crossing);
        }
    }
    [below, above]
}

/// Returns a box around the point where an edge crosses the plane.
fn crossing(from: Vec3, to: Vec3, axis: usize, position: f32) -> LaneBounds {
    let [a, b] = [from.as_dvec3(), to.as_dvec3()];
    let fraction = (f64::from(position) - a[axis]) / (b[axis] - a[axis]);
    let mut point = (a + fraction * (b - a)).as_vec3();
    // Of 24 bits, and of 53.
    let mut rounding = f32::EPSILON * point.abs() + 1e-15 * (to - from).abs();
    (point[axis], rounding[axis]) = (position, 0.0);
    LaneBounds::new((point - rounding).into(), (point + rounding).into())
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;

    /// Returns points of the triangle, including vertices and points on edges.
    fn points(triangle: &Triangle) -> impl Iterator<Item = DVec3> {
        const N: u32 = 12;
        let [a, b, c] = triangle.vertices.map(|vertex| vertex.as_dvec3());
        let weight = |i: u32| f64::from(i) / f64::from(N);
        let row = move |i| (0..=N - i).map(move |j| (weight(i), weight(j)));
        (0..=N)
            .flat_map(row)
            .map(move |(u, v)| a + u * (b - a) + v * (c - a))
    }

    /// Returns true if the box contains the point, up to the rounding error of 53 bits of the
    /// triangle's coordinates.
    fn contains(triangle: &Triangle, bounds: &LaneBounds, point: DVec3) -> bool {
        let largest = triangle.vertices.map(|vertex| vertex.abs().max_element());
        let slack = DVec3::splat(1e-14 * f64::from(largest.into_iter().fold(0.0, f32::max)));
        let bounds = bounds.to_aabb();
        let [min, max] = [bounds.min, bounds.max].map(|corner| corner.as_dvec3());
        (min - slack).cmple(point).all() && point.cmple(max + slack).all()
    }

    fn coordinate() -> impl Strategy<Value = f32> {
        prop_oneof![-9.0_f32..9.0, -1e-3_f32..1e-3, Just(1.0), Just(1e4)]
    }

    proptest! {
        #[test]
        fn the_box_of_each_side_contains_its_points(
            vertices in prop::array::uniform3(prop::array::uniform3(coordinate())),
            axis in 0_usize..3,
            position in coordinate(),
        ) {
            let triangle = Triangle { vertices: vertices.map(Vec3::from) };
            let [below, above] = split(&triangle, axis, position);
            for point in points(&triangle) {
                let x = point[axis];
                prop_assert!(x > f64::from(position) || contains(&triangle, &below, point));
                prop_assert!(x < f64::from(position) || contains(&triangle, &above, point));
            }
        }

        #[test]
        fn no_box_extends_beyond_the_plane(
            vertices in prop::array::uniform3(prop::array::uniform3(coordinate())),
            axis in 0_usize..3,
            position in coordinate(),
        ) {
            let triangle = Triangle { vertices: vertices.map(Vec3::from) };
            let [below, above] = split(&triangle, axis, position);
            prop_assert!(below.max(axis) <= position);
            prop_assert!(above.min(axis) >= position);
        }
    }

    #[test]
    fn a_right_triangle_is_split_into_its_two_parts() {
        let triangle = Triangle {
            vertices: [Vec3::ZERO, 4.0 * Vec3::X, 4.0 * Vec3::Y],
        };
        let [below, above] = split(&triangle, 0, 1.0).map(LaneBounds::to_aabb);
        assert_eq!(
            (below.min, below.max),
            (Vec3::ZERO, Vec3::new(1.0, 4.0, 0.0))
        );
        assert_eq!(above.min, Vec3::new(1.0, 0.0, 0.0));
        assert!(above.max.abs_diff_eq(Vec3::new(4.0, 3.0, 0.0), 1e-6));
    }
}
