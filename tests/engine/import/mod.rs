//! Geometry files: what was written is read, and what is damaged is refused
//! at its place.

mod far;
mod faults;
mod isosurfaces;
mod left_out;
mod lines;
mod vtk;
mod vtk_meshes;
mod vtk_pictures;
mod write;

use crate::common::generators::cases;
use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};
use import::{FileFault, Mesh, RadiusChoice, read_mesh, read_spheres, read_tubes};
use proptest::prelude::*;
use world::material::{ArrayChoice, ArrayOf};
use world::scene::CornerValues;
use write::{Encoding, binary_stl, obj, ply, stl};

/// Writes `bytes` to a file of this name, which `read` reads.
fn reading<T>(name: &str, bytes: &[u8], read: impl Fn(&Path) -> T) -> T {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    read(&path)
}

fn mesh_of(name: &str, bytes: &[u8]) -> Result<Mesh, FileFault> {
    reading(name, bytes, read_mesh)
}

/// The message of a damaged file, from behind its name.
fn message<T: std::fmt::Debug>(read: Result<T, FileFault>) -> String {
    let message = read.unwrap_err().to_string();
    message
        .split_once("`")
        .unwrap()
        .1
        .split_once('`')
        .unwrap()
        .1
        .to_owned()
}

fn vector() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-1e6_f32..1e6).prop_map(Vec3::from)
}

/// A mesh, with normals and texture coordinates at its vertices or with none.
fn mesh() -> impl Strategy<Value = Mesh> {
    (
        prop::collection::vec((vector(), (vector(), vector())), 3..20),
        any::<[bool; 2]>(),
    )
        .prop_flat_map(|(points, [has_normals, has_uvs])| {
            let index = 0..points.len() as u32;
            let triangles = prop::collection::vec(prop::array::uniform3(index), 1..30);
            triangles.prop_map(move |triangles| {
                let (vertices, (normals, uvs)): (_, (_, Vec<Vec3>)) =
                    points.iter().copied().unzip();
                let normals = has_normals.then(|| CornerValues {
                    values: normals,
                    triangles: triangles.clone(),
                });
                let uvs = has_uvs.then(|| CornerValues {
                    values: uvs.iter().map(|uv| uv.truncate()).collect(),
                    triangles: triangles.clone(),
                });
                Mesh {
                    vertices,
                    triangles,
                    normals,
                    uvs,
                    ..Mesh::default()
                }
            })
        })
}

proptest! {
    #![proptest_config(cases(200))]

    #[test]
    fn what_was_written_is_read(mesh in mesh()) {
        prop_assert_eq!(mesh_of("a.OBJ", &obj(&mesh)).unwrap(), mesh.clone());
        for encoding in [Encoding::Text, Encoding::Little, Encoding::Big] {
            let read = mesh_of("a.ply", &ply(&mesh, encoding)).unwrap();
            prop_assert_eq!(&read, &mesh, "{:?}", encoding);
        }
    }

    #[test]
    fn an_stl_file_has_the_same_triangles_and_equal_vertices_once(mesh in mesh()) {
        let corners = |mesh: &Mesh| -> Vec<[Vec3; 3]> {
            mesh.triangles.iter().map(|&triangle| mesh.triangle(triangle).vertices).collect()
        };
        let used: std::collections::HashSet<[u32; 3]> = corners(&mesh)
            .concat()
            .into_iter()
            .map(|vertex| (vertex + 0.0).to_array().map(f32::to_bits))
            .collect();
        for bytes in [stl(&mesh), binary_stl(&mesh)] {
            let read = mesh_of("a.stl", &bytes).unwrap();
            prop_assert_eq!(corners(&read), corners(&mesh));
            prop_assert_eq!((read.vertices.len(), &read.normals), (used.len(), &None));
        }
    }

    #[test]
    fn damage_never_panics(mesh in mesh(), at in any::<prop::sample::Index>(), byte in any::<u8>()) {
        let files = [
            ("a.obj", obj(&mesh)),
            ("a.stl", stl(&mesh)),
            ("b.stl", binary_stl(&mesh)),
            ("a.ply", ply(&mesh, Encoding::Text)),
            ("b.ply", ply(&mesh, Encoding::Little)),
            ("c.ply", ply(&mesh, Encoding::Big)),
        ];
        for (name, mut bytes) in files {
            let at = at.index(bytes.len());
            bytes[at] = byte;
            if let Ok(mesh) = mesh_of(name, &bytes) {
                prop_assert!(mesh.triangles.iter().flatten().all(|i| (*i as usize) < mesh.vertices.len()));
                prop_assert!(mesh.vertices.iter().all(|vertex| vertex.is_finite()));
            }
        }
    }
}

