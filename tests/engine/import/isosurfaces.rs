//! Isosurfaces of VTK files: closed, where the array has the value, and those of VTK.

use std::collections::HashMap;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use glam::{DVec3, Vec3};
use import::{FileFault, IsosurfaceChoice, LeftOut, Mesh, read_isosurface};
use proptest::prelude::*;
use world::material::{ArrayChoice, ArrayOf};

use super::{message, reading};
use crate::common::generators::cases;
use crate::common::in_repository;

fn choice(name: &str) -> ArrayChoice {
    ArrayChoice {
        is_color: false,
        name: name.to_owned(),
        component: None,
        of: Some(ArrayOf::Points),
    }
}

fn surface_of(name: &str, values: &[f32]) -> IsosurfaceChoice {
    IsosurfaceChoice {
        array: choice(name),
        values: values.iter().map(|value| f64::from(*value)).collect(),
    }
}

/// The text of an image with a field at its points.
fn image([nx, ny, nz]: [usize; 3], field: &[impl std::fmt::Display]) -> String {
    let mut values = String::new();
    for value in field {
        write!(values, "{value} ").unwrap();
    }
    let array = |name: &str, values: &str| {
        format!("<DataArray type='Float32' Name='{name}' format='ascii'>{values}</DataArray>")
    };
    let cells = "3 ".repeat((nx - 1) * (ny - 1) * (nz - 1));
    let extent = format!("0 {} 0 {} 0 {}", nx - 1, ny - 1, nz - 1);
    format!(
        "<VTKFile type='ImageData' byte_order='LittleEndian'>\
         <ImageData WholeExtent='{extent}' Origin='0 0 0' Spacing='1 1 1'>\
         <Piece Extent='{extent}'><PointData>{}</PointData><CellData>{}</CellData>\
         </Piece></ImageData></VTKFile>",
        array("field", &values),
        array("rank", &cells),
    )
}

fn read(text: &str, values: &[f32], color: &str) -> Result<Mesh, FileFault> {
    let color = ArrayChoice {
        of: None,
        ..choice(color)
    };
    let read = |path: &Path| read_isosurface(path, &surface_of("field", values), Some(&color));
    reading("a.vti", text.as_bytes(), read)
}

/// The edges of triangles, each with how often it is used in its direction less how often in
/// the other one.
fn open_edges(mesh: &Mesh) -> Vec<[u32; 2]> {
    let mut edges = HashMap::<[u32; 2], i32>::new();
    for &[a, b, c] in &mesh.triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            let sign = if from < to { 1 } else { -1 };
            *edges.entry([from.min(to), from.max(to)]).or_default() += sign;
        }
    }
    let open = edges.into_iter().filter(|(_, n)| *n != 0);
    open.map(|(edge, _)| edge).collect()
}

proptest! {
    #![proptest_config(cases(300))]

    /// Open edges are on the boundary of the grid alone, whatever the field, and every vertex
    /// is where the field has the value.
    #[test]
    fn isosurfaces_are_closed(
        field in prop::collection::vec(
            prop_oneof![6 => -1.0_f32..1.0, 1 => Just(0.25), 1 => Just(0.0), 1 => Just(1.0)],
            4 * 5 * 3,
        ),
    ) {
        let size = [4, 5, 3];
        let Ok(mesh) = read(&image(size, &field), &[0.25], "field") else {
            return Ok(());
        };
        for edge in open_edges(&mesh) {
            let [a, b] = edge.map(|vertex| mesh.vertices[vertex as usize]);
            let last = [3.0, 4.0, 2.0];
            let on_side = |axis: usize| [0.0, last[axis]].iter().any(|x| a[axis] == *x && b[axis] == *x);
            prop_assert!((0..3).any(on_side), "{a} {b}");
        }
        for value in &mesh.scalars.as_ref().unwrap().values {
            prop_assert!((value - 0.25).abs() < 1e-6, "{value}");
        }
        for &[a, b, c] in &mesh.triangles {
            prop_assert!(a != b && b != c && c != a);
        }
    }
}

