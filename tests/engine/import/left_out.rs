//! Files of which a line is of no consequence: their mesh is read, with a note on what is left out.

use glam::{Vec2, Vec3};
use import::{Mesh, RadiusChoice, read_points};

use super::write::{binary_stl, stl};
use super::{mesh_of, message, reading, tetrahedron};

/// Returns the sum of the areas of all triangles.
fn area(mesh: &Mesh) -> f32 {
    let triangles = mesh.triangles.iter().map(|&of| mesh.triangle(of).vertices);
    triangles
        .map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length())
        .sum()
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

const VERTICES: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

/// The text of a PLY file with further properties of vertices and faces.
fn ply(n: [usize; 2], of_vertex: &str, of_face: &str, rows: &str) -> String {
    let [n_vertices, n_faces] = n;
    format!(
        "ply\nformat ascii 1.0\nelement vertex {n_vertices}\nproperty float x\nproperty float y\n\
         property float z\n{of_vertex}element face {n_faces}\n\
         property list uchar int vertex_indices\n{of_face}end_header\n{rows}"
    )
}

#[test]
#[expect(clippy::too_many_lines, reason = "one table of cases")]
fn a_mesh_is_read_without_what_is_of_no_consequence() {
    let normals = "property float nx\nproperty float ny\nproperty float nz\n";
    let uvs = "property float s\nproperty float t\n";
    let face = format!("{TRIANGLE}f 1 2 3\n");
    for (name, text, expected_area, note) in [
        (
            "a.obj",
            format!("{TRIANGLE}f 1//1 2//1 3//1\n"),
            0.5,
            "normals that not all corners of a face have (1, line 4)",
        ),
        (
            "a.obj",
            format!("{TRIANGLE}vn 0 0 1\nf 1//1 2 3\n"),
            0.5,
            "normals that not all corners of a face have (1, line 5)",
        ),
        (
            "a.obj",
            format!("{TRIANGLE}vn 0 0 1 0\nf 1//1 2//1 3//1\n"),
            0.5,
            "ends of lines after the numbers (1, line 4)",
        ),
        (
            "a.obj",
            format!("{TRIANGLE}vn\nvn nan 0 -nan(ind)\nf 1//1 2//2 3//1\n"),
            0.5,
            "normals that are not three finite numbers (2, from line 4)",
        ),
        (
            "a.obj",
            format!("{TRIANGLE}vt 1.#QNAN 0\nf 1/1 2/1 3/1\n"),
            0.5,
            "texture coordinates that are not finite numbers (1, line 4)",
        ),
        (
            "a.obj",
            format!("{TRIANGLE}vt 0 0\nf 1/1 2/2 3/1\n"),
            0.5,
            "texture coordinates that not all corners of a face have (1, line 5)",
        ),
        (
            "a.obj",
            format!("{face}f 1 2\nf 3\nf\n"),
            0.5,
            "faces of fewer than three corners (3, from line 5)",
        ),
        ("a.obj", format!("{face}v 1 nan 2\n"), 0.5, ""),
        (
            "a.obj",
            format!("{face}v 1 2 1e39\nf 1 2 4\n"),
            0.5,
            "triangles with a corner that is not finite (1, triangle 1)",
        ),
        (
            "a.obj",
            format!("{face}vw 1 0 1\ncstype bezier\ncurv 0 1 1 2\n"),
            0.5,
            "statements other than polygons (3, from `vw` in line 5)",
        ),
        (
            "a.obj",
            format!("{face}v 1 2 3 four\nv 1 2 3 4 5 6 7 8\n"),
            0.5,
            "ends of lines after the numbers (2, from line 5)",
        ),
        (
            "a.ply",
            ply([4, 2], "", "", &format!("{VERTICES}4 0 1 2 3\n1 0\n")),
            1.0,
            "faces of fewer than three corners (1, line 15)",
        ),
        (
            "a.ply",
            ply([5, 1], "", "", &format!("{VERTICES}nan inf 0\n4 0 1 2 3\n")),
            1.0,
            "",
        ),
        (
            "a.ply",
            ply(
                [5, 2],
                "",
                "",
                &format!("{VERTICES}nan inf 0\n4 0 1 2 3\n3 4 1 2\n"),
            ),
            1.0,
            "triangles with a corner that is not finite (1, triangle 2)",
        ),
        (
            "a.ply",
            ply(
                [3, 1],
                normals,
                "",
                "0 0 0 0 0 nan\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n",
            ),
            0.5,
            "normals that are not finite (1, line 13)",
        ),
        (
            "a.ply",
            ply(
                [3, 1],
                uvs,
                "",
                "0 0 0 0 0\n1 0 0 inf 0\n0 1 0 0 1\n3 0 1 2\n",
            ),
            0.5,
            "texture coordinates that are not finite (1, line 13)",
        ),
        (
            "a.ply",
            ply([4, 1], "", "", &format!("{VERTICES}4 0 1 2 3\n\n 7 8 9\n")),
            1.0,
            "data after the last element (1, after line 14)",
        ),
    ] {
        let mesh = mesh_of(name, text.as_bytes()).unwrap();
        assert_eq!(area(&mesh), expected_area, "{text}");
        let notes: Vec<String> = match note {
            "" => Vec::new(),
            note => vec![format!("left out: {note}")],
        };
        assert_eq!(mesh.notes, notes, "{text}");
        let normals = mesh.normals.iter().flat_map(|normals| &normals.values);
        assert!(
            normals.into_iter().all(|normal| normal.is_finite()),
            "{text}"
        );
        let uvs = mesh.uvs.iter().flat_map(|uvs| &uvs.values);
        assert!(uvs.into_iter().all(|uv| uv.is_finite()), "{text}");
        assert!(
            mesh.vertices.iter().all(|vertex| vertex.is_finite()),
            "{text}"
        );
    }
}