/// A tetrahedron with normals.
fn tetrahedron() -> Mesh {
    let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let normals = CornerValues {
        values: vertices
            .iter()
            .map(|vertex| vertex - Vec3::splat(0.25))
            .collect(),
        triangles: triangles.clone(),
    };
    Mesh {
        vertices,
        triangles,
        normals: Some(normals),
        ..Mesh::default()
    }
}

#[test]
fn a_binary_file_that_ends_early_is_refused() {
    for encoding in [Encoding::Little, Encoding::Big] {
        let whole = ply(&tetrahedron(), encoding);
        mesh_of("a.ply", &whole).unwrap();
        for n in 0..whole.len() {
            mesh_of("a.ply", &whole[..n]).unwrap_err();
        }
    }
}

#[test]
fn a_text_that_ends_early_is_refused_or_a_mesh() {
    let (obj, ply) = (obj(&tetrahedron()), ply(&tetrahedron(), Encoding::Text));
    for n in 0..obj.len() {
        let _ = mesh_of("a.obj", &obj[..n]);
    }
    // The last number, 0.75, may be cut and still be one.
    for n in 0..ply.len() - 5 {
        let _ = mesh_of("a.ply", &ply[..n]).unwrap_err();
    }
}

#[test]
fn a_binary_mistake_is_told_by_its_element() {
    let mut mesh = tetrahedron();
    mesh.triangles[2][1] = 4;
    let read = mesh_of("a.ply", &ply(&mesh, Encoding::Big));
    let expected = ", face 2: there is no vertex 4, expected one of the 4 vertices, from 0";
    assert_eq!(message(read), expected);
}

#[test]
fn polygons_are_cut_into_triangles() {
    let corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0.5 0\n";
    let mesh = mesh_of("a.obj", format!("{corners}f -5 -4 -3 -2 -1\n").as_bytes()).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
}

#[test]
fn a_face_without_normals_keeps_its_own_among_others() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1 3 2\n";
    let normals = mesh_of("a.obj", text.as_bytes()).unwrap().normals.unwrap();
    let of_triangle = |i: usize| normals.triangles[i].map(|normal| normals.values[normal as usize]);
    assert_eq!(of_triangle(0), [Vec3::Z; 3]);
    assert_eq!(of_triangle(1), [Vec3::X; 3]);
    assert_eq!(of_triangle(2), [-Vec3::Z; 3]);
}

#[test]
fn what_is_no_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for path in [folder.path().join("none.obj"), PathBuf::from("none.csv")] {
        let error = message(import::max_bytes(&path));
        assert!(error.starts_with(": cannot read it: "), "{error}");
    }
    assert_eq!(
        message(import::max_bytes(folder.path())),
        ": it is not a file, expected a file"
    );
}

