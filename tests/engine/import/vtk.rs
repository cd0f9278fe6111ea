//! VTK's files: what VTK wrote is read as VTK reads it, and what is damaged is refused.

use std::path::{Path, PathBuf};
use std::process::Command;

use glam::Vec3;
use import::{FileFault, Mesh, RadiusChoice, read_mesh, read_mesh_with, read_points, read_spheres};
use world::material::{ArrayChoice, ArrayOf};

use super::{message, reading};
use crate::common::{assert_success, in_repository};

/// The numbers of an array as VTK shows them by default.
fn choice(name: &str) -> ArrayChoice {
    ArrayChoice {
        is_color: false,
        name: name.to_owned(),
        component: None,
        of: None,
    }
}

fn area(mesh: &Mesh) -> f64 {
    let area = |triangle: &[u32; 3]| {
        let [a, b, c] = mesh
            .triangle(*triangle)
            .vertices
            .map(|vertex| vertex.as_dvec3());
        0.5 * (b - a).cross(c - a).length()
    };
    mesh.triangles.iter().map(area).sum()
}

/// The least and the greatest number of an array on the surface.
fn range(path: &Path, name: &str) -> [f64; 2] {
    let mesh = read_mesh_with(path, Some(&choice(name))).unwrap_or_else(|fault| panic!("{fault}"));
    let scalars = mesh.scalars.unwrap();
    assert_eq!(scalars.triangles.len(), mesh.triangles.len());
    let corners = scalars.triangles.iter().flatten();
    let values = corners.map(|&corner| scalars.values[corner as usize]);
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
        [low.min(x), high.max(x)]
    })
}

#[test]
#[ignore = "needs VTK: tests/with-paraview"]
fn surfaces_are_those_that_vtk_sees() {
    let python = std::env::var("RAYCOST_PYTHON").expect("run tests/with-paraview");
    let folder = tempfile::tempdir().unwrap();
    let script = in_repository("tests/vtk/data_sets.py");
    let output = Command::new(python)
        .arg(script)
        .arg(folder.path())
        .output()
        .unwrap();
    assert_success(&output);
    let lines = String::from_utf8(output.stdout).unwrap();
    for line in lines.lines() {
        let expected: serde_json::Value = serde_json::from_str(line).unwrap();
        let numbers = |value: &serde_json::Value| -> Vec<f64> {
            value
                .as_array()
                .unwrap()
                .iter()
                .map(|x| x.as_f64().unwrap())
                .collect()
        };
        let file = folder.path().join(expected["file"].as_str().unwrap());
        let near = |found: &[f64], expected: &[f64], what: &str| {
            for (found, expected) in found.iter().zip(expected) {
                let error = (found - expected).abs();
                assert!(
                    error <= 1e-5 * (1.0 + expected.abs()),
                    "{what} of {file:?}: {found} {expected}"
                );
            }
        };
        let mesh = read_mesh(&file).unwrap_or_else(|fault| panic!("{fault}"));
        let corners = || {
            mesh.triangles
                .iter()
                .flatten()
                .map(|i| mesh.vertices[*i as usize])
        };
        let [low, high] = [
            corners().fold(Vec3::MAX, Vec3::min),
            corners().fold(Vec3::MIN, Vec3::max),
        ];
        near(
            &low.as_dvec3().to_array(),
            &numbers(&expected["low"]),
            "the lower end",
        );
        near(
            &high.as_dvec3().to_array(),
            &numbers(&expected["high"]),
            "the upper end",
        );
        near(
            &[area(&mesh)],
            &[expected["area"].as_f64().unwrap()],
            "the area",
        );
        for (name, of_array) in expected["ranges"].as_object().unwrap() {
            near(&range(&file, name), &numbers(of_array), name);
        }
        assert!(lines.lines().count() > 300 && expected["ranges"].as_object().unwrap().len() == 3);
    }
}

