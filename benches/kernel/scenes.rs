//! The scenes of the kernel benchmarks, and views of them.

use std::path::Path;

use glam::Vec3;
use import::read_mesh;
use math::sampling::uniform;
use world::geometry::{Ray, Shape, Sphere, Triangle};
use world::scene::{MaterialId, ObjectId, Primitive};

/// A camera that looks at a point, and a light.
pub struct View {
    eye: Vec3,
    target: Vec3,
    /// The target of shadow rays.
    pub light: Vec3,
}

/// A view of the cube from -1 to 1 on each axis.
pub const CUBE: View = View {
    eye: Vec3::new(1.5, 1.2, 3.0),
    target: Vec3::ZERO,
    light: Vec3::new(3.0, 4.0, 2.0),
};

/// A view along the nave of [`architecture`].
pub const NAVE: View = View {
    eye: Vec3::new(1.5, 1.7, 1.0),
    target: Vec3::new(14.0, 2.6, 20.0),
    light: Vec3::new(16.0, 5.5, 14.0),
};

impl View {
    /// Returns the ray through pixel `i` of a square image, counted row by row.
    pub fn ray(&self, i: usize, side: usize) -> Ray {
        let forward = (self.target - self.eye).normalize();
        let right = forward.cross(Vec3::Y).normalize();
        let down = forward.cross(right);
        // Half of a field of view of 40 degrees.
        let tan = 0.364;
        let at = |k: usize| tan * (2.0 * (k as f32 + 0.5) / side as f32 - 1.0);
        let direction = forward + at(i % side) * right + at(i / side) * down;
        Ray {
            origin: self.eye,
            direction: direction.normalize(),
        }
    }
}

fn primitive(shape: Shape) -> Primitive {
    Primitive::new(shape, None, ObjectId(0), MaterialId(0))
}

/// Returns a point in the cube from -1 to 1, and one more number in [0, 1).
fn in_cube(key: [u64; 3]) -> (Vec3, f32) {
    let [x, y, z, w] = uniform(key);
    (2.0 * Vec3::new(x, y, z) - 1.0, w)
}

/// Returns a million small spheres.
pub fn sphere_cloud() -> Vec<Primitive> {
    let sphere = |i| {
        let (center, w) = in_cube([1, i, 0]);
        let radius = 0.002 + 0.004 * w;
        primitive(Shape::Sphere(Sphere { center, radius }))
    };
    (0..1_000_000).map(sphere).collect()
}

/// Returns small triangles at random positions, in all directions.
pub fn triangle_soup() -> Vec<Primitive> {
    let triangle = |i| {
        let (center, _) = in_cube([2, i, 0]);
        let vertices = [1, 2, 3].map(|corner| center + 0.03 * in_cube([2, i, corner]).0);
        primitive(Shape::Triangle(Triangle { vertices }))
    };
    (0..200_000).map(triangle).collect()
}

/// Returns a hall of columns, 48 m long, 30 m wide and 6 m high: planks and shafts whose triangles
/// are a hundred times longer than wide, ribs across all axes, bases and capitals of small
/// triangles, two large walls.
pub fn architecture() -> Vec<Primitive> {
    let [n_x, n_z] = [10_u16, 16];
    let foot = |x: u16, z: u16| 3.0 * Vec3::new(f32::from(x) + 0.5, 0.0, f32::from(z) + 0.5);
    let mut triangles = Vec::new();
    for x in 0..200_u16 {
        let x = 0.15 * f32::from(x);
        let [near, far] = [0.0, 48.0].map(|z| Vec3::new(x, 0.0, z));
        let plank = [near, near + 0.148 * Vec3::X, far + 0.148 * Vec3::X, far];
        triangles.extend(quad(plank));
        triangles.extend(quad(plank.map(|corner| corner + 6.0 * Vec3::Y)));
    }
    for x in [0.0, 30.0] {
        let [near, far] = [0.0, 48.0].map(|z| Vec3::new(x, 0.0, z));
        triangles.extend(quad([near, far, far + 6.0 * Vec3::Y, near + 6.0 * Vec3::Y]));
    }
    for (x, z) in (0..n_x).flat_map(|x| (0..n_z).map(move |z| (x, z))) {
        let foot = foot(x, z);
        column(foot, &mut triangles);
        let top = foot + 4.4 * Vec3::Y;
        for (dx, dz) in [(3.0, 0.0), (0.0, 3.0), (3.0, 3.0), (-3.0, 3.0)] {
            let keystone = top + Vec3::new(0.5 * dx, 1.5, 0.5 * dz);
            let end = top + Vec3::new(dx, 0.0, dz);
            tube([(top, 0.09), (keystone, 0.06)], 12, &mut triangles);
            tube([(keystone, 0.06), (end, 0.09)], 12, &mut triangles);
        }
    }
    let shape = |vertices| primitive(Shape::Triangle(Triangle { vertices }));
    triangles.into_iter().map(shape).collect()
}

/// Adds a shaft of 4 m between a base and a capital of many rings.
fn column(foot: Vec3, triangles: &mut Vec<[Vec3; 3]>) {
    let ring = |i: u16, from: f32| {
        let x = f32::from(i) / 8.0;
        let radius = 0.25 + 0.08 * (9.0 * x).sin().abs() * (1.0 - x);
        (foot + (from + 0.2 * x) * Vec3::Y, radius)
    };
    for from in [0.0, 4.2] {
        for i in 0..8 {
            tube([ring(i, from), ring(i + 1, from)], 40, triangles);
        }
    }
    tube([ring(8, 0.0), ring(0, 4.2)], 40, triangles);
}

/// Adds the lateral surface of a cone between two circles, each given by its center and radius.
fn tube(circles: [(Vec3, f32); 2], n_sides: u16, triangles: &mut Vec<[Vec3; 3]>) {
    let axis = (circles[1].0 - circles[0].0).normalize();
    let (u, v) = axis.any_orthonormal_pair();
    let point = |(center, radius): (Vec3, f32), side: u16| {
        let angle = std::f32::consts::TAU * f32::from(side) / f32::from(n_sides);
        center + radius * (angle.cos() * u + angle.sin() * v)
    };
    for side in 0..n_sides {
        let [a, b] = [side, side + 1].map(|side| point(circles[0], side));
        let [c, d] = [side + 1, side].map(|side| point(circles[1], side));
        triangles.extend(quad([a, b, c, d]));
    }
}

fn quad([a, b, c, d]: [Vec3; 4]) -> [[Vec3; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

/// Reads the triangles of a mesh file and chooses a view of them.
pub fn mesh(path: &Path) -> (Vec<Primitive>, View) {
    let mesh = read_mesh(path).unwrap_or_else(|fault| panic!("{fault}"));
    let triangles = mesh.triangles.iter().map(|&indices| mesh.triangle(indices));
    let primitives = triangles.map(Shape::Triangle).map(primitive).collect();
    let points = mesh.vertices;
    let min = points.iter().copied().fold(Vec3::INFINITY, Vec3::min);
    let max = points.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
    let (target, size) = (0.5 * (min + max), (max - min).length());
    let view = View {
        eye: target + size * Vec3::new(0.4, 0.4, 1.1),
        target,
        light: target + size * Vec3::new(1.0, 2.0, 1.0),
    };
    (primitives, view)
}
