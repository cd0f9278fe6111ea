//! The time that a file takes grows with its length, whatever it holds many of.

use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

use cpu_time::ThreadTime;
use import::{
    PlaceArrays, RadiusChoice, read_mesh, read_mesh_with, read_places, read_series, read_spheres,
    read_tubes,
};
use scene::animation;
use scene::build::{Geometries, Timeline};
use scene::config::Config;
use scene::yaml::{Document, Source};
use tools::study::StudyPlan;
use world::material::ArrayChoice;

/// Most doublings of the time for a doubling of the length: between those of `n log n` and of
/// the square, with room for noise.
const MOST_EXPONENT: f64 = 1.5;
/// How often the length is doubled.
const N_DOUBLINGS: u32 = 3;
/// The time from which on it is that of the work.
const LEAST: Duration = Duration::from_millis(4);
/// How many mesh files there are for scenes.
const N_MESHES: usize = 8000;

/// Something that a file may hold many of.
struct Case {
    name: &'static str,
    /// The file with so many.
    file: fn(usize) -> String,
    read: fn(&Path),
}

/// The numbers from 0 on, each in a text.
fn repeated(n: usize, one: impl Fn(usize) -> String) -> String {
    (0..n).map(one).collect()
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const LEGACY: &str = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n\
                      0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 2\nPOINT_DATA 3\n";

const NO_ARRAYS: PlaceArrays = PlaceArrays {
    scale: None,
    orient: None,
    color: None,
};

fn mesh(path: &Path) {
    let _ = read_mesh(path);
}

fn with_array(path: &Path) {
    let array = ArrayChoice::point_array("a0", None);
    read_mesh_with(path, Some(&array)).unwrap();
}

fn document(path: &Path) -> Document {
    Document::new(Source::read(path).unwrap(), Config::MERGING).unwrap()
}

/// Reads a scene, its frames and its files.
fn scene(path: &Path) {
    let document = document(path);
    let config: Config = document.parse().unwrap();
    let Some(timeline) = Timeline::parse(&config, &document).unwrap() else {
        return place(config, &document);
    };
    let still = document.without(animation::KEY).unwrap();
    for frame in 0..timeline.n_frames {
        let animation = &timeline.animation;
        let still = animation.at_frame(&still, frame, timeline.n_frames);
        let config: Config = still.unwrap().parse().unwrap();
        assert!(!config.objects.is_empty());
    }
}

fn place(mut config: Config, document: &Document) {
    let geometries = Geometries::read(&mut config, document, u64::MAX).unwrap();
    scene::build::scene(&config, geometries).unwrap();
}

/// Sets a value of each material that it did not have, and last a wrong one.
fn settings(path: &Path) {
    let mut document = document(path);
    let config: Config = document.parse().unwrap();
    for name in config.materials.keys() {
        let setting = format!("materials.{name}.specular=0.5");
        document.set(&setting).unwrap();
    }
    document.parse::<Config>().unwrap();
    document.set("image.seed=x").unwrap();
    document.parse::<Config>().unwrap_err();
}

fn study(path: &Path) {
    let plan: StudyPlan = Source::read(path).unwrap().parse().unwrap();
    plan.check().unwrap();
    assert_eq!(plan.points().len(), plan.scenes.len());
}

/// A scene of these objects.
fn scene_of(objects: &str) -> String {
    format!(
        "image: {{ width: 8, height: 6 }}\nmaterials: {{ a: {{ color: 1 }} }}\nlights: []\n\
         camera: {{ look_at: {{ eye: [0, 1, 5], target: [0, 0, 0], fov_y_deg: 40 }} }}\n\
         objects:\n{objects}"
    )
}

/// A scene of `n` objects.
fn objects(n: usize) -> String {
    scene_of(&"- { sphere: { center: [0, 0, 0], radius: 1 }, material: a }\n".repeat(n))
}

/// A scene of `n` materials, each with this text.
fn materials(n: usize, text: &str) -> String {
    let all = repeated(n, |i| format!("m{i}: {text}, "));
    objects(1).replace("materials: {", &format!("materials: {{ {all}"))
}

/// Writes the mesh files of scenes, each with its material.
fn write_meshes(folder: &Path) {
    std::fs::write(folder.join("m.mtl"), "newmtl b\nKd 1 1 1\n").unwrap();
    let mesh = format!("mtllib m.mtl\nusemtl b\n{TRIANGLE}f 1 2 3\n");
    for i in 0..N_MESHES {
        std::fs::write(folder.join(format!("m{i}.obj")), &mesh).unwrap();
    }
}

/// XML of VTK with so many arrays of a triangle.
fn arrays(n: usize) -> String {
    let array = |i| format!("<DataArray type='Int8' Name='a{i}' format='ascii'>1 2 3</DataArray>");
    let of = |name: &str, n: usize, kind: &str, text: &str| {
        format!(
            "<DataArray type='{kind}' Name='{name}' NumberOfComponents='{n}' \
             format='ascii'>{text}</DataArray>"
        )
    };
    format!(
        "<VTKFile type='PolyData' byte_order='LittleEndian'><PolyData>\
         <Piece NumberOfPoints='3' NumberOfPolys='1'><PointData>{}</PointData><Points>{}</Points>\
         <Polys>{}{}</Polys></Piece></PolyData></VTKFile>",
        repeated(n, array),
        of("Points", 3, "Float32", "0 0 0 1 0 0 0 1 0"),
        of("connectivity", 1, "Int32", "0 1 2"),
        of("offsets", 1, "Int32", "3"),
    )
}

/// A polyhedron of VTK with so many triangles around its first point.
fn polyhedron(n: usize) -> String {
    let array = |name: &str, kind: &str, n: usize, text: &str| {
        format!(
            "<DataArray type='{kind}' Name='{name}' NumberOfComponents='{n}' \
             format='ascii'>{text}</DataArray>"
        )
    };
    let face = |i| format!("3 0 {} {} ", i + 1, i + 2);
    format!(
        "<VTKFile type='UnstructuredGrid' byte_order='LittleEndian'><UnstructuredGrid>\
         <Piece NumberOfPoints='{}' NumberOfCells='1'><Points>{}</Points>\
         <Cells>{}{}{}{}{}</Cells></Piece></UnstructuredGrid></VTKFile>",
        n + 2,
        array(
            "Points",
            "Float32",
            3,
            &repeated(n + 2, |i| format!("{i} {} 0 ", i * i % 7))
        ),
        array("connectivity", "Int32", 1, "0"),
        array("offsets", "Int32", 1, "1"),
        array("types", "UInt8", 1, "42"),
        array("faces", "Int64", 1, &(format!("{n} ") + &repeated(n, face))),
        array("faceoffsets", "Int64", 1, &(4 * n + 1).to_string()),
    )
}

/// glTF with so many nodes in a row.
fn nodes(n: usize) -> String {
    let node = |i| format!("{{\"children\":[{}]}},", i + 1);
    format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"nodes\":[{}{{}}],\"scenes\":[{{\"nodes\":[0]}}]}}",
        repeated(n, node)
    )
}

