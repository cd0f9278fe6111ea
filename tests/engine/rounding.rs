//! Rounding changes no decision: rays aimed at edges and vertices, at any scale.

use crate::common::generators::{cases, direction, primitives};
use crate::common::twins::compare;
use glam::{Quat, Vec3};
use proptest::prelude::*;
use world::geometry::{Ray, Shape, Shear, Triangle};

/// A number up to 1 in magnitude, often a round one.
fn fraction() -> impl Strategy<Value = f32> {
    prop_oneof![4 => -1.0_f32..1.0, 1 => prop::sample::select(vec![-1.0, -0.5, 0.0, 0.25, 1.0])]
}

fn vector() -> impl Strategy<Value = Vec3> {
    [fraction(), fraction(), fraction()].prop_map(Vec3::from)
}

/// A point up to two units in the last place away on each axis.
fn beside(point: Vec3, steps: [i32; 3]) -> Vec3 {
    let step = |x: f32, n: i32| match n {
        ..0 => (n..0).fold(x, |x, _| x.next_down()),
        _ => (0..n).fold(x, |x, _| x.next_up()),
    };
    let [x, y, z] = point.to_array();
    Vec3::new(step(x, steps[0]), step(y, steps[1]), step(z, steps[2]))
}

fn steps() -> impl Strategy<Value = [i32; 3]> {
    [-2..3, -2..3, -2..3]
}

/// A power of ten: coordinates up to that are in range.
fn scale() -> impl Strategy<Value = f32> {
    prop_oneof![2 => Just(1.0_f32), 1 => (-20_i32..17).prop_map(|exponent| 10_f32.powi(exponent))]
}

/// The triangles of an octahedron with twice bisected edges, turned and stretched:
/// round, flat as a disk or thin as a needle. It is closed.
fn mesh() -> impl Strategy<Value = Vec<[Vec3; 3]>> {
    let stretch = prop::sample::select(vec![1.0_f32, 1e-2, 1e-4, 1e2, 1e4]);
    (direction(), 0.0_f32..6.0, stretch).prop_map(|(axis, angle, stretch)| {
        let side = |octant: u32, axis: u32| 1.0 - 2.0 * (octant >> axis & 1) as f32;
        let octant = |i| {
            [
                side(i, 0) * Vec3::X,
                side(i, 1) * Vec3::Y,
                side(i, 2) * Vec3::Z,
            ]
        };
        let mut triangles: Vec<[Vec3; 3]> = (0..8).map(octant).collect();
        for _ in 0..2 {
            let quarters = triangles.iter().flat_map(|&[a, b, c]| {
                let [ab, bc, ca] = [a + b, b + c, c + a].map(Vec3::normalize);
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            });
            triangles = quarters.collect();
        }
        let shape = Vec3::new(1.0, 1.0, stretch) / stretch.max(1.0);
        let turn = Quat::from_axis_angle(axis, angle);
        let place = |vertex: Vec3| turn * (shape * vertex);
        triangles
            .iter()
            .map(|triangle| triangle.map(place))
            .collect()
    })
}

/// Triangles of all sizes and directions.
fn soup() -> impl Strategy<Value = Vec<[Vec3; 3]>> {
    let size = prop::sample::select(vec![1e-6_f32, 1e-3, 0.1, 1.0]);
    let triangle = (vector(), vector(), vector(), size)
        .prop_map(|(a, b, c, size)| [a, a + size * b, a + size * c]);
    prop::collection::vec(triangle, 1..150)
}

/// A target on the edge of a triangle: which triangle, where on the edge, and how far
/// beside it.
fn target() -> impl Strategy<Value = (prop::sample::Index, f32, [i32; 3])> {
    let share = prop_oneof![1 => Just(0.0_f32), 2 => 0.0_f32..1.0];
    (any::<prop::sample::Index>(), share, steps())
}