/// Small files of VTK, in all formats, with their numbers of triangles.
const FILES: [(&str, usize); 13] = [
    ("block_binary_51.vtk", 48),
    ("block_lz4.vtu", 48),
    ("block_zlib.vtu", 48),
    ("cells_ascii.vtu", 94),
    ("curvilinear_binary_42.vtk", 104),
    ("curvilinear_raw.vts", 104),
    ("image_base64.vti", 224),
    ("polygons_ascii_42.vtk", 7),
    ("polygons_inline.vtp", 7),
    ("polyhedra_ascii.vtu", 18),
    ("polyhedra_old.vtu", 18),
    ("rectilinear_ascii_51.vtk", 104),
    ("rectilinear_zlib.vtr", 104),
];

fn of_vtk(name: &str) -> Vec<u8> {
    std::fs::read(in_repository("tests/files/vtk").join(name)).unwrap()
}

fn read(name: &str, bytes: &[u8], array: &ArrayChoice) -> Result<Mesh, FileFault> {
    reading(name, bytes, |path| read_mesh_with(path, Some(array)))
}

#[test]
fn each_format_gives_its_triangles() {
    for (name, n) in FILES {
        let mesh =
            read(name, &of_vtk(name), &choice("speed")).unwrap_or_else(|fault| panic!("{fault}"));
        assert_eq!(mesh.triangles.len(), n, "{name}");
        assert_eq!(mesh.scalars.unwrap().triangles.len(), n, "{name}");
    }
    let [a, b, c] =
        [0, 1, 2].map(|i| area(&read(FILES[i].0, &of_vtk(FILES[i].0), &choice("number")).unwrap()));
    assert!((a - b).abs() < 1e-6 && (a - c).abs() < 1e-6);
}

/// Neither a file that ends early nor one with a wrong byte causes a panic or an index out
/// of range, and none takes much memory.
#[test]
fn damaged_files_are_refused_or_meshes() {
    for (name, _) in FILES {
        let whole = of_vtk(name);
        for place in 0..200 {
            let at = whole.len() * place / 200;
            let mut wrong = [whole.clone(), whole.clone(), whole.clone()];
            wrong[0].truncate(at);
            wrong[1][at] ^= 0xff;
            wrong[2][at] = b'9';
            for bytes in wrong {
                let array = choice(["speed", "number"][place % 2]);
                if let Ok(mesh) = read(name, &bytes, &array) {
                    let corners = mesh.triangles.as_flattened();
                    assert!(corners.iter().all(|i| (*i as usize) < mesh.vertices.len()));
                    assert!(mesh.vertices.iter().all(|vertex| vertex.is_finite()));
                }
            }
        }
    }
}

/// Nor does a damaged file of pieces or blocks, whatever files it names then.
#[test]
fn damaged_files_of_pieces_are_refused_or_meshes() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.vtu"), tetrahedron()).unwrap();
    let pieces = "<VTKFile type='PUnstructuredGrid' byte_order='LittleEndian'>\
        <PUnstructuredGrid GhostLevel='0'><PPoints><PDataArray type='Float32'/></PPoints>\
        <Piece Source='a.vtu'/><Piece Source='a.vtu'/></PUnstructuredGrid></VTKFile>";
    let blocks = "<VTKFile type='vtkMultiBlockDataSet'><vtkMultiBlockDataSet>\
        <Block index='0'><DataSet index='0' file='a.vtu'/></Block>\
        <DataSet index='1' file='a.vtu'/></vtkMultiBlockDataSet></VTKFile>";
    for (name, whole) in [("a.pvtu", pieces), ("a.vtm", blocks)] {
        let path = folder.path().join(name);
        let read = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            read_mesh_with(&path, Some(&choice("rank")))
        };
        assert_eq!(read(whole.as_bytes()).unwrap().triangles.len(), 8);
        for at in 0..whole.len() {
            let mut wrong = [whole.as_bytes().to_vec(), whole.as_bytes().to_vec()];
            wrong[0].truncate(at);
            wrong[1][at] ^= 0x10;
            for bytes in wrong {
                if let Ok(mesh) = read(&bytes) {
                    assert!([4, 8].contains(&mesh.triangles.len()));
                }
            }
        }
    }
    #[cfg(unix)]
    {
        let path = folder.path().join("a.pvtu");
        std::fs::write(&path, pieces.replace("'a.vtu'", "'/dev/zero'")).unwrap();
        let fault = read_mesh(&path).unwrap_err().to_string();
        assert!(fault.contains("`/dev/zero`: it is not a file"), "{fault}");
    }
}