#[test]
fn a_file_without_a_triangle_is_refused_with_what_is_left_out() {
    for (text, left_out) in [
        (
            "solid cube\n",
            "statements other than polygons (1, `solid` in line 1)",
        ),
        (
            "root:x:0:0:root:/root:/bin/bash\n",
            "statements other than polygons (1, `root:x:0:0:root:/root:/b…` in line 1)",
        ),
        (
            "v 0 0 0\nf 1 1\n",
            "faces of fewer than three corners (1, line 2)",
        ),
    ] {
        let expected = format!(": no triangle in the file; left out: {left_out}, expected faces");
        assert_eq!(message(mesh_of("a.obj", text.as_bytes())), expected);
    }
}

#[test]
fn stl_is_read_in_any_case_with_any_normal_and_a_mark() {
    let whole = String::from_utf8(stl(&tetrahedron())).unwrap();
    let plain = mesh_of("a.stl", whole.as_bytes()).unwrap();
    let normals = whole.replace("facet normal", "facet normal -nan(ind) 1.#QNAN");
    for text in [
        whole.to_uppercase(),
        format!("\u{feff}{whole}"),
        format!("\u{feff} {}", whole.to_uppercase().replace('\n', "\r")),
        normals,
    ] {
        assert_eq!(
            mesh_of("a.stl", text.as_bytes()).as_ref(),
            Ok(&plain),
            "{text}"
        );
    }
    // A triangle of NaN, and bytes behind the last one.
    let mut binary = binary_stl(&tetrahedron());
    assert_eq!(
        mesh_of("a.stl", &binary).as_ref().map(area),
        Ok(area(&plain))
    );
    binary[..5].copy_from_slice(b"solid");
    binary.extend(*b"more");
    let read = mesh_of("a.stl", &binary).unwrap();
    assert_eq!(area(&read), area(&plain));
    assert_eq!(
        read.notes,
        ["left out: bytes after the last triangle (1, byte 284)"]
    );
    binary[96..100].copy_from_slice(&f32::NAN.to_le_bytes());
    let read = mesh_of("a.stl", &binary[..284]).unwrap();
    assert_eq!(read.triangles.len(), 3);
    let expected = "left out: triangles with a corner that is not finite (1, triangle 0)";
    assert_eq!(read.notes, [expected]);
}