/// Files of old and of careful editors, and what may follow a vertex.
#[test]
fn a_text_is_read_whatever_wrote_it() {
    let lines = [
        "# a triangle",
        "v 0 0 0 1",
        "v 1 0 0 0.5 0.5 0.5 # gray",
        "v 0 1 0 1 0.5 0.5 0.5",
        "vn 0 0 1",
        "f 1//1 2/7/1 \\",
        "3//1",
    ];
    let plain = mesh_of("a.obj", lines.join("\n").as_bytes()).unwrap();
    assert_eq!(plain.triangles, [[0, 1, 2]]);
    for end in ["\n", "\r\n", "\r"] {
        for mark in ["", "\u{feff}"] {
            let text = format!("{mark}{}{end}", lines.join(end));
            assert_eq!(
                mesh_of("a.obj", text.as_bytes()).as_ref(),
                Ok(&plain),
                "{text:?}"
            );
            // Editors of Windows mark UTF-16 in both orders.
            let text = format!("\u{feff}{}{end}$ a comment{end}", lines.join(end));
            for bytes_of in [u16::to_le_bytes, u16::to_be_bytes] {
                let wide: Vec<u8> = text.encode_utf16().flat_map(bytes_of).collect();
                assert_eq!(mesh_of("a.obj", &wide).as_ref(), Ok(&plain));
            }
        }
    }
}

