//! Path tracing of meshes whose shading normals are not those of their triangles.

use std::fmt::Write;

use glam::Vec3;

use crate::common::{mean, radiance};

/// A sphere of 128 triangles as OBJ, with the normals of the sphere.
fn ball() -> String {
    let mut text = String::new();
    for signs in 0..8 {
        let sign = |bit: u32| if signs >> bit & 1 == 0 { 1.0 } else { -1.0 };
        let mut corners = [Vec3::X * sign(0), Vec3::Y * sign(1), Vec3::Z * sign(2)];
        if (corners[0].cross(corners[1])).dot(corners[2]) < 0.0 {
            corners.swap(0, 1);
        }
        add(&mut text, corners, 2);
    }
    text
}

/// Adds a triangle, divided a number of times into four.
fn add(text: &mut String, corners: [Vec3; 3], n_divisions: u32) {
    let [a, b, c] = corners;
    if n_divisions == 0 {
        for Vec3 { x, y, z } in corners {
            writeln!(text, "v {x} {y} {z}\nvn {x} {y} {z}").unwrap();
        }
        return text.push_str("f -3//-3 -2//-2 -1//-1\n");
    }
    let [ab, bc, ca] = [a + b, b + c, c + a].map(Vec3::normalize);
    for part in [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]] {
        add(text, part, n_divisions - 1);
    }
}

#[test]
fn a_coarse_smooth_mesh_that_absorbs_nothing_is_invisible_in_a_white_furnace() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("ball.obj");
    std::fs::write(&file, ball()).unwrap();
    for (material, tolerance) in [
        ("{ color: 1 }", 1e-4),
        (
            "{ color: 1, diffuse: 0.4, specular: 0.6, exponent: 10 }",
            2e-3,
        ),
        ("{ conductor: { index: 0, extinction: 1 } }", 1e-4),
        (
            "{ conductor: { index: 0, extinction: 1 }, roughness: 0.1 }",
            2e-3,
        ),
        (
            "{ conductor: { index: 0, extinction: 1 }, roughness: 0.4 }",
            2e-3,
        ),
        (
            "{ conductor: { index: 0, extinction: 1 }, roughness: 1 }",
            2e-3,
        ),
        ("{ dielectric: { index: 1.5 }, roughness: 0.3 }", 5e-3),
        ("{ color: 1, principled: { roughness: 0.5 } }", 2e-3),
        (
            "{ color: 1, principled: { metallic: 1, roughness: 0.3 } }",
            2e-3,
        ),
    ] {
        let radiance = radiance(&format!(
            "image: {{ width: 32, height: 32, samples_per_pixel: 256, sampler: sobol }}
camera: {{ look_at: {{ eye: [0.3, 0.5, 4], target: [0, 0, 0], fov_y_deg: 30 }} }}
shading: {{ model: path, max_depth: 100 }}
cost: counters
background: 1
materials: {{ white: {material} }}
lights: []
objects: [{{ mesh: {{ file: {file:?} }}, material: white }}]
"
        ));
        let found = mean(&radiance);
        assert!(
            (found - 1.0).abs().max_element() < tolerance,
            "{material}: {found}"
        );
        // In no part of the silhouette is light lost.
        let is_medium = material.contains("dielectric");
        for block in (0..64).filter(|_| !is_medium) {
            let (x, y) = (block % 8 * 4, block / 8 * 4);
            let pixels: Vec<Vec3> = (0..16)
                .map(|i| radiance[(y + i / 4) * 32 + x + i % 4])
                .collect();
            let found = mean(&pixels);
            assert!((found.x - 1.0).abs() < 0.02, "{material} {block}: {found}");
        }
    }
}