const CASES: &[Case] = &[
    Case {
        name: "columns.csv",
        file: |n| {
            format!(
                "x,y,z,r{}\n0,0,0,1{}\n",
                repeated(n, |i| format!(",c{i}")),
                ",1".repeat(n)
            )
        },
        read: |path| drop(read_spheres(path, None, None).unwrap()),
    },
    Case {
        name: "spheres.csv",
        file: |n| "x,y,z,r\n".to_owned() + &"0,0,0,1\n".repeat(n),
        read: |path| drop(read_spheres(path, None, None).unwrap()),
    },
    Case {
        name: "lines.csv",
        file: |n| {
            let point = |i: usize| format!("{},0,0,l{}\n", i % 2, i / 2);
            "x,y,z,line\n".to_owned() + &repeated(2 * n, point)
        },
        read: |path| drop(read_tubes(path, Some(&RadiusChoice::Same(1.0)), None).unwrap()),
    },
    Case {
        name: "places.csv",
        file: |n| "x,y,z\n".to_owned() + &"0,0,0\n".repeat(n),
        read: |path| drop(read_places(path, NO_ARRAYS).unwrap()),
    },
    Case {
        name: "scalars.vtk",
        file: |n| {
            let array = |i| format!("SCALARS a{i} char\nLOOKUP_TABLE default\n1 2 3\n");
            LEGACY.to_owned() + &repeated(n, array)
        },
        read: with_array,
    },
    Case {
        name: "metadata.vtk",
        file: |n| {
            let array = "SCALARS a0 char\nLOOKUP_TABLE default\n1 2 3\n";
            LEGACY.to_owned() + array + &"METADATA\nINFORMATION 0\n\n".repeat(n)
        },
        read: with_array,
    },
    Case {
        name: "fields.vtk",
        file: |n| {
            let array = |i| format!("a{i} 1 3 char\n1 2 3\n");
            format!("{LEGACY}FIELD f {n}\n{}", repeated(n, array))
        },
        read: with_array,
    },
    Case {
        name: "polygons.vtk",
        file: |n| {
            let (head, rest) = LEGACY.split_once("POLYGONS").unwrap();
            let (_, data) = rest.split_once("0 1 2\n").unwrap();
            let polygons = "3 0 1 2\n".repeat(n);
            let scalars = "SCALARS a0 char\nLOOKUP_TABLE default\n1 2 3\n";
            format!("{head}POLYGONS {n} {}\n{polygons}{data}{scalars}", 4 * n)
        },
        read: with_array,
    },
    Case {
        name: "arrays.vtp",
        file: arrays,
        read: with_array,
    },
    Case {
        name: "faces.vtu",
        file: polyhedron,
        read: mesh,
    },
    Case {
        name: "groups.obj",
        file: |n| TRIANGLE.to_owned() + &repeated(n, |i| format!("g g{i}\ns {i}\nf 1 2 3\n")),
        read: mesh,
    },
    Case {
        name: "corners.obj",
        file: |n| format!("{TRIANGLE}f 1{}\n", " 2 3".repeat(n)),
        read: mesh,
    },
    Case {
        name: "continued.obj",
        file: |n| format!("{TRIANGLE}f 1{}\n", " \\\n2 \\\n3".repeat(n)),
        read: mesh,
    },
    Case {
        name: "materials.obj",
        file: |n| TRIANGLE.to_owned() + &"usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n".repeat(n),
        read: mesh,
    },
    Case {
        name: "properties.ply",
        file: |n| {
            let property = |i| format!("property uchar p{i}\n");
            format!(
                "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
                 property float z\n{}element face 1\nproperty list uchar int vertex_indices\n\
                 end_header\n{}3 0 1 2\n",
                repeated(n, property),
                format!("0 0 0{}\n", " 1".repeat(n)).repeat(3)
            )
        },
        read: mesh,
    },
    Case {
        name: "facets.stl",
        file: |n| {
            let facet = |i| {
                format!(
                    "facet normal 0 0 1\nouter loop\nvertex 0 0 {i}\nvertex 1 0 0\nvertex 0 1 0\n\
                     endloop\nendfacet\n"
                )
            };
            format!("solid a\n{}endsolid a\n", repeated(n, facet))
        },
        read: mesh,
    },
    Case {
        name: "nodes.gltf",
        file: nodes,
        read: mesh,
    },
    Case {
        name: "steps.pvd",
        file: |n| {
            let step = |i| format!("<DataSet timestep='{i}' file='f{i}.vtu'/>");
            format!(
                "<VTKFile type='Collection'><Collection>{}</Collection></VTKFile>",
                repeated(n, step)
            )
        },
        read: |path| drop(read_series(Path::new(""), path)),
    },
    Case {
        name: "objects.yaml",
        file: objects,
        read: scene,
    },
    Case {
        name: "materials.yaml",
        file: |n| materials(n, "{ color: 1 }"),
        read: scene,
    },
    Case {
        name: "lights.yaml",
        file: |n| {
            let lights = "{ point: { position: [4, 7, 5], color: 1, intensity: 1 } }, ".repeat(n);
            objects(1).replace("lights: []", &format!("lights: [{lights}]"))
        },
        read: scene,
    },
    Case {
        name: "meshes of one file.yaml",
        file: |n| scene_of(&"- { mesh: { file: m0.obj }, material: a }\n".repeat(n)),
        read: scene,
    },
    Case {
        name: "meshes of many files.yaml",
        file: |n| {
            let mesh = |i| format!("- {{ mesh: {{ file: m{i}.obj }}, material: a }}\n");
            scene_of(&repeated(n, mesh))
        },
        read: scene,
    },
    Case {
        name: "meshes with their materials.yaml",
        file: |n| scene_of(&"- { mesh: { file: m0.obj } }\n".repeat(n)),
        read: scene,
    },
    Case {
        name: "settings.yaml",
        file: |n| materials(n, "{ color: 1 }"),
        read: settings,
    },
    Case {
        name: "keyframes of materials.yaml",
        file: |n| {
            let keyframe = |i| format!("    materials.m{i}.color: [{{ frame: 0, value: 1 }}]\n");
            let keyframes = repeated(n, keyframe);
            let scene = materials(n, "{ color: 1 }");
            format!("{scene}animation:\n  frames: 1\n  keyframes:\n{keyframes}")
        },
        read: scene,
    },
    Case {
        name: "fly_through.yaml",
        file: |n| {
            let scene = objects(1);
            let eyes = repeated(n, |i| format!("[{i}, {}, 6], ", i % 3));
            format!("{scene}animation: {{ frames: {n}, fly_through: {{ eyes: [{eyes}] }} }}\n")
        },
        read: scene,
    },
    Case {
        name: "study.yaml",
        file: |n| {
            let scenes = repeated(n, |i| format!("s/{i}.yaml, "));
            format!("title: Many\nscenes: [{scenes}]\n")
        },
        read: study,
    },
    Case {
        name: "keyframes.yaml",
        file: |n| {
            let mut text = objects(n) + "animation:\n  frames: 2\n  keyframes:\n";
            for i in 0..n {
                let path = format!("objects[{i}].sphere.radius");
                writeln!(text, "    {path}: [{{ frame: 0, value: 1 }}]").unwrap();
            }
            text
        },
        read: scene,
    },
];