/// A tetrahedron with an array of points and one of cells.
fn tetrahedron() -> String {
    let array = |kind: &str, name: &str, n: usize, values: &str| {
        format!(
            "<DataArray type='{kind}' Name='{name}' NumberOfComponents='{n}' format='ascii'>{values}</DataArray>"
        )
    };
    format!(
        "<?xml version='1.0'?><VTKFile type='UnstructuredGrid' byte_order='LittleEndian'>\
         <UnstructuredGrid><Piece NumberOfPoints='4' NumberOfCells='1'>\
         <PointData>{}</PointData><CellData>{}</CellData><Points>{}</Points><Cells>{}{}{}</Cells>\
         </Piece></UnstructuredGrid></VTKFile>",
        array("Float32", "velocity", 2, "3 4 0 0 nan 0 1 1"),
        array("Int32", "rank", 1, "7"),
        array("Float32", "Points", 3, "0 0 0 1 0 0 0 1 0 0 0 1"),
        array("Int64", "connectivity", 1, "0 1 2 3"),
        array("Int64", "offsets", 1, "4"),
        array("UInt8", "types", 1, "10"),
    )
}

#[test]
#[expect(clippy::too_many_lines, reason = "one table of cases")]
fn each_mistake_of_a_vtk_file_is_reported() {
    let whole = tetrahedron();
    let velocity = choice("velocity");
    let table = [
        (
            "1 2 3</",
            "1 2 4</",
            ", cell 0: there is no point 4, expected one of the 4 points, of which the first is 0",
        ),
        (
            "0 1 2 3<",
            "0 1 2<",
            ", cell 0: its corners end at 4 of 3, expected at 0 or later",
        ),
        (
            ">4<",
            ">3<",
            ", cell 0: it has 3 points, expected at least 4",
        ),
        (">10<", ">99<", ", cell 0: it is of the type 99, expected "),
        (
            ">10<",
            ">42<",
            ", cell 0: it is a polyhedron without faces, expected ",
        ),
        (
            ">10<",
            "><",
            ": the array `types` has 0 numbers, expected 1 times 1",
        ),
        (
            "3 4 0 0 nan 0 1 1",
            "3 4 0 0 nan 0",
            ": the array `velocity` has 6 numbers, expected 4 times 2",
        ),
        (
            "3 4 0 0 nan 0 1 1",
            "3 4 0",
            ": the array `velocity` has 3 numbers, expected a multiple of its 2 components",
        ),
        (
            "3 4 0 0",
            "3 x 0 0",
            ": the array `velocity`: `x` is not a number, expected a number",
        ),
        (
            "0 0 1</",
            "0 0 inf</",
            ", point 3: a coordinate is inf, expected finite numbers",
        ),
        (
            "velocity",
            "velocities",
            ": it has no array `velocity`, did you mean `velocities`?, expected one of its arrays, such as `velocities` or `rank`",
        ),
        (
            "Float32",
            "Float16",
            ": the array `velocity`: it has values of the type `Float16`, expected numbers of 8 to 64 bits",
        ),
        (
            "='ascii'",
            "='text'",
            ": the array `velocity`: its format is `text`, expected ascii, binary or appended",
        ),
        (
            "'LittleEndian'",
            "'LittleEndian' compressor='zip'",
            ": its arrays are compressed by `zip`, expected vtkZLibDataCompressor, vtkLZ4DataCompressor or none",
        ),
        ("</VTKFile>", "", ": it ends early, expected a whole file"),
        (
            "type='Unstruct",
            "type='Struct",
            ": it has no data set of the type `StructuredGrid`, expected an element VTKFile and its data set",
        ),
        (
            "<?xml",
            "xml",
            ": it is not a VTK file, although its name ends in `.vtu`, expected `# vtk DataFile Version` or `<VTKFile` at the start of the file",
        ),
        (
            ">10<",
            ">1<",
            ": no triangle in the file, expected faces of cells; points are for `spheres`, lines for `tubes`",
        ),
    ];
    read("a.vtu", whole.as_bytes(), &velocity).unwrap();
    for (from, to, expected) in table {
        assert!(whole.contains(from), "{from}");
        let found = message(read(
            "a.vtu",
            whole.replacen(from, to, 1).as_bytes(),
            &velocity,
        ));
        assert!(
            found.starts_with(expected),
            "{from} {to}\n{found}\n{expected}"
        );
    }
}

