//! No ray leaves a closed mesh between its triangles.

use crate::common::generators::primitives;
use crate::common::in_repository;
use crate::common::twins::{QUALITIES, kernels};
use glam::Vec3;
use raycost::accel::Accel;
use raycost::cost::NoProbe;
use raycost::geometry::{Ray, Shape, Triangle};
use raycost::import::read_mesh;
use raycost::sampling::uniform;
use rayon::prelude::*;

/// Rays that are traced together.
const N_TOGETHER: usize = 10_000;

#[test]
fn no_ray_leaves_a_sphere() {
    Mesh::sphere(Vec3::ZERO, 1.0).keeps(100_000);
}

/// Where corners are some units in the last place apart.
#[test]
fn no_ray_leaves_a_small_sphere_far_from_the_origin() {
    Mesh::sphere(Vec3::new(1000.0, -300.0, 70.0), 0.1).keeps(100_000);
}

#[test]
fn no_ray_leaves_spot() {
    Mesh::spot().keeps(100_000);
}

#[test]
#[ignore = "takes minutes"]
fn none_of_ten_million_rays_leaves_a_sphere() {
    Mesh::sphere(Vec3::ZERO, 1.0).keeps(10_000_000);
}

#[test]
#[ignore = "takes minutes"]
fn none_of_ten_million_rays_leaves_spot() {
    Mesh::spot().keeps(10_000_000);
}

/// A closed mesh around a point.
struct Mesh {
    triangles: Vec<[Vec3; 3]>,
    center: Vec3,
    /// Half the side of a cube around the centre, all inside of the mesh.
    inside: f32,
}

impl Mesh {
    /// 131,072 triangles: an octahedron whose edges were halved until they were
    /// short. The middle of an edge is the same point on both of its sides.
    fn sphere(center: Vec3, radius: f32) -> Self {
        let octant = |signs: u32| {
            let side = |axis: u32| if signs >> axis & 1 == 0 { 1.0 } else { -1.0 };
            [side(0) * Vec3::X, side(1) * Vec3::Y, side(2) * Vec3::Z]
        };
        let mut triangles: Vec<[Vec3; 3]> = (0..8).map(octant).collect();
        while triangles.len() < 80_000 {
            let quarters = triangles.iter().flat_map(|&[a, b, c]| {
                let [ab, bc, ca] = [a + b, b + c, c + a].map(Vec3::normalize);
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            });
            triangles = quarters.collect();
        }
        for corner in triangles.as_flattened_mut() {
            *corner = center + radius * *corner;
        }
        Self {
            triangles,
            center,
            inside: 0.5 * radius,
        }
    }

    /// A cow, whose belly is about the origin.
    fn spot() -> Self {
        let mesh = read_mesh(&in_repository("configs/meshes/spot.obj")).unwrap();
        let corners = |&indices| mesh.triangle(indices).vertices;
        Self {
            triangles: mesh.triangles.iter().map(corners).collect(),
            center: Vec3::ZERO,
            inside: 0.15,
        }
    }

    /// Every kernel finds a hit of each of so many rays, in hierarchies of each
    /// quality, one by one and in streams.
    fn keeps(&self, n_rays: usize) {
        let shapes = self.triangles.iter().map(|&vertices| Triangle { vertices });
        let primitives = primitives(shapes.map(Shape::Triangle));
        let of_quality = |quality| kernels(&primitives, quality);
        let kernels: Vec<Accel> = QUALITIES.into_iter().flat_map(of_quality).collect();
        (0..n_rays / N_TOGETHER).into_par_iter().for_each(|part| {
            let numbers = part * N_TOGETHER..(part + 1) * N_TOGETHER;
            for n_alike in [1, 16] {
                let ray = |i| self.ray(i as u64, n_alike);
                let rays: Vec<Ray> = numbers.clone().map(ray).collect();
                kernels.iter().for_each(|accel| all_hit(accel, &rays));
            }
        });
    }

    /// A ray from inside: in any direction, or at a corner or an edge, but for
    /// some units in the last place. So many that follow each other start from
    /// one point, and meet one triangle.
    fn ray(&self, i: u64, n_alike: u64) -> Ray {
        let [x, y, z, which] = uniform([1, i / n_alike, 0]);
        let origin = self.center + self.inside * (2.0 * Vec3::new(x, y, z) - 1.0);
        let [share, x, y, z] = uniform([1, i, 1]);
        let [a, b, _] = self.triangles[(which * self.triangles.len() as f32) as usize];
        let target = match i % 3 {
            0 if n_alike == 1 => origin + Vec3::new(x, y, z) - 0.5,
            1 => a,
            _ => a + share * (b - a),
        };
        let beside = [(target.x, x), (target.y, y), (target.z, z)].map(|(at, random)| {
            let up = [at.next_down(), at, at.next_up()];
            up[(3.0 * random) as usize]
        });
        Ray {
            origin,
            direction: (Vec3::from(beside) - origin).normalize(),
        }
    }
}

fn all_hit(accel: &Accel, rays: &[Ray]) {
    for ray in rays {
        assert!(accel.nearest(ray, &mut NoProbe).is_some(), "{ray:?}");
    }
    let mut hits = Vec::new();
    accel.nearest_stream(rays, &mut hits, &mut NoProbe);
    for (ray, hit) in rays.iter().zip(hits) {
        assert!(hit.is_some(), "{ray:?} in a stream");
    }
}