/// Triangles within `scale` of the origin, and rays at their edges and vertices, from
/// inside, from outside and from far away; coherent ones start in one point.
fn aimed(
    triangles: impl Strategy<Value = Vec<[Vec3; 3]>>,
) -> impl Strategy<Value = (Vec<[Vec3; 3]>, Vec<Ray>)> {
    let origin = (
        vector(),
        prop::sample::select(vec![0.1_f32, 1.0, 3.0, 1000.0]),
    );
    let shot = (
        origin,
        prop::collection::vec(target(), 1..20),
        any::<bool>(),
    );
    let shots = prop::collection::vec(shot, 1..8);
    (triangles, shots, scale()).prop_map(|(triangles, shots, scale)| {
        let scaled = |triangle: &[Vec3; 3]| triangle.map(|vertex| scale * vertex);
        let triangles: Vec<_> = triangles.iter().map(scaled).collect();
        let mut rays = Vec::new();
        for ((origin, distance), targets, is_coherent) in shots {
            let origin = scale * distance * origin;
            for (which, share, steps) in &targets {
                let which = if is_coherent { &targets[0].0 } else { which };
                let [a, b, _] = *which.get(&triangles);
                let target = beside(a + *share * (b - a), *steps);
                // Scaled, so that no square underflows or overflows.
                let direction = ((target - origin) / scale).try_normalize();
                rays.extend(direction.map(|direction| Ray { origin, direction }));
            }
        }
        (triangles, rays)
    })
}

fn triangles(triangles: Vec<[Vec3; 3]>) -> Vec<world::scene::Primitive> {
    let shapes = triangles.into_iter().map(|vertices| Triangle { vertices });
    primitives(shapes.map(Shape::Triangle))
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn rays_at_edges_and_vertices_of_closed_meshes((mesh, rays) in aimed(mesh())) {
        compare(&triangles(mesh), &rays)?;
    }

    #[test]
    fn rays_at_edges_and_vertices_of_a_soup((soup, rays) in aimed(soup())) {
        compare(&triangles(soup), &rays)?;
    }
}

/// The vertices of a triangle in the space of a shear: the ray passes through it, or
/// near an edge.
fn sheared() -> impl Strategy<Value = [Vec3; 3]> {
    let size = || prop::sample::select(vec![1e-4_f32, 1e-2, 1.0, 1.0, 1.0]);
    let depth = prop::sample::select(vec![0.0_f32, 1.0, 1000.0]);
    let shift = prop_oneof![1 => Just(0.0_f32), 1 => 0.0_f32..1.0];
    let shape = (
        [vector(), vector(), vector()],
        [size(), size()],
        depth,
        shift,
    );
    (shape, [steps(), steps(), steps()], scale()).prop_map(
        |((vertices, [x, y], depth, shift), steps, scale)| {
            let [a, b, _] = vertices;
            let on_edge = shift * (a + 0.5 * (b - a));
            let place = |i: usize| {
                let vertex = (vertices[i] - on_edge) * Vec3::new(x, y, 1.0) + depth * Vec3::Z;
                beside(scale * vertex, steps[i])
            };
            [place(0), place(1), place(2)]
        },
    )
}

proptest! {
    #![proptest_config(cases(1000))]

    /// With the bound that the margin of boxes rests on.
    #[test]
    fn areas_in_32_bits_decide_as_in_64(vertices in sheared()) {
        let shear = Shear::along(Vec3::new(0.3, -0.2, 1.0));
        let [found, exact] = [shear.intersect(vertices), shear.intersect_exactly(vertices)];
        prop_assert_eq!(found.is_some(), exact.is_some());
        if let (Some(found), Some(exact)) = (found, exact) {
            let depths = vertices.map(|vertex| vertex.z);
            let least = depths.iter().copied().fold(f32::INFINITY, f32::min);
            let greatest = depths.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            let deepest = least.abs().max(greatest.abs());
            let bound = 2_f32.powi(-24) * (18.0 * (greatest - least) + 8.0 * deepest);
            prop_assert!((found - exact).abs() <= bound.next_up(), "{found} {exact} {vertices:?}");
        }
    }

    /// The triangles of a point and the edges of another triangle cover it.
    #[test]
    fn a_fan_has_no_gap([a, b, c] in sheared(), center in vector(), steps in steps()) {
        let shear = Shear::along(Vec3::Z);
        if shear.intersect_exactly([a, b, c]).is_none() {
            return Ok(());
        }
        let center = beside(center * Vec3::new(1e-7, 1e-7, 1.0) * a.abs().max_element(), steps);
        let fan = [[a, b, center], [b, c, center], [c, a, center]];
        prop_assert!(fan.iter().any(|&triangle| shear.intersect(triangle).is_some()));
    }
}
