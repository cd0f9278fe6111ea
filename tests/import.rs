//! Geometry files: what was written is read, and what is damaged is refused
//! at its place.

use std::path::{Path, PathBuf};

use glam::Vec3;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use raycost::import::{FileFault, Mesh, Normals, read_mesh, read_spheres};

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

// Writers, plain enough to be right.

fn obj(mesh: &Mesh) -> Vec<u8> {
    let mut text = String::from("# a comment\r\no thing\n");
    for v in &mesh.vertices {
        text += &format!("v {:e}   {} {} 0.5 0.5 0.5\r\n", v.x, v.y, v.z);
    }
    for (i, [a, b, c]) in mesh.triangles.iter().map(|t| t.map(|i| i + 1)).enumerate() {
        match &mesh.normals {
            None => text += &format!("f {a} \\\n {b}/1 {c}/2/\n"),
            Some(normals) => {
                if i == 0 {
                    let line = |n: &Vec3| format!("vn {} {} {}\n", n.x, n.y, n.z);
                    text.extend(normals.vectors.iter().map(line));
                }
                let n = normals.vectors.len() as i64;
                let [p, q, r] = normals.triangles[i].map(|normal| i64::from(normal) - n);
                text += &format!("f {a}//{p} {b}/1/{q} {c}//{r} # behind\n");
            }
        }
    }
    text.into_bytes()
}

/// The three encodings of PLY.
#[derive(Debug, Clone, Copy)]
enum Encoding {
    Text,
    Little,
    Big,
}

/// Numbers of a row, as they are encoded.
enum Number {
    U8(u8),
    I32(i32),
    F32(f32),
    F64(f64),
}

impl Encoding {
    fn name(self) -> &'static str {
        match self {
            Self::Text => "ascii",
            Self::Little => "binary_little_endian",
            Self::Big => "binary_big_endian",
        }
    }

    fn row(self, numbers: &[Number], out: &mut Vec<u8>) {
        for number in numbers {
            match (self, number) {
                (Self::Text, Number::U8(n)) => out.extend(format!("{n} ").bytes()),
                (Self::Text, Number::I32(n)) => out.extend(format!("{n} ").bytes()),
                (Self::Text, Number::F32(n)) => out.extend(format!("{n} ").bytes()),
                (Self::Text, Number::F64(n)) => out.extend(format!("{n} ").bytes()),
                (_, Number::U8(n)) => out.push(*n),
                (Self::Little, Number::I32(n)) => out.extend(n.to_le_bytes()),
                (Self::Little, Number::F32(n)) => out.extend(n.to_le_bytes()),
                (Self::Little, Number::F64(n)) => out.extend(n.to_le_bytes()),
                (Self::Big, Number::I32(n)) => out.extend(n.to_be_bytes()),
                (Self::Big, Number::F32(n)) => out.extend(n.to_be_bytes()),
                (Self::Big, Number::F64(n)) => out.extend(n.to_be_bytes()),
            }
        }
        if matches!(self, Self::Text) {
            out.push(b'\n');
        }
    }
}

/// With properties and an element that are no mesh's, and its faces first.
fn ply(mesh: &Mesh, encoding: Encoding) -> Vec<u8> {
    let normals = mesh.normals.as_ref();
    let (n_vertices, n_faces) = (mesh.vertices.len(), mesh.triangles.len());
    let of_normals = match normals {
        Some(_) => "property float nx\nproperty float ny\nproperty float nz\n",
        None => "",
    };
    let header = format!(
        "ply\nformat {} 1.0\ncomment a comment\nelement face {n_faces}\n\
         property uchar quality\nproperty list uchar int vertex_index\n\
         element camera 1\nproperty list uchar float view\nelement vertex {n_vertices}\n\
         property double x\nproperty float y\nproperty uchar red\nproperty float z\n\
         {of_normals}end_header\n",
        encoding.name()
    );
    let mut out = header.into_bytes();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|i| Number::I32(i as i32));
        encoding.row(&[Number::U8(7), Number::U8(3), a, b, c], &mut out);
    }
    encoding.row(
        &[Number::U8(2), Number::F32(0.5), Number::F32(1.0)],
        &mut out,
    );
    for (i, v) in mesh.vertices.iter().enumerate() {
        let mut row = vec![Number::F64(v.x.into()), Number::F32(v.y)];
        row.extend([Number::U8(255), Number::F32(v.z)]);
        row.extend(
            normals
                .iter()
                .flat_map(|normals| normals.vectors[i].to_array().map(Number::F32)),
        );
        encoding.row(&row, &mut out);
    }
    out
}

fn vector() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-1e6_f32..1e6).prop_map(Vec3::from)
}

