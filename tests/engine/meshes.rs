//! Meshes and tables in a scene: their normals, colors and numbers of primitives.

use std::fmt::Write;
use std::path::Path;

use crate::common::parse;
use glam::Vec3;
use scene::build::Geometries;
use tracer::accel::Accel;
use tracer::cost::{NoProbe, RayKind};
use tracer::trace::{SurfacePoint, Tracer};
use world::geometry::{Ray, RenderSpace};
use world::scene::Scene;

/// Rows and columns of the sphere's quads.
const N: usize = 24;

/// A unit sphere of quads as OBJ, with or without normals. Quads at the poles have
/// two equal corners.
fn sphere(has_normals: bool) -> String {
    let mut text = String::new();
    let angle = |i: usize| i as f32 / N as f32 * std::f32::consts::PI;
    for i in 0..=N {
        for j in 0..N {
            let ((y_sin, y_cos), (z, x)) = (angle(i).sin_cos(), angle(2 * j).sin_cos());
            let (x, y, z) = (y_sin * x, y_cos, y_sin * z);
            writeln!(text, "v {x} {y} {z}").unwrap();
            if has_normals {
                writeln!(text, "vn {x} {y} {z}").unwrap();
            }
        }
    }
    let corner = |(i, j): (usize, usize)| {
        let column = if i % N == 0 { 0 } else { j % N };
        let c = i * N + column + 1;
        if has_normals {
            format!(" {c}//{c}")
        } else {
            format!(" {c}")
        }
    };
    for i in 0..N {
        for j in 0..N {
            let corners = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)];
            writeln!(text, "f{}", corners.map(corner).concat()).unwrap();
        }
    }
    text
}

/// A scene of one object, whose file is in `folder`.
fn scene(folder: &Path, object: &str) -> Scene {
    let mut config = parse(&format!(
        "image: {{ width: 4, height: 3 }}\n\
         camera: {{ look_at: {{ eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 40 }} }}\n\
         materials: {{ red: {{ color: [1, 0, 0] }} }}\n\
         lights: []\n\
         objects:\n  - {object}\n    material: red\n"
    ));
    let geometries = Geometries::read(&mut config, folder, u64::MAX).unwrap();
    // Rays are given in world space.
    scene::build::scene_in_space(&config, geometries, RenderSpace::default()).unwrap()
}

/// The surface points that rays from all directions toward the center hit.
fn surface_points(scene: &Scene) -> Vec<(Ray, SurfacePoint)> {
    let accel = Accel::new(scene, Default::default());
    let tracer = Tracer::new(scene, &accel);
    let ray = |i: u64| {
        let [x, y, z, w] = math::sampling::uniform([7, i, 0]);
        let origin = 9.0 * (Vec3::new(x, y, z) - 0.5).normalize();
        let target = 0.3 * w * Vec3::new(y, z, x);
        Ray {
            origin,
            direction: (target - origin).normalize(),
        }
    };
    let trace = |ray: Ray| Some((ray, tracer.trace(&ray, RayKind::Camera, &mut NoProbe)?));
    (0..2000).map(ray).filter_map(trace).collect()
}

/// The largest angle between the normals and those of `expected`, in degrees.
fn largest_error(points: &[(Ray, SurfacePoint)], expected: impl Fn(Vec3) -> Vec3) -> f32 {
    assert!(points.len() > 1900);
    let error = |(ray, point): &(Ray, SurfacePoint)| {
        assert!(point.geometric_normal.dot(ray.direction) <= 0.0);
        assert!(point.normal.dot(point.geometric_normal) >= 0.0);
        assert!((point.normal.length() - 1.0).abs() < 1e-5);
        point
            .normal
            .angle_between(expected(point.position))
            .to_degrees()
    };
    points.iter().map(error).fold(0.0, f32::max)
}

#[test]
fn smooth_normals_of_a_sphere_point_away_from_its_center() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("plain.obj"), sphere(false)).unwrap();
    std::fs::write(folder.path().join("round.obj"), sphere(true)).unwrap();
    let error = |mesh: &str| {
        let points = surface_points(&scene(folder.path(), mesh));
        largest_error(&points, Vec3::normalize)
    };
    assert!(error("mesh: { file: round.obj }") < 1.0);
    assert!(error("mesh: { file: plain.obj, normals: smooth }") < 2.0);
    assert!(error("mesh: { file: round.obj, normals: flat }") > 4.0);
    assert!(error("mesh: { file: plain.obj }") > 4.0);
}

#[test]
fn normals_are_perpendicular_to_a_mirrored_and_scaled_sphere() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("round.obj"), sphere(true)).unwrap();
    let object = "mesh: { file: round.obj }\n    transform: [{ scale: [1.5, -1, 0.8] }]";
    let points = surface_points(&scene(folder.path(), object));
    // The gradient of the ellipsoid's equation.
    let squares = Vec3::new(1.5, 1.0, 0.8) * Vec3::new(1.5, 1.0, 0.8);
    assert!(largest_error(&points, |point| (point / squares).normalize()) < 2.0);
}

#[test]
fn triangles_without_area_are_left_out_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("round.obj"), sphere(true)).unwrap();
    let scene = scene(folder.path(), "mesh: { file: round.obj }");
    // One half of each quad at the poles.
    assert_eq!(scene.n_degenerate, 2 * N as u64);
    assert_eq!(scene.primitives.len(), 2 * N * N - 2 * N);
}

#[test]
fn a_mirrored_ray_never_points_into_the_surface() {
    let point = SurfacePoint {
        position: Vec3::ZERO,
        normal: Vec3::new(0.6, 0.8, 0.0),
        geometric_normal: Vec3::Y,
        ..surface_points(&scene(
            Path::new(""),
            "sphere: { center: [0, 0, 0], radius: 1 }",
        ))[0]
            .1
    };
    let steep = Vec3::new(0.0, -1.0, 0.0);
    assert_eq!(
        point.mirrored(steep),
        steep.reflect(point.normal).normalize()
    );
    let grazing = Vec3::new(-0.99, -0.01, 0.0).normalize();
    assert!(grazing.reflect(point.normal).y > 0.0);
    let through = Vec3::new(0.9, -0.1, 0.0).normalize();
    assert!(through.reflect(point.normal).y < 0.0);
    assert_eq!(
        point.mirrored(through),
        through.reflect(Vec3::Y).normalize()
    );
    assert!(!point.is_faced_by(Vec3::new(1.0, -0.1, 0.0)));
}

#[test]
fn a_table_defines_the_colors_of_its_spheres() {
    let folder = tempfile::tempdir().unwrap();
    let table = "x,y,z,color\n0,0,0,#336699\n9,9,9,#ffffff\n";
    std::fs::write(folder.path().join("two.csv"), table).unwrap();
    let scene = scene(folder.path(), "spheres: { file: two.csv, radius: 1.5 }");
    for (_, point) in surface_points(&scene) {
        assert_eq!(point.color, Vec3::new(0.2, 0.4, 0.6));
        assert_eq!(point.material.0, 0);
    }
}