/// The least time of several tries.
fn time(path: &Path, case: &Case) -> Duration {
    let once = || {
        let start = ThreadTime::now();
        (case.read)(path);
        start.elapsed()
    };
    (0..3).map(|_| once()).min().unwrap()
}

/// The exponent of the growth of the time by the length.
fn exponent(folder: &Path, case: &Case) -> f64 {
    let path = folder.join(case.name);
    let of = |n: usize| {
        std::fs::write(&path, (case.file)(n)).unwrap();
        time(&path, case)
    };
    let mut n = 1000;
    let mut short = of(n);
    while short < LEAST {
        n *= 2;
        short = of(n);
    }
    let long = of(n << N_DOUBLINGS);
    (long.as_secs_f64() / short.as_secs_f64()).log2() / f64::from(N_DOUBLINGS)
}

/// By the time of this thread, since a table that is searched from its start for each of its
/// rows counts nothing. The square of the number has an exponent of 2.
#[test]
#[ignore = "measures the time of threads; a part of tests/all"]
fn the_time_of_a_file_grows_with_its_length() {
    let folder = tempfile::tempdir().unwrap();
    write_meshes(folder.path());
    let grows = |case: &&Case| {
        // Once more where something else disturbed it.
        (0..3).all(|_| exponent(folder.path(), case) > MOST_EXPONENT)
    };
    let slow: Vec<&str> = CASES.iter().filter(grows).map(|case| case.name).collect();
    assert!(slow.is_empty(), "the time grows too fast: {slow:?}");
}