#[test]
fn an_array_gives_components_and_magnitudes() {
    let whole = tetrahedron();
    let scalars = |array: &ArrayChoice| {
        read("a.vtu", whole.as_bytes(), array).map(|mesh| mesh.scalars.unwrap())
    };
    let velocity = choice("velocity");
    let magnitudes = scalars(&velocity).unwrap().values;
    assert_eq!(
        [magnitudes[0], magnitudes[1], magnitudes[3]],
        [5.0, 0.0, 2.0_f64.sqrt()]
    );
    assert!(magnitudes[2].is_nan());
    let second = ArrayChoice {
        component: Some(1),
        ..velocity.clone()
    };
    assert_eq!(scalars(&second).unwrap().values, [4.0, 0.0, 0.0, 1.0]);
    assert_eq!(scalars(&choice("rank")).unwrap().values, [7.0; 4]);
    let none = String::from_utf8(of_vtk("polygons_ascii_42.vtk")).unwrap();
    let none = none.replace("speed 3 ", "speed 0 ");
    assert!(read("a.vtk", none.as_bytes(), &choice("speed")).is_err());
    let third = ArrayChoice {
        component: Some(2),
        ..velocity.clone()
    };
    assert_eq!(
        message(scalars(&third)),
        ": `velocity` has no component 2, expected one of its 2, of which the first is 0"
    );
    let of_cells = ArrayChoice {
        of: Some(ArrayOf::Cells),
        ..velocity
    };
    assert_eq!(
        message(scalars(&of_cells)),
        ": it has no array of cells `velocity`, expected one of its arrays, such as `rank`"
    );
}

/// A file of pieces, and one that names what is not there.
#[test]
fn pieces_are_read_beside_their_file() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| -> PathBuf {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    write("a.vtu", &tetrahedron());
    let of = |pieces: &str| {
        format!(
            "<VTKFile type='PUnstructuredGrid'><PUnstructuredGrid>{pieces}</PUnstructuredGrid></VTKFile>"
        )
    };
    let two = write(
        "two.pvtu",
        &of("<Piece Source='a.vtu'/><Piece Source='a.vtu'/>"),
    );
    let mesh = read_mesh_with(&two, Some(&choice("velocity"))).unwrap();
    assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (8, 8));
    assert_eq!(mesh.scalars.unwrap().triangles, mesh.triangles);
    let circle = write("circle.pvtu", &of("<Piece Source='circle.pvtu'/>"));
    let fault = read_mesh(&circle).unwrap_err().to_string();
    assert!(
        fault.ends_with(
            "it is a piece, and consists of pieces, expected pieces that have their data themselves"
        ),
        "{fault}"
    );
    let missing = write("missing.pvtu", &of("<Piece Source='b.vtu'/>"));
    let fault = read_mesh(&missing).unwrap_err().to_string();
    assert!(fault.contains("b.vtu`: cannot read it"), "{fault}");
}

/// Blocks of an assembly have what each has; the rest of the surface has no number there.
#[test]
fn pieces_without_an_array_have_missing_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let other = tetrahedron().replace("'velocity'", "'heat'");
    std::fs::write(folder.path().join("a.vtu"), tetrahedron()).unwrap();
    std::fs::write(folder.path().join("b.vtu"), other).unwrap();
    let path = folder.path().join("both.vtm");
    let blocks = "<Block index='0'><DataSet index='0' file='a.vtu'/>\
                  <DataSet index='1' file='b.vtu'/></Block>";
    let text = format!(
        "<VTKFile type='vtkMultiBlockDataSet'><vtkMultiBlockDataSet>{blocks}\
         </vtkMultiBlockDataSet></VTKFile>"
    );
    std::fs::write(&path, text).unwrap();
    for (name, first, second) in [("velocity", 5.0, f32::NAN), ("heat", f32::NAN, 5.0)] {
        let mesh = read_mesh_with(&path, Some(&choice(name))).unwrap();
        let scalars = mesh.scalars.unwrap();
        for (i, expected) in [(0, first), (4, second)] {
            let corner = scalars.triangles[i].map(|corner| scalars.values[corner as usize]);
            let found = corner.contains(&5.0);
            assert_eq!(found, expected == 5.0, "{name}: {corner:?}");
            assert_eq!(corner.iter().all(|x| x.is_nan()), expected.is_nan());
        }
        let radius = RadiusChoice::Same(1.0);
        let spheres = read_points(&path, &radius, Some(&choice(name))).unwrap();
        assert_eq!(spheres.scalars.unwrap().len(), 8);
    }
    let fault = read_mesh_with(&path, Some(&choice("mass"))).unwrap_err();
    let fault = fault.to_string();
    assert!(fault.contains("it has no array `mass`"), "{fault}");
}

