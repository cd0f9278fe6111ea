//! The hierarchy finds the hits of brute force where rounding decides.

use crate::common::generators::{
    awkward_triangle, bundle, cases, direction, point, primitives, ray, ray_at, shape,
};
use crate::common::twins::compare;
use glam::Vec3;
use proptest::prelude::*;
use world::geometry::{Aabb, Cuboid, Plane, Ray, Rectangle, Shape, Triangle};

/// Triangles, and rays in their planes or through their edges and vertices.
fn aimed() -> impl Strategy<Value = (Vec<Triangle>, Vec<Ray>)> {
    prop::collection::vec(awkward_triangle(), 1..60).prop_flat_map(|triangles| {
        let any = prop::sample::select(triangles.clone());
        let rays = prop::collection::vec(any.prop_flat_map(ray_at), 0..40);
        (Just(triangles), rays)
    })
}

/// Rays within a cube of `n` unit boxes per side; most start in faces.
fn rays_in_grid(n: i32) -> impl Strategy<Value = Vec<Ray>> {
    let step = prop_oneof![3 => (0..=n).prop_map(|i| i as f32), 1 => 0.0..n as f32];
    let origin = prop::array::uniform3(step).prop_map(Vec3::from);
    let ray = (origin, direction()).prop_map(|(origin, direction)| Ray { origin, direction });
    prop::collection::vec(ray, 1..40)
}

proptest! {
    #![proptest_config(cases(1000))]

    #[test]
    fn rays_in_planes_and_through_edges_and_vertices_of_any_triangle((triangles, rays) in aimed()) {
        compare(&primitives(triangles.into_iter().map(Shape::Triangle)), &rays)?;
    }
}

/// Triangles, and rays from one point to points of the same triangle.
fn aimed_bundle() -> impl Strategy<Value = (Vec<Triangle>, Vec<Ray>)> {
    prop::collection::vec(awkward_triangle(), 1..60).prop_flat_map(|triangles| {
        let one = prop::sample::select(triangles.clone());
        let rays = one.prop_flat_map(|triangle| prop::collection::vec(ray_at(triangle), 16..40));
        let rays = rays.prop_map(|rays| {
            let origin = rays[0].origin;
            let from_origin = |ray: Ray| Ray { origin, ..ray };
            rays.into_iter().map(from_origin).collect()
        });
        (Just(triangles), rays)
    })
}

proptest! {
    #![proptest_config(cases(300))]

    #[test]
    fn coherent_rays_at_any_triangle((triangles, rays) in aimed_bundle()) {
        compare(&primitives(triangles.into_iter().map(Shape::Triangle)), &rays)?;
    }

    /// Spheres and triangles, some of them coincident.
    #[test]
    fn coherent_rays(
        shapes in prop::collection::vec(shape(), 1..40),
        n_copies in 1_usize..4,
        planes in prop::collection::vec((point(), direction()), 0..2),
        bundles in prop::collection::vec(bundle(), 1..4),
    ) {
        let plane = |(point, normal)| Shape::Plane(Plane { point, normal });
        let n = n_copies * shapes.len();
        let shapes = shapes.into_iter().cycle().take(n);
        compare(&primitives(planes.into_iter().map(plane).chain(shapes)), &bundles.concat())?;
    }

    /// Coordinates far from the origin have a coarse resolution.
    #[test]
    fn coherent_rays_far_from_the_origin(
        triangles in prop::collection::vec(awkward_triangle(), 1..40),
        rays in bundle(),
        to in prop::sample::select(vec![1e2_f32, 1e4, 1e6, 1e8]),
    ) {
        let to = Vec3::new(to, -0.3 * to, 0.0);
        let moved = |Triangle { vertices }| {
            Shape::Triangle(Triangle { vertices: vertices.map(|vertex| vertex + to) })
        };
        let rays: Vec<Ray> = rays.iter().map(|ray| Ray { origin: ray.origin + to, ..*ray }).collect();
        compare(&primitives(triangles.into_iter().map(moved)), &rays)?;
    }
}