/// The text of the image's voxels as polyhedra, the faces of which are turned by `turns`.
fn polyhedra([nx, ny, nz]: [usize; 3], field: &[f32], turns: &[usize]) -> String {
    const FACES: [[usize; 4]; 6] = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let at = |i: usize| [i % nx, i / nx % ny, i / nx / ny];
    let firsts = (0..nx * ny * nz).filter(|i| {
        let [x, y, z] = at(*i);
        x + 1 < nx && y + 1 < ny && z + 1 < nz
    });
    let (mut connectivity, mut faces, mut n_cells) = (String::new(), String::new(), 0);
    for first in firsts {
        let point =
            |corner: usize| first + (corner & 1) + nx * (corner >> 1 & 1) + nx * ny * (corner >> 2);
        (0..8).for_each(|corner| write!(connectivity, "{} ", point(corner)).unwrap());
        faces += "6 ";
        for k in 0..6 {
            let turn = turns[(6 * n_cells + k) % turns.len()];
            let mut face = FACES[(k + turns[n_cells % turns.len()]) % 6];
            face.rotate_left(turn % 4);
            if turn > 3 {
                face.reverse();
            }
            let [a, b, c, d] = face.map(point);
            write!(faces, "4 {a} {b} {c} {d} ").unwrap();
        }
        n_cells += 1;
    }
    let list = |number: &dyn Fn(usize) -> usize, n: usize| -> String {
        (0..n).map(|i| format!("{} ", number(i))).collect()
    };
    let points: String = (0..nx * ny * nz)
        .map(|i| format!("{} {} {} ", at(i)[0], at(i)[1], at(i)[2]))
        .collect();
    let values: String = field.iter().map(|value| format!("{value} ")).collect();
    let array = |name: &str, n_components: usize, values: &str| {
        format!(
            "<DataArray type='Float64' Name='{name}' NumberOfComponents='{n_components}' \
             format='ascii'>{values}</DataArray>"
        )
    };
    format!(
        "<VTKFile type='UnstructuredGrid' byte_order='LittleEndian'><UnstructuredGrid>\
         <Piece NumberOfPoints='{}' NumberOfCells='{n_cells}'><PointData>{}</PointData>\
         <Points>{}</Points><Cells>{}{}{}{}{}</Cells></Piece></UnstructuredGrid></VTKFile>",
        nx * ny * nz,
        array("field", 1, &values),
        array("Points", 3, &points),
        array("connectivity", 1, &connectivity),
        array("offsets", 1, &list(&|i| 8 * (i + 1), n_cells)),
        array("types", 1, &list(&|_| 42, n_cells)),
        array("faces", 1, &faces),
        array("faceoffsets", 1, &list(&|i| 31 * (i + 1), n_cells)),
    )
}

fn read_polyhedra(text: &str, values: &[f32]) -> Result<Mesh, FileFault> {
    let read = |path: &Path| read_isosurface(path, &surface_of("field", values), None);
    reading("a.vtu", text.as_bytes(), read)
}

/// Twice the area of a mesh along its normals, which only the lines around its polygons
/// determine.
fn area_vector(mesh: &Mesh) -> DVec3 {
    let corners = |triangle: &[u32; 3]| mesh.triangle(*triangle).vertices.map(|v| v.as_dvec3());
    let triangles = mesh.triangles.iter().map(corners);
    triangles.map(|[a, b, c]| (b - a).cross(c - a)).sum()
}

proptest! {
    #![proptest_config(cases(200))]

    /// The surface through polyhedra is that through voxels, in whatever order and direction
    /// the polyhedra have their faces.
    #[test]
    fn polyhedra_have_the_isosurface_of_the_cells_that_they_are(
        field in prop::collection::vec(
            prop_oneof![6 => -1.0_f32..1.0, 1 => Just(0.25), 1 => Just(0.0), 1 => Just(1.0)],
            4 * 3 * 3,
        ),
        turns in prop::collection::vec(0_usize..8, 1..40),
    ) {
        let size = [4, 3, 3];
        let Ok(expected) = read(&image(size, &field), &[0.25], "field") else {
            prop_assert!(read_polyhedra(&polyhedra(size, &field, &turns), &[0.25]).is_err());
            return Ok(());
        };
        let found = read_polyhedra(&polyhedra(size, &field, &turns), &[0.25]).unwrap();
        prop_assert_eq!(found.triangles.len(), expected.triangles.len());
        let sorted = |mesh: &Mesh| {
            let mut vertices: Vec<_> = mesh.vertices.iter().map(|v| v.to_array().map(f32::to_bits)).collect();
            vertices.sort_unstable();
            vertices
        };
        prop_assert_eq!(sorted(&found), sorted(&expected));
        // Each edge of the surface belongs to triangles on both of its sides, of one direction.
        for edge in open_edges(&found) {
            let [a, b] = edge.map(|vertex| found.vertices[vertex as usize]);
            let last = [3.0, 2.0, 2.0];
            let on_side = |axis: usize| [0.0, last[axis]].iter().any(|x| a[axis] == *x && b[axis] == *x);
            prop_assert!((0..3).any(on_side), "{a} {b}");
        }
        let change = area_vector(&found) - area_vector(&expected);
        prop_assert!(change.length() < 1e-4, "{change}");
    }
}

