//! Meshes with colors of their own.

use std::path::Path;

use glam::Vec3;
use raycost::accel::Accel;
use raycost::cost::{NoProbe, RayKind};
use raycost::geometry::Ray;
use raycost::scene::{Geometries, Scene};
use raycost::trace::Tracer;

use crate::common::parse;

/// The scene of some objects, whose files are in `folder`.
fn scene(folder: &Path, rest: &str) -> Scene {
    let config = parse(&format!(
        "image: {{ width: 4, height: 3 }}\n\
         camera: {{ look_at: {{ eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 40 }} }}\n\
         lights: []\n{rest}"
    ));
    let geometries = Geometries::read(&config, folder, u64::MAX).unwrap();
    Scene::new(&config, geometries).unwrap()
}

/// The color of the surface that a ray along -z meets.
fn color_at(scene: &Scene, [x, y]: [f32; 2]) -> Vec3 {
    let accel = Accel::new(&scene.primitives, Default::default());
    let ray = Ray {
        origin: Vec3::new(x, y, 9.0),
        direction: -Vec3::Z,
    };
    let point = Tracer::new(scene, &accel).trace(&ray, RayKind::Camera, &mut NoProbe);
    point.unwrap().color
}

/// A triangle with colors of this type at its vertices: red, black and half of the light of
/// blue, as displays take it.
fn ply(kind: &str, [full, half]: [&str; 2]) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
         property float z\nproperty {kind} red\nproperty {kind} green\nproperty {kind} blue\n\
         property {kind} alpha\nelement face 1\nproperty list uchar int vertex_indices\n\
         end_header\n0 0 0 {full} 0 0 {full}\n1 0 0 0 0 0 {full}\n0 1 0 0 0 {half} {full}\n3 0 1 2\n"
    )
}

#[test]
fn colors_of_vertices_are_interpolated_as_light() {
    let folder = tempfile::tempdir().unwrap();
    let obj = "v 0 0 0 1 0 0\nv 1 0 0 0 0 0\nv 0 1 0 0 0 0.735357\nf 1 2 3\n".to_owned();
    for (name, text) in [
        ("bytes.ply", ply("uchar", ["255", "188"])),
        ("words.ply", ply("ushort", ["65535", "48192"])),
        ("floats.ply", ply("float", ["1", "0.735357"])),
        ("mesh.obj", obj),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
        let scene = scene(
            folder.path(),
            &format!(
                "materials: {{ own: {{ color: vertex_colors }} }}\n\
                 objects: [{{ mesh: {{ file: {name} }}, material: own }}]\n"
            ),
        );
        for [x, y] in [[0.1, 0.1], [0.2, 0.5], [0.7, 0.2]] {
            let found = color_at(&scene, [x, y]);
            let expected = Vec3::new(1.0 - x - y, 0.0, 0.5 * y);
            assert!(
                (found - expected).abs().max_element() < 0.002,
                "{name}: {found} {expected}"
            );
        }
    }
}

#[test]
fn colors_out_of_range_are_refused_in_ply_and_none_in_obj() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        raycost::import::read_mesh(&path)
    };
    let fault = read("a.ply", &ply("float", ["255", "0"]))
        .unwrap_err()
        .to_string();
    assert!(
        fault.ends_with("line 14: a color is 255, expected numbers from 0 to 1"),
        "{fault}"
    );
    let some = "v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0 1 1 1\nf 1 2 3\n";
    for text in [some, &some.replace("v 1 0 0", "v 1 0 0 255 0 0")] {
        assert_eq!(read("a.obj", text).unwrap().colors, None);
    }
}