proptest! {
    #![proptest_config(cases(200))]

    /// The primitive with the lower index wins, in whichever leaf it is.
    #[test]
    fn coincident_primitives(
        shapes in prop::collection::vec(shape(), 1..12),
        rays in prop::collection::vec(ray(), 20),
    ) {
        let n = 8 * shapes.len();
        compare(&primitives(shapes.into_iter().cycle().take(n)), &rays)?;
    }

    #[test]
    fn rays_in_and_between_boxes_that_touch(rays in rays_in_grid(3)) {
        let boxes = (0..27).map(|i| {
            let min = Vec3::new((i % 3) as f32, (i / 3 % 3) as f32, (i / 9) as f32);
            Shape::Cuboid(Cuboid::new(Aabb { min, max: min + 1.0 }))
        });
        compare(&primitives(boxes), &rays)?;
    }

    /// Rays from edges and corners, or a little beside them.
    #[test]
    fn rays_from_edges_of_rectangles(
        sides in prop::collection::vec((0..3_usize, prop::array::uniform3(0..3)), 1..30),
        starts in prop::collection::vec((prop::array::uniform3(0..5), 0..3_usize, direction()), 1..40),
        beside in prop::sample::select(vec![0.0_f32, 1e-30, -1e-18, 6e-8, -1e-7]),
    ) {
        let rectangle = |(axis, corner): (usize, [i32; 3])| {
            let corner = Vec3::from(corner.map(|i| i as f32));
            let [u, v] = [1, 2].map(|i| Vec3::AXES[(axis + i) % 3]);
            Shape::Rectangle(Rectangle::new(corner, u, v))
        };
        let ray = |(halves, axis, direction): ([i32; 3], usize, Vec3)| {
            let origin = Vec3::from(halves.map(|i| 0.5 * i as f32)) + beside * Vec3::AXES[axis];
            Ray { origin, direction }
        };
        let rays: Vec<Ray> = starts.into_iter().map(ray).collect();
        compare(&primitives(sides.into_iter().map(rectangle)), &rays)?;
    }

    /// Coordinates far from the origin have a coarse resolution.
    #[test]
    fn scenes_far_from_the_origin(
        triangles in prop::collection::vec(awkward_triangle(), 1..40),
        rays in prop::collection::vec(ray(), 20),
        to in prop::sample::select(vec![1e2_f32, 1e4, 1e6, 1e8]),
    ) {
        let to = Vec3::new(to, -0.3 * to, 0.0);
        let moved = |Triangle { vertices }| {
            Shape::Triangle(Triangle { vertices: vertices.map(|vertex| vertex + to) })
        };
        let near: Vec<Ray> = rays.iter().map(|ray| Ray { origin: ray.origin + to, ..*ray }).collect();
        let far = near.iter().map(|ray| Ray { origin: ray.at(-1e3), ..*ray });
        let rays: Vec<Ray> = near.iter().copied().chain(far).collect();
        compare(&primitives(triangles.into_iter().map(moved)), &rays)?;
    }

    /// Planes stay outside the hierarchy, which is empty here.
    #[test]
    fn planes_alone(
        planes in prop::collection::vec((point(), direction()), 0..4),
        rays in prop::collection::vec(ray(), 0..40),
    ) {
        let plane = |(point, normal)| Shape::Plane(Plane { point, normal });
        compare(&primitives(planes.into_iter().map(plane)), &rays)?;
    }
}

proptest! {
    #![proptest_config(cases(40))]

    #[test]
    fn streams_of_any_length(
        shapes in prop::collection::vec(shape(), 0..60),
        planes in prop::collection::vec((point(), direction()), 0..2),
        some in prop::collection::vec(ray(), 64),
    ) {
        let plane = |(point, normal)| Shape::Plane(Plane { point, normal });
        let primitives = primitives(planes.into_iter().map(plane).chain(shapes));
        for n_rays in [0, 1, 15, 16, 17, 64] {
            compare(&primitives, &some[..n_rays])?;
        }
        let many: Vec<Ray> = some.into_iter().cycle().take(1000).collect();
        compare(&primitives, &many)?;
    }
}