#[test]
fn a_table_gives_its_spheres() {
    let read = |text: &str| {
        let radius = RadiusChoice::Same(0.5);
        let read = |path: &Path| read_spheres(path, Some(&radius), None);
        reading("a.csv", text.as_bytes(), read).unwrap()
    };
    let plain = read("x,y,z\n1,2,3\n-4, 5e0 ,6\n");
    assert_eq!((plain.colors, plain.scalars), (None, None));
    assert_eq!(plain.spheres[1].center, Vec3::new(-4.0, 5.0, 6.0));
    assert_eq!(plain.spheres[1].radius, 0.5);
    let full = read("color,r,z,y,x,,mass\r\n#0a0B0c,7,3,2,1,first,heavy\r\n");
    assert_eq!(full.colors, Some(vec![Vec3::new(10.0, 11.0, 12.0) / 255.0]));
    let center = full.origin + full.spheres[0].center.as_dvec3();
    assert_eq!(center, DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(full.spheres[0].radius, 7.0);
}

/// As ParaView and programs of other countries write them.
#[test]
fn a_table_has_other_separators_and_names_of_coordinates() {
    let radius = RadiusChoice::Same(0.5);
    for text in [
        "X,Y,Z\n1,2,3\n",
        "x;y;z;name\n1;2;3;a\n",
        "x\ty\tz\n1\t2\t3\n",
        "T,Points:0,Points:1,Points:2\r0,1,2,3\r",
        "\u{feff}x,y,z,X\n1,2,3,7\n",
    ] {
        let read = |path: &Path| read_spheres(path, Some(&radius), None);
        let found = reading("a.csv", text.as_bytes(), read).unwrap();
        let center = found.origin + found.spheres[0].center.as_dvec3();
        assert_eq!(center, DVec3::new(1.0, 2.0, 3.0), "{text}");
    }
}

fn column(name: &str) -> ArrayChoice {
    ArrayChoice {
        name: name.to_owned(),
        component: None,
        of: None,
        is_color: false,
    }
}

#[test]
fn the_columns_of_a_table_are_arrays() {
    let text = "x,y,z,r,d,mass,color\n0,0,0,1,4,,#000000\n1,0,0,2,6,-7e3,#ffffff\n";
    let radius = RadiusChoice::Array {
        array: column("d"),
        factor: 0.5,
    };
    let read = |array: &ArrayChoice| {
        let read = |path: &Path| read_spheres(path, Some(&radius), Some(array));
        reading("a.csv", text.as_bytes(), read)
    };
    let found = read(&column("mass")).unwrap();
    let radii: Vec<f32> = found.spheres.iter().map(|sphere| sphere.radius).collect();
    assert_eq!(radii, [2.0, 3.0]);
    let numbers = found.scalars.unwrap();
    assert!(numbers[0].is_nan() && numbers[1] == -7000.0 && numbers.len() == 2);
    // The colors of the array are seen, not those of the column `color`.
    assert_eq!(found.colors, None);
    let first = ArrayChoice {
        component: Some(0),
        of: Some(ArrayOf::Points),
        ..column("x")
    };
    assert_eq!(read(&first).unwrap().scalars, Some(vec![0.0, 1.0]));
    for (array, expected) in [
        (
            column("mas"),
            ", line 1: it has no column `mas`, did you mean `mass`?, expected one of its columns, \
             such as `x`, `y`, `z`, `r`, `d`, `mass` or `color`",
        ),
        (
            column("color"),
            ", line 2: `#000000` is not a number, expected a number",
        ),
        (
            ArrayChoice {
                component: Some(1),
                ..column("mass")
            },
            ", line 1: `mass` can only be a column of a table, expected one number for each point",
        ),
        (
            ArrayChoice {
                of: Some(ArrayOf::Cells),
                ..column("mass")
            },
            ", line 1: `mass` can only be a column of a table, expected one number for each point",
        ),
    ] {
        assert_eq!(message(read(&array)), expected);
    }
}

#[test]
fn the_columns_of_a_table_of_tubes_are_arrays() {
    let text = "x,y,z,line,speed\n0,0,0,a,1\n0,0,0,a,9\n1,0,0,a,2\n2,0,0,b,3\n3,0,0,b,\n";
    let radius = RadiusChoice::Array {
        array: column("speed"),
        factor: 0.5,
    };
    let of_all = RadiusChoice::Same(0.1);
    let read = |radius: &RadiusChoice| {
        let speed = column("speed");
        let read = |path: &Path| read_tubes(path, Some(radius), Some(&speed));
        reading("a.csv", text.as_bytes(), read)
    };
    let numbers = read(&of_all).unwrap().scalars.unwrap();
    assert_eq!(numbers[0], [1.0, 2.0]);
    assert!(numbers[1][0] == 3.0 && numbers[1][1].is_nan() && numbers.len() == 2);
    assert_eq!(
        message(read(&radius)),
        ", line 6: `` is not a number, expected a number"
    );
}

/// A U of area 8, whose texture coordinates are a quarter of its positions, as OBJ and as PLY with the
/// faces before the vertices.
#[test]
fn concave_faces_have_their_area_and_their_attributes() {
    let u = [
        [0, 0],
        [4, 0],
        [4, 3],
        [3, 3],
        [3, 1],
        [1, 1],
        [1, 3],
        [0, 3],
    ];
    let quarter = |[x, y]: [i32; 2]| [x, y].map(|number| f64::from(number) / 4.0);
    let vertices = u.map(|[x, y]| format!("v {x} {y} 0\n")).concat();
    let uvs = u.map(|at| quarter(at).map(|number| number.to_string()).join(" "));
    let uvs = uvs.map(|uv| format!("vt {uv}\n")).concat();
    let corners: String = (1..=8).map(|i| format!(" {i}/{i}")).collect();
    let obj = format!("{vertices}{uvs}f{corners}\n");
    let rows = u.map(|at| {
        let [u, v] = quarter(at);
        format!("{} {} 0 {u} {v}\n", at[0], at[1])
    });
    let ply = format!(
        "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\n\
         element vertex 8\nproperty float x\nproperty float y\nproperty float z\nproperty float u\n\
         property float v\nend_header\n8 0 1 2 3 4 5 6 7\n{}",
        rows.concat()
    );
    for (name, text) in [("a.obj", obj), ("a.ply", ply)] {
        let mesh = mesh_of(name, text.as_bytes()).unwrap_or_else(|fault| panic!("{fault}"));
        let uvs = mesh.uvs.as_ref().unwrap();
        let mut area = 0.0;
        for (i, triangle) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = mesh.triangle(*triangle).vertices;
            area += 0.5 * (b - a).cross(c - a).length();
            for (at, uv) in [a, b, c].into_iter().zip(uvs.at(i)) {
                assert_eq!(at.truncate() / 4.0, uv, "{name}");
            }
        }
        assert_eq!((mesh.triangles.len(), area), (6, 8.0), "{name}");
    }
}
