//! OBJ, PLY and glTF files are read as VTK reads them.

use std::process::Command;

use glam::Vec3;
use import::read_mesh;
use serde_json::Value;

use crate::common::{assert_success, in_repository};

#[test]
#[ignore = "needs VTK: tests/with-paraview"]
fn bounds_and_numbers_of_triangles_are_those_that_vtk_finds() {
    let python = std::env::var("RAYCOST_PYTHON").expect("run tests/with-paraview");
    let folder = tempfile::tempdir().unwrap();
    let sign = crate::gltf::sign();
    let written = [
        ("sign.glb", sign.glb()),
        ("sign.gltf", sign.gltf("sign.bin").into_bytes()),
        ("sign.bin", sign.binary),
        (
            "colors.ply",
            crate::own_colors::ply("uchar", ["255", "188"]).into_bytes(),
        ),
    ];
    for (name, bytes) in &written {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    let meshes = ["sign.glb", "sign.gltf", "colors.ply"].map(|name| folder.path().join(name));
    let kept = [
        "configs/meshes/lamp.glb",
        "configs/meshes/spot.obj",
        "tests/files/tile.obj",
    ];
    let files = [meshes, kept.map(in_repository)].concat();
    let script = in_repository("tests/vtk/meshes.py");
    let output = Command::new(python)
        .arg(script)
        .args(&files)
        .output()
        .unwrap();
    assert_success(&output);
    let lines = String::from_utf8(output.stdout).unwrap();
    let found: Vec<Value> = lines
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(found.len(), files.len());
    for (file, expected) in files.iter().zip(found) {
        let mesh = read_mesh(file).unwrap();
        assert_eq!(
            mesh.triangles.len() as u64,
            expected["n_triangles"],
            "{file:?}"
        );
        let vertices = || mesh.vertices.iter().copied();
        let ends = [vertices().reduce(Vec3::min), vertices().reduce(Vec3::max)].map(Option::unwrap);
        for axis in 0..3 {
            for (k, end) in ends.iter().enumerate() {
                let expected = expected["bounds"][2 * axis + k].as_f64().unwrap();
                let found = f64::from(end[axis]);
                assert!(
                    (found - expected).abs() < 1e-5,
                    "{file:?}: {found}, VTK {expected}"
                );
            }
        }
    }
}
