//! Closed meshes are watertight: no ray escapes between their triangles.

use crate::common::generators::primitives;
use crate::common::in_repository;
use crate::common::twins::{QUALITIES, kernels};
use glam::Vec3;
use import::read_mesh;
use math::sampling::uniform;
use rayon::prelude::*;
use tracer::accel::Accel;
use tracer::cost::NoProbe;
use world::geometry::{Ray, Shape, Triangle};

/// Rays per stream.
const N_IN_STREAM: usize = 10_000;

#[test]
fn no_ray_escapes_from_a_sphere() {
    Mesh::sphere(Vec3::ZERO, 1.0).assert_watertight(100_000);
}

/// Here vertices are a few units in the last place apart, and many boxes overlap: each ray is slow.
#[test]
fn no_ray_escapes_from_a_small_sphere_far_from_the_origin() {
    Mesh::sphere(Vec3::new(1000.0, -300.0, 70.0), 0.1).assert_watertight(40_000);
}

#[test]
fn no_ray_escapes_from_spot() {
    Mesh::spot().assert_watertight(100_000);
}

#[test]
#[ignore = "takes minutes"]
fn none_of_ten_million_rays_escapes_from_a_sphere() {
    Mesh::sphere(Vec3::ZERO, 1.0).assert_watertight(10_000_000);
}

#[test]
#[ignore = "takes minutes"]
fn none_of_ten_million_rays_escapes_from_spot() {
    Mesh::spot().assert_watertight(10_000_000);
}

/// A closed mesh around a point.
struct Mesh {
    triangles: Vec<[Vec3; 3]>,
    center: Vec3,
    /// Half of the side of a cube around the center that lies inside the mesh.
    inside: f32,
}

impl Mesh {
    /// 131,072 triangles: an octahedron with repeatedly bisected edges. The middle
    /// of an edge is the same point for both of its triangles.
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

    /// A cow whose belly surrounds the origin.
    fn spot() -> Self {
        let mesh = read_mesh(&in_repository("configs/meshes/spot.obj")).unwrap();
        let corners = |&indices| mesh.triangle(indices).vertices;
        Self {
            triangles: mesh.triangles.iter().map(corners).collect(),
            center: Vec3::ZERO,
            inside: 0.15,
        }
    }

    /// Every kernel finds a hit of each of `n_rays` rays from inside, in hierarchies
    /// of each quality, for single rays and for streams.
    fn assert_watertight(&self, n_rays: usize) {
        let shapes = self.triangles.iter().map(|&vertices| Triangle { vertices });
        let primitives = primitives(shapes.map(Shape::Triangle));
        let of_quality = |quality| kernels(&primitives, quality);
        let kernels: Vec<Accel> = QUALITIES.into_iter().flat_map(of_quality).collect();
        (0..n_rays / N_IN_STREAM).into_par_iter().for_each(|part| {
            let numbers = part * N_IN_STREAM..(part + 1) * N_IN_STREAM;
            for n_coherent in [1, 16] {
                let ray = |i| self.ray(i as u64, n_coherent);
                let rays: Vec<Ray> = numbers.clone().map(ray).collect();
                kernels.iter().for_each(|accel| all_hit(accel, &rays));
            }
        });
    }

    /// A ray from inside: in any direction, or within a unit in the last place of a
    /// vertex or an edge. Each `n_coherent` consecutive rays start in one point
    /// and point to one triangle.
    fn ray(&self, i: u64, n_coherent: u64) -> Ray {
        let [x, y, z, which] = uniform([1, i / n_coherent, 0]);
        let origin = self.center + self.inside * (2.0 * Vec3::new(x, y, z) - 1.0);
        let [share, x, y, z] = uniform([1, i, 1]);
        let [a, b, _] = self.triangles[(which * self.triangles.len() as f32) as usize];
        let target = match i % 3 {
            0 if n_coherent == 1 => origin + Vec3::new(x, y, z) - 0.5,
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
    let stream = rays.iter().copied().collect();
    accel.nearest_stream(&stream, &mut hits, &mut NoProbe);
    for (ray, hit) in rays.iter().zip(hits) {
        assert!(hit.is_some(), "{ray:?} in a stream");
    }
}