#[test]
fn bits_are_numbers_of_legacy_files() {
    let head = |kind: &str| {
        format!("# vtk DataFile Version 3.0\nt\n{kind}\nDATASET POLYDATA\nPOINTS 9 unsigned_char\n")
    };
    let coordinates: Vec<u8> = (0..9_u8).flat_map(|i| [i, i * i, 1]).collect();
    let last = "POINT_DATA 9\nSCALARS a bit\nLOOKUP_TABLE default\n";
    let words = |numbers: &[u8]| {
        let words: Vec<String> = numbers.iter().map(u8::to_string).collect();
        words.join(" ") + "\n"
    };
    let cell = "POLYGONS 1 10\n";
    let corners: Vec<u8> = [9].into_iter().chain(0..9).collect();
    let bits = [1, 0, 1, 1, 0, 0, 0, 1, 1];
    let text = [
        head("ASCII"),
        words(&coordinates),
        cell.to_owned(),
        words(&corners),
    ]
    .concat()
        + last
        + &words(&bits);
    let mut binary = head("BINARY").into_bytes();
    binary.extend(&coordinates);
    binary.extend(cell.as_bytes());
    binary.extend(corners.iter().flat_map(|i| i32::from(*i).to_be_bytes()));
    binary.extend(last.as_bytes());
    binary.extend([0b1011_0001, 0b1000_0000]);
    for bytes in [text.as_bytes(), &binary[..]] {
        let mesh = read("a.vtk", bytes, &choice("a")).unwrap();
        assert_eq!(mesh.scalars.unwrap().values, bits.map(f64::from));
    }
}

/// The text of an image of two by two cells, with arrays of its points and its cells.
fn squares(of_points: &str, of_cells: &str) -> String {
    format!(
        "<VTKFile type='ImageData' byte_order='LittleEndian'>\
         <ImageData WholeExtent='0 2 0 2 0 0' Origin='0 0 0' Spacing='1 1 1'><Piece Extent='0 2 0 2 0 0'>\
         <PointData>{of_points}</PointData><CellData>{of_cells}</CellData>\
         </Piece></ImageData></VTKFile>"
    )
}

/// As vtkGeometryFilter does; copies of other pieces' points hide nothing.
#[test]
fn a_hidden_point_hides_its_cells() {
    for (ghosts, expected) in [
        ("0 0 0 0 0 0 0 0 0", 4.0),
        ("2 0 0 0 0 0 0 0 0", 3.0),
        ("0 2 0 0 0 0 0 0 0", 2.0),
        ("1 1 1 1 1 1 1 1 1", 4.0),
        ("0 0 0 0 0 0 0 3 0", 2.0),
    ] {
        let array = format!(
            "<DataArray type='UInt8' Name='vtkGhostType' format='ascii'>{ghosts}</DataArray>"
        );
        let mesh = reading("a.vti", squares(&array, "").as_bytes(), read_mesh).unwrap();
        assert!(
            (area(&mesh) - expected).abs() < 1e-6,
            "{ghosts}: {}",
            area(&mesh)
        );
    }
}

/// Eight values a byte, the first one in the highest bit, or words.
#[test]
fn arrays_of_bits_are_numbers() {
    let of_cells = |format: &str, text: &str| {
        let array =
            format!("<DataArray type='Bit' Name='flag' format='{format}'>{text}</DataArray>");
        let text = squares("", &array);
        read("a.vti", text.as_bytes(), &choice("flag")).map(|mesh| mesh.scalars.unwrap().values)
    };
    let pairs = |values: Vec<f64>| [0, 2, 4, 6].map(|triangle| values[triangle]);
    assert_eq!(
        pairs(of_cells("ascii", "1 0 1 1").unwrap()),
        [1.0, 0.0, 1.0, 1.0]
    );
    // A length of one byte, and the byte.
    assert_eq!(
        pairs(of_cells("binary", "AQAAAA==sA==").unwrap()),
        [1.0, 0.0, 1.0, 1.0]
    );
    assert!(
        of_cells("binary", "AgAAALCw").is_err(),
        "four cells have one byte"
    );
}