#[test]
fn lines_of_ply_end_as_on_any_system() {
    let text = ply([4, 1], "", "", &format!("{VERTICES}4 0 1 2 3\n"));
    let plain = mesh_of("a.ply", text.as_bytes()).unwrap();
    let binary: Vec<u8> = [
        0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0,
    ]
    .iter()
    .flat_map(|x| x.to_le_bytes())
    .chain(
        [4].into_iter()
            .chain([0_i32, 1, 2, 3].iter().flat_map(|i| i.to_le_bytes())),
    )
    .collect();
    let (header, _) = text.split_once(VERTICES).unwrap();
    for end in ["\n", "\r\n", "\r"] {
        for mark in ["", "\u{feff}"] {
            let text = format!("{mark}{}", text.replace('\n', end));
            assert_eq!(
                mesh_of("a.ply", text.as_bytes()).as_ref(),
                Ok(&plain),
                "{text:?}"
            );
            let header = header.replace("ascii", "binary_little_endian");
            let header = format!("{mark}{}", header.replace('\n', end));
            let file = [header.as_bytes(), &binary].concat();
            assert_eq!(mesh_of("a.ply", &file).as_ref(), Ok(&plain), "{header:?}");
        }
    }
}

/// Colors under the names of other programs, and those of faces; VTK and trimesh read them so.
#[test]
fn ply_has_the_colors_of_scanners() {
    let orange = [1.0, 0.215_860_53, 0.0].map(|x: f32| (x * 1e5).round());
    let channels = |names: [&str; 3]| {
        names
            .map(|name| format!("property uchar {name}\n"))
            .concat()
    };
    let colored = VERTICES.replace(" 0\n", " 0 255 128 0\n");
    let faces = "3 0 1 2 0 0 255\n3 0 2 3 255 128 0\n";
    let mut files: Vec<String> = [
        ["red", "green", "blue"],
        ["r", "g", "b"],
        ["diffuse_red", "diffuse_green", "diffuse_blue"],
    ]
    .map(|names| {
        ply(
            [4, 2],
            &channels(names),
            "",
            &format!("{colored}3 0 1 2\n3 0 2 3\n"),
        )
    })
    .into();
    let of_face = channels(["red", "green", "blue"]);
    files.push(ply([4, 2], "", &of_face, &format!("{VERTICES}{faces}")));
    for text in files {
        let colors = mesh_of("a.ply", text.as_bytes()).unwrap().colors.unwrap();
        for color in colors.at(1) {
            assert_eq!(
                color.to_array().map(|x| (x * 1e5).round()),
                orange,
                "{text}"
            );
        }
    }
}

#[test]
fn ply_has_texture_coordinates_at_the_corners_of_faces() {
    let list = "property list uchar float texcoord\n";
    let rows = format!("{VERTICES}4 0 1 2 3 8 0 0 1 0 1 1 0 1\n3 0 1 2 0\n3 0 1 2 2 5 5\n");
    let mesh = mesh_of("a.ply", ply([4, 3], "", list, &rows).as_bytes()).unwrap();
    let uvs = mesh.uvs.unwrap();
    assert_eq!(uvs.at(1), [Vec2::ZERO, Vec2::ONE, Vec2::Y]);
    assert_eq!(uvs.at(3), [Vec2::ZERO; 3]);
    let kind = "texture coordinates that not all corners of a face have (1, line 17)";
    assert_eq!(mesh.notes, [format!("left out: {kind}")]);
}

#[test]
fn the_vertices_of_a_mesh_are_points() {
    let points = |name: &str, text: &str| {
        let radius = RadiusChoice::Same(0.5);
        reading(name, text.as_bytes(), |path| {
            read_points(path, &radius, None).unwrap()
        })
    };
    let header = ply(
        [3, 0],
        "property uchar r\nproperty uchar g\nproperty uchar b\n",
        "",
        "",
    );
    let (header, _) = header.split_once("element face").unwrap();
    let cloud = format!("{header}end_header\n1 2 3 255 0 0\nnan 0 0 0 0 0\n4 5 6 0 0 255\n");
    let found = points("a.ply", &cloud);
    let centers: Vec<Vec3> = found.spheres.iter().map(|sphere| sphere.center).collect();
    assert_eq!(
        centers,
        [Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 5.0, 6.0)]
    );
    assert_eq!(found.colors, Some(vec![Vec3::X, Vec3::Z]));
    assert_eq!(
        found.notes,
        ["left out: points that are not finite (1, point 1)"]
    );
    assert_eq!(points("a.obj", TRIANGLE).spheres.len(), 3);
}