#[test]
fn a_polyhedron_with_a_hole_is_refused() {
    let text = polyhedra([2, 2, 2], &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], &[0]);
    assert_eq!(read_polyhedra(&text, &[0.5]).unwrap().triangles.len(), 1);
    let open = text.replace("6 4 0 4 6 2 ", "5 ").replace(">31 ", ">26 ");
    assert_ne!(open, text);
    assert_eq!(
        message(read_polyhedra(&open, &[0.5])),
        ", cell 0: the faces of this polyhedron leave a hole, expected each of its edges in two \
         of its faces"
    );
    // Those that the surface does not cross may be open.
    let elsewhere = message(read_polyhedra(&open, &[2.0]));
    assert!(elsewhere.contains("nowhere"), "{elsewhere}");
}

/// A ball in a grid of `n³` points from -1 to 1: the field is 1 less the distance.
fn ball(n: usize) -> String {
    let along = |i: usize| 2.0 * i as f32 / (n - 1) as f32 - 1.0;
    let field: Vec<f32> = (0..n * n * n)
        .map(|i| 1.0 - Vec3::new(along(i % n), along(i / n % n), along(i / n / n)).length())
        .collect();
    let text = image([n; 3], &field);
    let spacing = along(1) - along(0);
    let place = format!("Origin='-1 -1 -1' Spacing='{spacing} {spacing} {spacing}'");
    text.replace("Origin='0 0 0' Spacing='1 1 1'", &place)
}

#[test]
fn a_ball_has_its_area_and_normals_that_point_out_of_it() {
    let mesh = read(&ball(33), &[0.5, 0.2], "rank").unwrap();
    assert_eq!(open_edges(&mesh), [] as [[u32; 2]; 0]);
    let corners = |triangle: &[u32; 3]| mesh.triangle(*triangle).vertices;
    let areas = mesh.triangles.iter().map(|triangle| {
        let [a, b, c] = corners(triangle);
        let area = 0.5 * (b - a).cross(c - a);
        assert!(area.dot(a) > 0.0);
        f64::from(area.length())
    });
    let expected = 4.0 * std::f64::consts::PI * (0.5 * 0.5 + 0.8 * 0.8);
    assert!((areas.sum::<f64>() / expected - 1.0).abs() < 1e-2);
    let normals = mesh.normals.unwrap();
    assert_eq!(normals.triangles, mesh.triangles);
    for (normal, vertex) in normals.values.iter().zip(&mesh.vertices) {
        assert!(normal.dot(vertex.normalize()) > 0.999, "{normal} {vertex}");
    }
    assert!(mesh.scalars.unwrap().values.iter().all(|rank| *rank == 3.0));
}

#[test]
fn what_has_no_isosurface_is_refused() {
    let text = ball(5);
    assert_eq!(
        message(read(&text, &[1.5], "rank")),
        ": `field` is nowhere 1.5 in a solid cell, expected a value between -0.7320508 and 1, \
         in a grid or other cells with a volume"
    );
    // A value of several that no cell has is noted.
    let some = read(&text, &[0.5, 9.0], "rank").unwrap();
    assert_ne!(some.left_out, LeftOut::default());
    assert_eq!(
        some.triangles,
        read(&text, &[0.5], "rank").unwrap().triangles
    );
    assert_eq!(
        message(read(&text.replace("'field'", "'other'"), &[0.5], "rank")),
        ": it has no array of points `field`, expected one of its arrays, such as `other`"
    );
    // Missing values leave out their cells.
    let with_nan = text.replacen("0.13397461 ", "nan ", 1);
    assert_ne!(text, with_nan);
    let [whole, part] = [&text, &with_nan].map(|text| read(text, &[0.25], "field").unwrap());
    assert!(part.triangles.len() < whole.triangles.len());
    let read = |path: &Path| read_isosurface(path, &surface_of("field", &[0.5]), None);
    assert_eq!(
        message(reading("a.ply", b"ply", read)),
        ": it has no arrays for an isosurface, expected a VTK file, such as one that ends in \
         .vti or .vtu"
    );
}

