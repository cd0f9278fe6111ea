//! What the kernels are measured on, and from where it is seen.

use std::path::Path;

use glam::Vec3;
use raycost::geometry::{Ray, Shape, Sphere, Triangle};
use raycost::import::read_mesh;
use raycost::sampling::uniform;
use raycost::scene::{MaterialId, ObjectId, Primitive};

/// An eye that looks at a point, and a light.
pub struct View {
    eye: Vec3,
    target: Vec3,
    /// Where shadow rays go.
    pub light: Vec3,
}

/// A view of the cube from -1 to 1 on each axis.
pub const CUBE: View = View {
    eye: Vec3::new(1.5, 1.2, 3.0),
    target: Vec3::ZERO,
    light: Vec3::new(3.0, 4.0, 2.0),
};

impl View {
    /// The ray through pixel `i` of a square picture, row by row.
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

/// A point in the cube from -1 to 1, and one more number in [0, 1).
fn in_cube(key: [u64; 3]) -> (Vec3, f32) {
    let [x, y, z, w] = uniform(key);
    (2.0 * Vec3::new(x, y, z) - 1.0, w)
}

/// A million small spheres.
pub fn sphere_cloud() -> Vec<Primitive> {
    let sphere = |i| {
        let (center, w) = in_cube([1, i, 0]);
        let radius = 0.002 + 0.004 * w;
        primitive(Shape::Sphere(Sphere { center, radius }))
    };
    (0..1_000_000).map(sphere).collect()
}

/// Small triangles anywhere, of all directions.
pub fn triangle_soup() -> Vec<Primitive> {
    let triangle = |i| {
        let (center, _) = in_cube([2, i, 0]);
        let vertices = [1, 2, 3].map(|corner| center + 0.03 * in_cube([2, i, corner]).0);
        primitive(Shape::Triangle(Triangle { vertices }))
    };
    (0..200_000).map(triangle).collect()
}

/// The triangles of a mesh file and a view of them.
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
