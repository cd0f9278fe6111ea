//! The messages about faults in geometry files, and their positions.

use import::read_spheres;

use super::{mesh_of, message, reading};

#[test]
fn each_mistake_in_a_name_or_an_obj_file_is_reported_at_its_position() {
    assert_messages(&[
        (
            "a.fbx",
            "",
            ": raycost does not read FBX files; export glTF (.glb) or OBJ from the program that wrote it, or from \
             Blender, expected a file that ends in .obj, .ply, .stl, .gltf, .glb, .vtp, .vtu, \
             .vts, .vtr, .vti, .vtk, .pvtp, .pvtu, .pvts, .pvtr, .pvti, .vtm or .vtkhdf",
        ),
        (
            "mesh",
            "",
            ": its name has no extension, expected a file that ends in .obj, .ply, .stl, .gltf, .glb, .vtp, \
             .vtu, .vts, .vtr, .vti, .vtk, .pvtp, .pvtu, .pvts, .pvtr, .pvti, .vtm or .vtkhdf",
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
            ", line 2: `b` is not a number, expected a coordinate",
        ),
        (
            "a.obj",
            "v 0 0 0\rf 1/1/1/1 1 1\r",
            ", line 2: `1/1/1/1` is not a corner, \
             expected a number, as in `3`, `3/1`, `3/1/2` or `3//2`",
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
            "v 0 0 0\nf 1 1 one\n",
            ", line 2: `one` is not a corner, expected a number, as in `3`, `3/1`, `3/1/2` or `3//2`",
        ),
    ]);
}

#[test]
fn each_mistake_in_a_ply_file_is_reported_at_its_position() {
    let ply = |body: &str| format!("ply\nformat ascii 1.0\n{body}");
    let triangle = |header: &str, rows: &str| {
        ply(&format!(
            "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             element face 1\n{header}end_header\n{rows}"
        ))
    };
    let list = "property list uchar int vertex_indices\n";
    let rows = "0 0 0\n1 0 0\n0 1 0\n";
    assert_messages(&[
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
            &triangle(list, rows),
            ", line 12: the file ends within its `face` elements, expected 1 of them",
        ),
    ]);
}

/// Checks the messages about files with these names and contents.
fn assert_messages(cases: &[(&str, &str, &str)]) {
    for (name, text, expected) in cases {
        assert_eq!(
            message(mesh_of(name, text.as_bytes())),
            *expected,
            "{name}: {text}"
        );
    }
}

#[test]
fn a_mistake_in_a_table_is_reported_with_its_line() {
    let cases = [
        (
            "",
            ", line 1: there is no column `x`, expected a first line such as `x,y,z,r,color`, not ``",
        ),
        (
            "x,y,r\n",
            ", line 1: there is no column `z`, expected a first line such as `x,y,z,r,color`, \
             not `x,y,r`",
        ),
        (
            "a;b\n1;2\n",
            ", line 1: there is no column `x`, expected a first line such as `x,y,z,r,color`, \
             not `a,b`",
        ),
        (
            "x,y,z\n",
            ", line 1: there is no column `r`, expected one, or a `radius` in the scene: \
             one for all, or `{ array: … }`",
        ),
        (
            "x,y,z,r,x\n",
            ", line 1: two columns are named `x`, expected different names",
        ),
        (
            "x,y,z,r,colr\n",
            ", line 1: unknown column `colr`, did you mean `color`?, \
             expected a first line such as `x,y,z,r,color`, or another name",
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
            ", line 2: `` is not a number, expected a number",
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
            ", line 2: `red` is not a color, expected `#rrggbb`",
        ),
    ];
    for (text, expected) in cases {
        let read = reading("a.csv", text.as_bytes(), |path| {
            read_spheres(path, None, None)
        });
        assert_eq!(message(read), expected, "{text}");
    }
}

const SOLID: &str = "solid a b\n facet normal 0 0 nan\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n\
                     vertex 0 1 0\nendloop\nendfacet\nendsolid a b\n";

#[test]
fn each_mistake_in_an_stl_file_is_reported_at_its_position() {
    assert!(mesh_of("a.stl", SOLID.as_bytes()).is_ok());
    for (old, new, expected) in [
        (
            "vertex 1 0 0",
            "vertex 1 0",
            ", line 5: 2 coordinates, expected three: x, y and z",
        ),
        (
            "vertex 1 0 0",
            "vertex 1 0 b",
            ", line 5: `b` is not a number, expected a coordinate",
        ),
        (
            "vertex 1 0 0",
            "",
            ", line 7: a facet has 2 corners, expected three lines of `vertex x y z`",
        ),
        (
            "vertex 1 0 0",
            "endfacet",
            ", line 5: `endfacet` does not belong here, expected `vertex x y z` or `endloop`",
        ),
        (
            "outer loop",
            "outer",
            ", line 3: `nothing` does not belong here, expected `loop`",
        ),
        (
            "endsolid a b",
            "",
            ", line 9: the file ends within a solid, expected `endsolid`",
        ),
        (
            "solid a b",
            "solids",
            ", line 1: `solids` does not belong here, expected `solid`",
        ),
        (
            "solid a b",
            "liquid",
            ": 1869374574 triangles do not fit 109 bytes, expected 84 bytes and 50 for each triangle, \
             or a text that begins with `solid`",
        ),
    ] {
        let text = SOLID.replacen(old, new, 1);
        assert_eq!(
            message(mesh_of("a.stl", text.as_bytes())),
            expected,
            "{new}"
        );
    }
    let empty = ": the file has 0 bytes, expected 84 bytes and 50 for each triangle, \
                 or a text that begins with `solid`";
    assert_eq!(message(mesh_of("a.stl", b"")), empty);
    let mut lying = vec![b' '; 80];
    lying.extend(u32::MAX.to_le_bytes());
    lying.extend([0; 50]);
    let expected = ": 4294967295 triangles do not fit 134 bytes, expected 84 bytes and 50 for each \
                    triangle, or a text that begins with `solid`";
    assert_eq!(message(mesh_of("a.stl", &lying)), expected);
}

#[test]
fn strips_of_ply_become_triangles_of_one_side() {
    let file = |strips: &str, n: usize| {
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n\
             property float z\nelement tristrips 1\nproperty list int int vertex_indices\n\
             end_header\n0 0 0\n0 1 0\n1 0 0\n1 1 0\n2 0 0\n{n} {strips}\n"
        );
        mesh_of("a.ply", text.as_bytes())
    };
    let triangles = |strips: &str, n| file(strips, n).unwrap().triangles;
    assert_eq!(triangles("0 1 2 3 4", 5), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
    assert_eq!(
        triangles("0 1 2 -1 -1 1 3 2 4 -1", 10),
        [[0, 1, 2], [1, 3, 2], [2, 3, 4]]
    );
    assert_eq!(triangles("0 1 2 2 3 3 4", 7), [[0, 1, 2]]);
    let expected = ", line 15: there is no vertex 5, expected one of the 5 vertices, from 0";
    assert_eq!(message(file("0 1 2 5", 4)), expected);
    assert_eq!(
        message(file("0 1", 2)),
        ": no triangle in the file, expected faces"
    );
}