#[test]
#[ignore = "needs VTK: tests/with-paraview"]
fn isosurfaces_are_those_of_vtk() {
    let python = std::env::var("RAYCOST_PYTHON").expect("run tests/with-paraview");
    let folder = tempfile::tempdir().unwrap();
    let script = in_repository("tests/vtk/isosurfaces.py");
    let output = Command::new(python).arg(script).arg(folder.path()).output();
    let output = output.unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let lines = String::from_utf8(output.stdout).unwrap();
    assert_eq!(lines.lines().count(), 26);
    for line in lines.lines() {
        let expected: serde_json::Value = serde_json::from_str(line).unwrap();
        let file = folder.path().join(expected["file"].as_str().unwrap());
        let value = expected["value"].as_f64().unwrap() as f32;
        let mesh = read_isosurface(
            &file,
            &surface_of("field", &[value]),
            Some(&choice("color")),
        );
        let mesh = mesh.unwrap_or_else(|fault| panic!("{fault}"));
        let near = |found: f64, expected: &serde_json::Value, tolerance: f64, what: &str| {
            let expected = expected.as_f64().unwrap();
            let error = (found - expected).abs() / (1.0 + expected.abs());
            assert!(
                error <= tolerance,
                "{what} of {file:?}, {value}: {found} {expected}"
            );
        };
        let ends = |values: &mut dyn Iterator<Item = f64>| {
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
                [low.min(x), high.max(x)]
            })
        };
        for axis in 0..3 {
            let [low, high] = ends(&mut mesh.vertices.iter().map(|vertex| vertex[axis].into()));
            near(low, &expected["low"][axis], 1e-5, "the lower end");
            near(high, &expected["high"][axis], 1e-5, "the upper end");
        }
        let colors = ends(&mut mesh.scalars.as_ref().unwrap().values.iter().copied());
        for (i, color) in colors.into_iter().enumerate() {
            near(color, &expected["color"][i], 1e-5, "the color");
        }
        let area = |triangle: &[u32; 3]| {
            let [a, b, c] = mesh.triangle(*triangle).vertices.map(|v| v.as_dvec3());
            0.5 * (b - a).cross(c - a).length()
        };
        // The polygons of a cell are not flat: their triangulation matters a little.
        let name = expected["file"].as_str().unwrap();
        let tolerance = match (!name.contains("noise"), name.contains("polyhedra")) {
            (true, _) => 1e-2,
            (false, false) => 3e-2,
            // Their polygons begin at other corners.
            (false, true) => 6e-2,
        };
        near(
            mesh.triangles.iter().map(area).sum(),
            &expected["area"],
            tolerance,
            "the area",
        );
        let n_points = expected["points"].as_u64().unwrap();
        let n_triangles = expected["triangles"].as_u64().unwrap();
        // The same edges are crossed, and the same corners are kept apart on a face.
        let found = [mesh.vertices.len(), mesh.triangles.len()].map(|n| n as u64);
        assert_eq!(found, [n_points, n_triangles], "{file:?}, {value}");
    }
}

/// Seconds since 1970: 32 bits have steps of two minutes there.
#[test]
fn an_offset_of_the_field_does_not_move_the_surface() {
    let size = [4, 3, 3];
    let field: Vec<f64> = (0..36)
        .map(|i| f64::from(i % 4 * (i % 4) + i / 12))
        .collect();
    let of = |offset: f64| {
        let far: Vec<f64> = field.iter().map(|number| number + offset).collect();
        let choice = IsosurfaceChoice {
            array: choice("field"),
            values: vec![offset + 1.5],
        };
        let color = Some(choice.array.clone());
        let read = |path: &Path| read_isosurface(path, &choice, color.as_ref()).unwrap();
        reading("a.vti", image(size, &far).as_bytes(), read)
    };
    let [near, far] = [0.0, 1.7e9].map(of);
    assert_eq!(near.triangles, far.triangles);
    let pairs = near.vertices.iter().zip(&far.vertices);
    assert!(pairs.into_iter().all(|(a, b)| a.abs_diff_eq(*b, 1e-6)));
    let colors = far.scalars.unwrap().values;
    assert!(
        colors
            .iter()
            .all(|color| (color - 1.7e9 - 1.5).abs() < 1e-6)
    );
}