/// Pressures, dates and identifiers: as numbers of 32 bits, they would be equal.
#[test]
fn numbers_keep_their_64_bits() {
    for (numbers, kind) in [
        (
            [101_325.01, 101_325.015, 2_460_310.5, 1_700_000_018.25],
            "Float64",
        ),
        (
            [
                20_000_001.0,
                20_000_003.0,
                16_777_217.0,
                -9_007_199_254_740_991.0,
            ],
            "Int64",
        ),
    ] {
        let text = numbers.map(|number| number.to_string()).join(" ");
        let array = format!("<DataArray type='{kind}' Name='a' format='ascii'>{text}</DataArray>");
        let mesh = read("a.vti", squares("", &array).as_bytes(), &choice("a")).unwrap();
        let values = mesh.scalars.unwrap().values;
        assert_eq!([0, 2, 4, 6].map(|triangle| values[triangle]), numbers);
        let rows = numbers.map(|number| format!("0,0,{number},{number}"));
        let table = format!("x,y,z,a\n{}\n", rows.join("\n"));
        let read_table = |path: &Path| {
            read_spheres(
                path,
                Some(&RadiusChoice::Same(1.0)),
                Some(&ArrayChoice::point_array("a", None)),
            )
        };
        let spheres = reading("a.csv", table.as_bytes(), read_table).unwrap();
        assert_eq!(spheres.scalars.unwrap(), numbers);
    }
}

/// A U of area 8: as a fan its triangles would cover 14.
#[test]
fn concave_faces_of_cells_have_their_area() {
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
    let points = |z: i32| u.map(|[x, y]| format!("{x} {y} {z} ")).concat();
    let array = |kind: &str, name: &str, n: usize, text: &str| {
        format!(
            "<DataArray type='{kind}' Name='{name}' NumberOfComponents='{n}' format='ascii'>{text}</DataArray>"
        )
    };
    let polygon = format!(
        "<VTKFile type='PolyData'><PolyData><Piece NumberOfPoints='8' NumberOfPolys='1'><Points>{}</Points><Polys>{}{}</Polys></Piece></PolyData></VTKFile>",
        array("Float32", "Points", 3, &points(0)),
        array("Int64", "connectivity", 1, "0 1 2 3 4 5 6 7"),
        array("Int64", "offsets", 1, "8"),
    );
    let mesh = reading("a.vtp", polygon.as_bytes(), read_mesh).unwrap();
    assert!((area(&mesh) - 8.0).abs() < 1e-5);
    let sides: String = (0..8)
        .map(|i| format!("4 {i} {} {} {} ", (i + 1) % 8, (i + 1) % 8 + 8, i + 8))
        .collect();
    let prism = format!(
        "<VTKFile type='UnstructuredGrid'><UnstructuredGrid><Piece NumberOfPoints='16' NumberOfCells='1'><Points>{}</Points><Cells>{}{}{}{}{}</Cells></Piece></UnstructuredGrid></VTKFile>",
        array("Float32", "Points", 3, &(points(0) + &points(1))),
        array(
            "Int64",
            "connectivity",
            1,
            "0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15"
        ),
        array("Int64", "offsets", 1, "16"),
        array("UInt8", "types", 1, "42"),
        array(
            "Int64",
            "faces",
            1,
            &format!("10 8 7 6 5 4 3 2 1 0 8 8 9 10 11 12 13 14 15 {sides}")
        ),
        array("Int64", "faceoffsets", 1, "59"),
    );
    let mesh = reading("a.vtu", prism.as_bytes(), read_mesh).unwrap();
    // Two faces, and a height of 1 along a border of 18.
    assert!((area(&mesh) - 34.0).abs() < 1e-4, "{}", area(&mesh));
}