/// A mesh, with normals at its vertices or with none.
fn mesh() -> impl Strategy<Value = Mesh> {
    (
        prop::collection::vec((vector(), vector()), 3..20),
        any::<bool>(),
    )
        .prop_flat_map(|(points, has_normals)| {
            let index = 0..points.len() as u32;
            let triangles = prop::collection::vec(prop::array::uniform3(index), 1..30);
            triangles.prop_map(move |triangles| {
                let (vertices, vectors) = points.iter().copied().unzip();
                let normals = has_normals.then(|| Normals {
                    vectors,
                    triangles: triangles.clone(),
                });
                Mesh {
                    vertices,
                    triangles,
                    normals,
                }
            })
        })
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 200,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(1),
        ..ProptestConfig::default()
    })]

    #[test]
    fn what_was_written_is_read(mesh in mesh()) {
        prop_assert_eq!(mesh_of("a.OBJ", &obj(&mesh)).unwrap(), mesh.clone());
        for encoding in [Encoding::Text, Encoding::Little, Encoding::Big] {
            let read = mesh_of("a.ply", &ply(&mesh, encoding)).unwrap();
            prop_assert_eq!(&read, &mesh, "{:?}", encoding);
        }
    }

    #[test]
    fn damage_never_panics(mesh in mesh(), at in any::<prop::sample::Index>(), byte in any::<u8>()) {
        let files = [
            ("a.obj", obj(&mesh)),
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
    let normals = Normals {
        vectors: vertices
            .iter()
            .map(|vertex| vertex - Vec3::splat(0.25))
            .collect(),
        triangles: triangles.clone(),
    };
    Mesh {
        vertices,
        triangles,
        normals: Some(normals),
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
fn each_mistake_is_told_at_its_place() {
    let ply = |body: &str| format!("ply\nformat ascii 1.0\n{body}");
    let triangle = |header: &str, rows: &str| {
        ply(&format!(
            "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             element face 1\n{header}end_header\n{rows}"
        ))
    };
    let list = "property list uchar int vertex_indices\n";
    let rows = "0 0 0\n1 0 0\n0 1 0\n";
    let cases: &[(&str, &str, &str)] = &[
        (
            "a.stl",
            "",
            ": unknown mesh format `.stl`, expected a file that ends in .obj or .ply",
        ),
        (
            "mesh",
            "",
            ": its name does not tell its format, expected a file that ends in .obj or .ply",
        ),
        ("a.obj", "", ": no triangle in the file, expected faces"),
        (
            "a.obj",
            "v 1 2\n",
            ", line 1: 2 coordinates, expected three: x, y and z",
        ),
        (
            "a.obj",
            "# x\nv 1 b 2\n",
            ", line 2: `b` is no number, expected a coordinate",
        ),
        (
            "a.obj",
            "v 1 nan 2\n",
            ", line 1: a coordinate is NaN, expected finite numbers",
        ),
        (
            "a.obj",
            "v 1 2 1e39\n",
            ", line 1: a coordinate is inf, expected finite numbers",
        ),
        (
            "a.obj",
            "v 0 0 0\nf 1 1\n",
            ", line 2: a face has 2 corners, expected at least 3",
        ),
        (
            "a.obj",
            "v 0 0 0\nf 1 1 2\n",
            ", line 2: there is no vertex 2, expected one of the 1 above",
        ),
        (
            "a.obj",
            "v 0 0 0\nf 1 1 0\n",
            ", line 2: there is no vertex 0, expected one of the 1 above",
        ),
        (
            "a.obj",
            "v 0 0 0\nf 1 1 -2\n",
            ", line 2: there is no vertex -2, expected one of the 1 above",
        ),
        (
            "a.obj",
            "v 0 0 0\nf 1//1 1 1\n",
            ", line 2: there is no normal 1, expected one of the 0 above",
        ),
        (
            "a.obj",
            "v 0 0 0\nvn 0 0 1\nf 1//1 1 1\n",
            ", line 3: 1 of 3 corners have a normal, expected normals at all corners or at none",
        ),
        (
            "a.obj",
            "v 0 0 0\nf 1 1 one\n",
            ", line 2: `one` is no vertex, expected a number, as in `3`, `3/1`, `3/1/2` or `3//2`",
        ),
        (
            "a.obj",
            "solid cube\n",
            ", line 1: unknown statement `solid`, expected an OBJ file of polygons: `v`, `vn` and `f`",
        ),
        (
            "a.ply",
            "",
            ", line 1: the header is damaged: File must start with 'ply', expected a PLY file",
        ),
        (
            "a.ply",
            &ply("element vertex 3\nproperty quaternion q\n"),
            ", line 4: the header is damaged: Unknown scalar type: quaternion, expected a PLY file",
        ),
        (
            "a.ply",
            &ply("element vertex 3\nproperty float x\nend_header\n"),
            ": element `vertex` has no number `y`, expected `property float y` in the header",
        ),
        (
            "a.ply",
            &ply("element stars 9000000000000000000\nend_header\n"),
            ": element `stars` has no properties, expected at least one",
        ),
        (
            "a.ply",
            &ply("element star 1\nproperty float x\nproperty float x\nend_header\n"),
            ": the header has property `x` twice, expected different names",
        ),
        (
            "a.ply",
            &triangle("property list uchar float vertex_indices\n", ""),
            ": element `face` has no list of vertices, expected `property list uchar int vertex_indices` in the header",
        ),
        (
            "a.ply",
            &triangle(list, &format!("{rows}3 0 1 3\n")),
            ", line 13: there is no vertex 3, expected one of the 3 vertices, from 0",
        ),
        (
            "a.ply",
            &triangle(list, &format!("{rows}3 0 1 -1")),
            ", line 13: there is no vertex -1, expected one of the 3 vertices, from 0",
        ),
        (
            "a.ply",
            &triangle(list, &format!("{rows}2 0 1\n")),
            ", line 13: a face has 2 corners, expected at least 3",
        ),
        (
            "a.ply",
            &triangle(list, "0 0 0\n0 inf 0\n0 0 0\n3 0 1 2\n"),
            ", line 11: a coordinate is inf, expected finite numbers",
        ),
        (
            "a.ply",
            &triangle(list, rows),
            ", line 12: the file ends within its `face` elements, expected 1 of them",
        ),
        (
            "a.ply",
            &triangle(list, &format!("{rows}3 0 1 2\n\n 4\n")),
            ": there is more than the header tells of, expected as many numbers in each row as it has properties",
        ),
    ];
    for (name, text, expected) in cases {
        assert_eq!(
            message(mesh_of(name, text.as_bytes())),
            *expected,
            "{name}: {text}"
        );
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
    let of_triangle =
        |i: usize| normals.triangles[i].map(|normal| normals.vectors[normal as usize]);
    assert_eq!(of_triangle(0), [Vec3::Z; 3]);
    assert_eq!(of_triangle(1), [Vec3::X; 3]);
    assert_eq!(of_triangle(2), [-Vec3::Z; 3]);
}

#[test]
fn what_is_no_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for path in [folder.path().join("none.obj"), PathBuf::from("none.csv")] {
        let error = message(raycost::import::n_bytes(&path));
        assert!(error.starts_with(": cannot read it: "), "{error}");
    }
    assert_eq!(
        message(raycost::import::n_bytes(folder.path())),
        ": it is no file, expected a file"
    );
}

#[test]
fn a_table_gives_its_spheres() {
    let read = |text: &str, radius| {
        reading("a.csv", text.as_bytes(), |path| read_spheres(path, radius)).unwrap()
    };
    let plain = read("x,y,z\n1,2,3\n-4, 5e0 ,6\n", Some(0.5));
    assert_eq!(plain.colors, None);
    assert_eq!(plain.spheres[1].center, Vec3::new(-4.0, 5.0, 6.0));
    assert_eq!(plain.spheres[1].radius, 0.5);
    let full = read("color,r,z,y,x\r\n#0a0B0c,7,3,2,1\r\n", Some(0.5));
    assert_eq!(full.colors, Some(vec![[10, 11, 12]]));
    assert_eq!(full.spheres[0].center, Vec3::new(1.0, 2.0, 3.0));
    assert_eq!(full.spheres[0].radius, 7.0);
}

#[test]
fn a_mistake_in_a_table_is_told_at_its_line() {
    let cases = [
        (
            "",
            ", line 1: there is no column `x`, expected a first line such as `x,y,z,r,color`",
        ),
        (
            "x,y,r\n",
            ", line 1: there is no column `z`, expected a first line such as `x,y,z,r,color`",
        ),
        (
            "x,y,z\n",
            ", line 1: there is no column `r`, expected one, or a `radius` for all spheres in the scene",
        ),
        (
            "x,y,z,r,x\n",
            ", line 1: two columns are named `x`, expected different names",
        ),
        (
            "x,y,z,r,colour\n",
            ", line 1: unknown column `colour`, did you mean `color`?, \
             expected a first line of `x`, `y`, `z`, `r` and `color`",
        ),
        (
            "x,y,z,r\n",
            ": no sphere in the file, expected a line for each",
        ),
        (
            "x,y,z,r\n1,2,3,4\n1,2,3\n",
            ", line 3: 3 fields, expected 4, as in line 1",
        ),
        (
            "x,y,z,r\n1,2,3,\n",
            ", line 2: `` is no number, expected a number",
        ),
        (
            "x,y,z,r\n1,inf,3,4\n",
            ", line 2: a coordinate is inf, expected finite numbers",
        ),
        (
            "x,y,z,r\n1,2,3,0\n",
            ", line 2: a radius is 0, expected a number greater than 0",
        ),
        (
            "x,y,z,r\n1,2,3,NaN\n",
            ", line 2: a radius is NaN, expected a number greater than 0",
        ),
        (
            "x,y,z,r,color\n1,2,3,1,red\n",
            ", line 2: `red` is no colour, expected `#rrggbb`",
        ),
    ];
    for (text, expected) in cases {
        let read = reading("a.csv", text.as_bytes(), |path| read_spheres(path, None));
        assert_eq!(message(read), expected, "{text}");
    }
}
