//! Coordinates with more digits than 32 bits have: files far from the origin.

use std::path::Path;

use glam::{DVec3, Vec3};
use import::{
    PlaceArrays, RadiusChoice, Spheres, read_mesh_with_materials, read_places, read_spheres,
    read_tubes,
};

use super::lines::numbers;
use super::{mesh_of, reading};

/// The corners of two triangles a few steps around a point.
fn corners(far: [f64; 3]) -> [[f64; 3]; 4] {
    let steps = [[0.0, 0.0], [0.01, 0.0], [0.0, 0.02], [0.03, 0.01]];
    steps.map(|[x, y]| [far[0] + x, far[1] + y, far[2]])
}

const FAR: [f64; 3] = [300_000.123, 4_000_000.456, 12.5];
const NEAR: [f64; 3] = [0.01, -0.02, 0.0];

/// The corners, each after a word, with blanks or commas.
fn rows(corners: &[[f64; 3]], word: &str, between: &str) -> String {
    let row = |xyz: &[f64; 3]| format!("{word}{}\n", xyz.map(|x| x.to_string()).join(between));
    corners.iter().map(row).collect()
}

fn stl([a, b, c, d]: [[f64; 3]; 4]) -> String {
    let facet = |corners: [[f64; 3]; 3]| {
        let vertices = rows(&corners, "vertex ", " ");
        format!("facet normal 0 0 1\nouter loop\n{vertices}endloop\nendfacet\n")
    };
    let facets = [[a, b, c], [b, d, c]].map(facet).concat();
    format!("solid a\n{facets}endsolid a\n")
}

fn ply(corners: [[f64; 3]; 4], format: &str) -> Vec<u8> {
    let head = format!(
        "ply\nformat {format} 1.0\nelement vertex 4\nproperty double x\nproperty double y\n\
         property double z\nelement face 2\nproperty list uchar uchar vertex_indices\nend_header\n"
    );
    let mut file = head.into_bytes();
    if format == "ascii" {
        file.extend(
            rows(&corners, "", " ")
                .bytes()
                .chain(*b"3 0 1 2\n3 1 3 2\n"),
        );
    } else {
        file.extend(corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        file.extend([3, 0, 1, 2, 3, 1, 3, 2]);
    }
    file
}

/// The origin and the points that each format of a file has.
fn read_back(corners: [[f64; 3]; 4]) -> Vec<(&'static str, DVec3, Vec<Vec3>)> {
    let obj = rows(&corners, "v ", " ") + "f 1 2 3\nf 2 4 3\n";
    let files = [
        ("a.obj", obj.into_bytes()),
        ("a.stl", stl(corners).into_bytes()),
        ("a.ply", ply(corners, "ascii")),
        ("b.ply", ply(corners, "binary_little_endian")),
    ];
    let mut found = Vec::from(files.map(|(name, file)| {
        let mesh = mesh_of(name, &file).unwrap();
        assert_eq!(mesh.triangles.len(), 2, "{name}");
        (name, mesh.origin, mesh.vertices)
    }));
    let table = format!("x,y,z\n{}", rows(&corners, "", ","));
    let radius = RadiusChoice::Same(0.001);
    let (spheres, tubes) = reading("a.csv", table.as_bytes(), |path: &Path| {
        let spheres = read_spheres(path, Some(&radius), None).unwrap();
        (spheres, read_tubes(path, Some(&radius), None).unwrap())
    });
    let Spheres {
        origin, spheres, ..
    } = spheres;
    let centers = spheres.iter().map(|sphere| sphere.center).collect();
    found.push(("spheres", origin, centers));
    let mut ends: Vec<Vec3> = Vec::new();
    for capsule in tubes.capsules().map(numbers) {
        let [from, to] = [0, 3].map(|first| Vec3::from_slice(&capsule[first..]));
        assert_eq!(*ends.last().unwrap_or(&from), from);
        ends.extend([from, to]);
        ends.dedup();
    }
    found.push(("tubes", tubes.origin, ends));
    found
}

#[test]
fn points_far_away_are_read_with_their_digits() {
    for (name, origin, points) in read_back(corners(FAR)) {
        assert_eq!(points.len(), 4, "{name}");
        for (found, expected) in points.iter().zip(corners(FAR)) {
            let found = origin + found.as_dvec3();
            let error = found.distance(expected.into());
            assert!(error < 1e-6, "{name}: {found}, expected {expected:?}");
        }
    }
    let table = format!("x,y,z\n{}", rows(&corners(FAR), "", ","));
    let arrays = PlaceArrays {
        scale: None,
        orient: None,
        color: None,
    };
    let read = |path: &Path| read_places(path, arrays).unwrap();
    let places = reading("a.csv", table.as_bytes(), read);
    let places: Vec<DVec3> = places.iter().map(|place| place.position).collect();
    assert_eq!(places, corners(FAR).map(DVec3::from));
}

#[test]
fn points_near_the_origin_are_those_of_32_bits() {
    for (name, origin, points) in read_back(corners(NEAR)) {
        assert_eq!(origin, DVec3::ZERO, "{name}");
        let expected = corners(NEAR).map(|corner| DVec3::from(corner).as_vec3());
        assert_eq!(points, expected, "{name}");
    }
}

/// The meshes of several materials are where their file is.
#[test]
fn parts_stay_far_away() {
    let far = corners(FAR);
    let obj = rows(&far, "v ", " ") + "mtllib a.mtl\nusemtl a\nf 1 2 3\nusemtl b\nf 2 4 3\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.mtl"), "newmtl a\nnewmtl b\n").unwrap();
    let path = folder.path().join("a.obj");
    std::fs::write(&path, obj).unwrap();
    let read = read_mesh_with_materials(&path, 1 << 20).unwrap();
    let (_, parts) = read.into_parts();
    assert_eq!(parts.len(), 2);
    for (part, first) in parts.iter().zip([far[0], far[1]]) {
        let found = part.mesh.origin + part.mesh.vertices[0].as_dvec3();
        assert!(found.distance(first.into()) < 1e-6, "{found}");
    }
}
