//! Meshes with colors and materials of their own.

use std::path::Path;

use glam::Vec3;
use import::{Finish, read_mesh_with_materials};
use scene::build::Geometries;
use scene::config::Config;
use tracer::accel::Accel;
use tracer::cost::{NoProbe, RayKind};
use tracer::trace::Tracer;
use world::geometry::{Ray, RenderSpace};
use world::scene::Scene;

use crate::common::parse;

/// The scene of some objects, whose files are in `folder`.
fn scene(folder: &Path, rest: &str) -> Scene {
    let mut config = parse(&format!(
        "image: {{ width: 4000, height: 3000 }}\n\
         camera: {{ look_at: {{ eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 40 }} }}\n\
         lights: []\n{rest}"
    ));
    let geometries = Geometries::read(&mut config, folder, u64::MAX).unwrap();
    // Rays are given in world space.
    scene::build::scene_in_space(&config, geometries, RenderSpace::default()).unwrap()
}

/// The color of the surface that a ray along -z meets.
fn color_at(scene: &Scene, [x, y]: [f32; 2]) -> Vec3 {
    let accel = Accel::new(scene, Default::default());
    let ray = Ray {
        origin: Vec3::new(x, y, 9.0),
        direction: -Vec3::Z,
    };
    let point = Tracer::new(scene, &accel).trace(&ray, RayKind::Camera, &mut NoProbe);
    point.unwrap().color
}

fn assert_near(found: Vec3, expected: Vec3) {
    let difference = (found - expected).abs().max_element();
    assert!(difference < 0.01, "{found}, expected {expected}");
}

/// A triangle with colors of this type at its vertices: red, black and half of the light of
/// blue, as displays take it.
pub fn ply(kind: &str, [full, half]: [&str; 2]) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
         property float z\nproperty {kind} red\nproperty {kind} green\nproperty {kind} blue\n\
         property {kind} alpha\nelement face 1\nproperty list uchar int vertex_indices\n\
         end_header\n0 0 0 {full} 0 0 {full}\n1 0 0 0 0 0 {full}\n0 1 0 0 0 {half} {full}\n3 0 1 2\n"
    )
}

#[test]
fn colors_of_vertices_are_interpolated_as_light() {
    let folder = tempfile::tempdir().unwrap();
    let obj = "v 0 0 0 1 0 0\nv 1 0 0 0 0 0\nv 0 1 0 0 0 0.735357\nf 1 2 3\n".to_owned();
    for (name, text) in [
        ("bytes.ply", ply("uchar", ["255", "188"])),
        ("words.ply", ply("ushort", ["65535", "48192"])),
        ("floats.ply", ply("float", ["1", "0.735357"])),
        ("mesh.obj", obj),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
        let scene = scene(
            folder.path(),
            &format!(
                "materials: {{ own: {{ color: vertex_colors }} }}\n\
                 objects: [{{ mesh: {{ file: {name} }}, material: own }}]\n"
            ),
        );
        for [x, y] in [[0.1, 0.1], [0.2, 0.5], [0.7, 0.2]] {
            let found = color_at(&scene, [x, y]);
            let expected = Vec3::new(1.0 - x - y, 0.0, 0.5 * y);
            assert!(
                (found - expected).abs().max_element() < 0.002,
                "{name}: {found} {expected}"
            );
        }
    }
}

#[test]
fn colors_out_of_range_are_refused_in_ply_and_none_in_obj() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        import::read_mesh(&path)
    };
    let fault = read("a.ply", &ply("float", ["255", "0"]))
        .unwrap_err()
        .to_string();
    assert!(
        fault.ends_with("line 14: a color is 255, expected numbers from 0 to 1"),
        "{fault}"
    );
    let some = "v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0 1 1 1\nf 1 2 3\n";
    for text in [some, &some.replace("v 1 0 0", "v 1 0 0 255 0 0")] {
        assert_eq!(read("a.obj", text).unwrap().colors, None);
    }
}

/// A chair of a wooden seat, whose picture is left red and right blue, and a leg of glass.
const CHAIR: &str = "mtllib wood and glass.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n\
    v 0 0 1\nv 0.5 0 1\nv 0 0.5 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
    usemtl seat\nf 1/1 2/2 3/3 4/4\nusemtl leg\nf 5 6 7\nusemtl unused\n";

const MATERIALS: &str = "# of a chair\nnewmtl seat\nKd 0.5 1 1\nKs 0.3 0.2 0.1\nNs 90\n\
    illum 2\nmap_Kd -clamp on wood.png\nnewmtl leg\n\tKd 0 0 0\n\tillum 6\n\tNi 1.4\n\
    newmtl unused\nKe 2 2 2\n";

/// Writes the files of the chair.
fn write_chair(folder: &Path) {
    std::fs::write(folder.join("chair.obj"), CHAIR).unwrap();
    std::fs::write(folder.join("wood and glass.mtl"), MATERIALS).unwrap();
    let color = |x, _| image::Rgb([255 * u8::from(x == 0), 0, 255 * u8::from(x == 1)]);
    image::RgbImage::from_fn(2, 2, color)
        .save(folder.join("wood.png"))
        .unwrap();
}

#[test]
fn a_mesh_without_a_material_has_those_of_its_file() {
    let folder = tempfile::tempdir().unwrap();
    write_chair(folder.path());
    let mesh = "objects: [{ mesh: { file: chair.obj } }]\n";
    for model in ["blinn_phong", "path", "seed"] {
        let rest = format!("shading: {{ model: {model} }}\nmaterials: {{}}\n{mesh}");
        let scene = scene(folder.path(), &rest);
        assert_eq!((scene.n_objects(), scene.materials.len()), (2, 2));
        assert_near(color_at(&scene, [-0.5, 0.0]), Vec3::new(0.5, 0.0, 0.0));
        assert_near(color_at(&scene, [0.6, 0.0]), Vec3::Z);
        let [seat, leg] = &scene.materials[..] else {
            unreachable!()
        };
        assert_eq!((seat.specular, seat.exponent), (0.3, 90.0));
        let index = leg.kind.medium().map(|medium| medium.index);
        assert_eq!(index, (model != "seed").then_some(1.4), "{model}");
    }
    let own = "materials: { red: { color: [1, 0, 0] } }\n";
    let given = mesh.replace(" }]", ", material: red }]");
    let scene = scene(folder.path(), &format!("{own}{given}"));
    assert_eq!(scene.n_objects(), 1);
    assert_near(color_at(&scene, [0.6, 0.0]), Vec3::X);
}

/// `Kd` multiplies the light of the picture, not its bytes.
#[test]
fn a_dark_factor_of_a_picture_is_not_rounded_to_bytes() {
    let folder = tempfile::tempdir().unwrap();
    write_chair(folder.path());
    let dark = MATERIALS.replace("Kd 0.5 1 1", "Kd 0.0131 1 0.00027");
    std::fs::write(folder.path().join("wood and glass.mtl"), dark).unwrap();
    let mesh = "materials: {}\nobjects: [{ mesh: { file: chair.obj } }]\n";
    let scene = scene(folder.path(), mesh);
    for (x, share) in [(-0.5, 0.0), (0.25, 0.75), (0.75, 1.0)] {
        let expected = Vec3::new(0.0131 * (1.0 - share), 0.0, 0.00027 * share);
        let error = color_at(&scene, [x, -0.7]) - expected;
        assert!(error.abs().max_element() < 1e-7, "{error}");
    }
}

/// Programs write `Ns 0` for a surface without a highlight, and `Tr 1` for an opaque one.
#[test]
fn numbers_that_would_blind_or_hide_a_surface_are_read_as_meant() {
    let folder = tempfile::tempdir().unwrap();
    write_chair(folder.path());
    let dull = "an `Ns` below 1 is read as no highlight: write `Ns 1` for a wide one";
    let opaque = "`Tr 1` without `d` is read as opaque: write `d 0` for an invisible one";
    for (statements, specular, opacity, doubts) in [
        ("Ns 0\nTr 1", 0.0, 1.0, &[opaque, dull][..]),
        ("Ns 0.5\nd 1\nTr 1", 0.0, 1.0, &[dull]),
        ("Ns 0\nKs 0 0 0\nTr 0", 0.0, 1.0, &[]),
        ("Ns 20\nTr 0.25", 0.3, 0.75, &[]),
        ("Ns 20\nTr 0.25\nd 0.5", 0.3, 0.5, &[]),
    ] {
        let library = MATERIALS.replace("Ns 90", statements);
        std::fs::write(folder.path().join("wood and glass.mtl"), library).unwrap();
        let mesh = read_mesh_with_materials(&folder.path().join("chair.obj"), 1 << 20).unwrap();
        let seat = &mesh.materials[0];
        let Finish::Highlight {
            specular: found, ..
        } = seat.finish
        else {
            unreachable!("{:?}", seat.finish)
        };
        let factor = seat.opacity.as_ref().map_or(1.0, |of| of.factor);
        assert_eq!((found, factor), (specular, opacity), "{statements}");
        assert_eq!(seat.transmission, 0.0, "{statements}");
        let doubts = doubts.iter();
        let mut expected: Vec<_> = doubts.map(|of| format!("material `seat`: {of}")).collect();
        expected.sort();
        assert_eq!(mesh.notes, expected, "{statements}");
    }
    let both = MATERIALS
        .replace("Ns 90", "Tr 1")
        .replace("illum 6", "Tr 1");
    std::fs::write(folder.path().join("wood and glass.mtl"), both).unwrap();
    let object = "mesh: { file: chair.obj }";
    let twice = format!("materials: {{}}\nobjects: [{{ {object} }}, {{ {object} }}]\n");
    let scene = scene(folder.path(), &twice);
    let expected = format!("chair.obj: 2 materials, such as `seat`: {opaque}");
    assert_eq!(scene.notes, [expected]);
}

/// An image of 27 points, all of whose numbers are `outside` but that of the point in the middle.
fn image_with(middle: f32, outside: f32) -> String {
    let numbers = (0..27).map(|i| if i == 13 { middle } else { outside });
    let numbers: Vec<String> = numbers.map(|number| number.to_string()).collect();
    format!(
        "<VTKFile type='ImageData' byte_order='LittleEndian'>\
         <ImageData WholeExtent='0 2 0 2 0 2' Origin='0 0 0' Spacing='1 1 1'>\
         <Piece Extent='0 2 0 2 0 2'><PointData><DataArray type='Float32' Name='t' \
         format='ascii'>{}</DataArray></PointData></Piece></ImageData></VTKFile>",
        numbers.join(" ")
    )
}

/// ParaView's range is that of the whole data set: the surface shows none of the extremes.
#[test]
fn the_range_of_data_is_that_of_all_blocks_and_of_their_interior() {
    let folder = tempfile::tempdir().unwrap();
    let blocks = "<VTKFile type='vtkMultiBlockDataSet'><vtkMultiBlockDataSet>\
                  <DataSet index='0' file='a.vti'/><DataSet index='1' file='b.vti'/>\
                  </vtkMultiBlockDataSet></VTKFile>";
    for (name, text) in [
        ("a.vti", image_with(-7.0, 1.0)),
        ("b.vti", image_with(9.0, 0.5)),
        ("both.vtm", blocks.to_owned()),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    for (file, rest, expected) in [
        ("a.vti", "", [-7.0, 1.0]),
        ("both.vtm", "", [-7.0, 9.0]),
        ("both.vtm", ", range: data", [-7.0, 9.0]),
        ("both.vtm", ", scale: log", [0.5, 9.0]),
        ("both.vtm", ", range: quantiles", [0.5, 1.0]),
    ] {
        let text = format!(
            "materials: {{ field: {{ color: {{ array: {{ name: t{rest} }} }} }} }}\n\
             objects: [{{ mesh: {{ file: {file} }}, material: field }}]\n"
        );
        let scene = scene(folder.path(), &text);
        let texture = scene.materials[0].color.array().unwrap();
        assert_eq!(texture.table.ends, expected, "{file}{rest}");
    }
}

/// The config of some objects, with the parts of their files.
fn config_with(folder: &Path, rest: &str) -> Config {
    let mut config = parse(&format!(
        "image: {{ width: 4, height: 3 }}\n\
         camera: {{ look_at: {{ eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 40 }} }}\n\
         lights: []\n{rest}"
    ));
    Geometries::read(&mut config, folder, u64::MAX).unwrap();
    config
}

#[test]
fn parts_of_a_mesh_are_objects_with_names() {
    let folder = tempfile::tempdir().unwrap();
    write_chair(folder.path());
    let config = config_with(
        folder.path(),
        "materials: { red: { color: [1, 0, 0] }, chair.obj/leg: { color: 0 } }\n\
         objects:\n  - { sphere: { center: [0, 0, 9], radius: 1 }, material: red }\n  \
         - { mesh: { file: chair.obj } }\n  - { name: other, mesh: { file: chair.obj } }\n",
    );
    let names: Vec<_> = config.object_labels().collect();
    let expected = [
        "sphere 0",
        "chair.obj/seat",
        "chair.obj/leg 2",
        "other/seat",
        "other/leg",
    ];
    assert_eq!(names, expected);
    let materials: Vec<_> = config.materials.keys().map(String::as_str).collect();
    let expected = [
        "red",
        "chair.obj/leg",
        "chair.obj/seat",
        "chair.obj/leg 2",
        "chair.obj/seat 2",
        "chair.obj/leg 3",
    ];
    assert_eq!(materials, expected);
}

/// `o` names the faces below it, or `g` in a file without `o`; the picture is that without names.
#[test]
fn objects_of_an_obj_file_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    write_chair(folder.path());
    let objects = "materials: {}\nobjects: [{ mesh: { file: chair.obj } }]\n";
    let whole = scene(folder.path(), objects);
    let faces = ["usemtl seat\nf 1/1 2/2 3/3 4/4\n", "usemtl leg\nf 5 6 7\n"];
    let turned = "usemtl seat\nf 4/4 3/3 2/2 1/1\n";
    let [seat, leg] = faces;
    let names = |text: &str, objects: &str| {
        std::fs::write(folder.path().join("chair.obj"), text).unwrap();
        let config = config_with(folder.path(), objects);
        assert!(config.materials.len() <= 2);
        config.object_labels().collect::<Vec<_>>()
    };
    let vertices = &CHAIR[..CHAIR.find("usemtl").unwrap()];
    for (faces, expected) in [
        // Sorted by material.
        (
            format!("g default\no top\n{seat}g x\no post\n{leg}o low\n{turned}"),
            &["chair.obj/top", "chair.obj/low", "chair.obj/post"][..],
        ),
        (
            format!("g top\n{seat}{leg}g\n{turned}"),
            &["chair.obj/seat", "chair.obj/top/seat", "chair.obj/top/leg"],
        ),
        (format!("o the chair\n{seat}"), &["chair.obj/the chair"]),
        (seat.to_owned(), &["mesh 0"]),
    ] {
        assert_eq!(names(&format!("{vertices}{faces}"), objects), expected);
    }
    let two = format!("{vertices}o a\n{seat}o b\n{turned}");
    let named = objects.replace("mesh:", "name: old, mesh:");
    assert_eq!(names(&two, &named), ["old/a", "old/b"]);
    let given = named
        .replace(" }]", ", material: red }]")
        .replace("{}", "{ red: { color: 1 } }");
    assert_eq!(names(&two, &given), ["old"]);
    let many = (0..4097)
        .map(|i| format!("o {i}\nf 1 2 3\n"))
        .collect::<String>();
    assert_eq!(names(&format!("{vertices}{many}"), objects), ["mesh 0"]);
    let read = read_mesh_with_materials(&folder.path().join("chair.obj"), 1 << 20).unwrap();
    let expected = "its 4097 objects are counted as one: at most 4096 are kept apart";
    assert!(
        read.notes.iter().any(|note| note == expected),
        "{:?}",
        read.notes
    );
    let named = format!("{vertices}o top\n{seat}o post\n{leg}");
    std::fs::write(folder.path().join("chair.obj"), named).unwrap();
    let named = scene(folder.path(), objects);
    let shapes =
        |of: &Scene| -> Vec<_> { of.primitives.iter().map(|of| of.parameters()).collect() };
    assert_eq!(shapes(&named), shapes(&whole));
}

/// The notes on a chair one of whose files has another text.
fn notes_of(name: &str, old: &str, new: &str) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    write_chair(folder.path());
    let path = folder.path().join(name);
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains(old), "{old}");
    std::fs::write(&path, text.replacen(old, new, 1)).unwrap();
    let mesh = read_mesh_with_materials(&folder.path().join("chair.obj"), 1 << 20).unwrap();
    assert_eq!(mesh.triangles.len(), 3);
    let place = folder.path().display().to_string() + "/";
    let notes = mesh.notes.iter();
    notes.map(|note| note.replace(&place, "")).collect()
}

#[test]
fn a_mistake_in_materials_is_noted_with_file_and_line() {
    let library = "wood and glass.mtl";
    for (file, old, new, expected) in [
        (
            "chair.obj",
            "usemtl leg",
            "usemtl lag",
            "left out: materials that no `mtllib` has (1, `lag` in line 15)",
        ),
        (
            library,
            "Ns 90",
            "Ns ninety",
            "left out: damaged statements of materials (1, line 5 of `wood and glass.mtl`)",
        ),
        (
            library,
            "Kd 0.5 1 1",
            "Kd 0.5 nan",
            "left out: damaged statements of materials (1, line 3 of `wood and glass.mtl`)",
        ),
        (
            library,
            "-clamp on wood.png",
            "-clamp on",
            "left out: damaged statements of materials (1, line 7 of `wood and glass.mtl`)",
        ),
        (
            library,
            "wood.png",
            "chair.obj",
            "shown without `chair.obj`: it is not a picture of a known format, \
             expected a PNG, JPEG, Radiance HDR or OpenEXR picture",
        ),
    ] {
        assert_eq!(notes_of(file, old, new), [expected], "{new}");
    }
    for (file, old, new) in [
        (library, "wood.png", "gone.png"),
        ("chair.obj", "mtllib wood and", "mtllib no"),
    ] {
        let notes = notes_of(file, old, new);
        let first = format!(
            "shown without `{}`: cannot read it: ",
            new.split(' ').next_back().unwrap()
        );
        assert!(notes[0].starts_with(&first), "{notes:?}");
    }
}

/// Files from Windows, whose names differ in case, and those whose picture was moved.
#[test]
fn pictures_are_found_in_any_case_and_beside_the_mesh() {
    for (name, file) in [
        ("wood.png", "Wood.PNG"),
        (r"Tex\WOOD.png", "tex/wood.png"),
        (r"C:\me\tex\wood.png", "wood.png"),
        ("/home/me/wood.png", "wood.PNG"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        write_chair(folder.path());
        let moved = folder.path().join("moved.png");
        std::fs::rename(folder.path().join("wood.png"), &moved).unwrap();
        std::fs::create_dir(folder.path().join("tex")).unwrap();
        std::fs::rename(moved, folder.path().join(file)).unwrap();
        let library = MATERIALS.replace("wood.png", name);
        std::fs::write(folder.path().join("wood and glass.mtl"), library).unwrap();
        let mesh = read_mesh_with_materials(&folder.path().join("chair.obj"), 1 << 20).unwrap();
        assert_eq!(mesh.notes, [""; 0], "{name}");
        assert!(mesh.materials[0].picture.is_some(), "{name}");
    }
}

/// `-s` scales and `-o` moves texture coordinates, as in three.js, assimp and Blender.
#[test]
fn options_of_a_picture_mirror_and_move_it() {
    let folder = tempfile::tempdir().unwrap();
    write_chair(folder.path());
    let rest = "materials: {}\nobjects: [{ mesh: { file: chair.obj } }]\n";
    let [red, blue] = [Vec3::new(0.5, 0.0, 0.0), Vec3::Z];
    for (options, left, right) in [
        ("", red, blue),
        ("-s -1 1 1", blue, red),
        ("-o 0.5 0 0", blue, red),
        ("-o -0.25 0 -s 2", red, red),
    ] {
        let library = MATERIALS.replace("-clamp on", options);
        std::fs::write(folder.path().join("wood and glass.mtl"), library).unwrap();
        let scene = scene(folder.path(), rest);
        assert_near(color_at(&scene, [-0.5, 0.8]), left);
        assert_near(color_at(&scene, [0.5, 0.8]), right);
    }
}

/// MeshLab and trimesh show the picture of `TextureFile`.
#[test]
fn pictures_of_ply_are_materials() {
    let folder = tempfile::tempdir().unwrap();
    write_chair(folder.path());
    let ply = "ply\nformat ascii 1.0\ncomment TextureFile Wood.png\ncomment TextureFile gone.png\n\
        element vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n\
        property list uchar int vertex_indices\nproperty list uchar float texcoord\n\
        property int texnumber\nend_header\n-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n\
        3 0 1 2 6 0 0 1 0 1 1 0\n3 0 2 3 0 1\n";
    std::fs::write(folder.path().join("a.ply"), ply).unwrap();
    let scene = scene(
        folder.path(),
        "materials: {}\nobjects: [{ mesh: { file: a.ply } }]\n",
    );
    assert_near(color_at(&scene, [-0.5, -0.8]), Vec3::X);
    assert_near(color_at(&scene, [0.5, -0.8]), Vec3::Z);
    assert_near(color_at(&scene, [-0.5, 0.8]), Vec3::splat(0.8));
    let [note] = &scene.notes[..] else {
        unreachable!("{:?}", scene.notes)
    };
    assert!(note.contains("gone.png"), "{note}");
}

#[test]
fn damaged_materials_never_panic() {
    for seed in 0..200_usize {
        let folder = tempfile::tempdir().unwrap();
        write_chair(folder.path());
        for (name, step) in [
            ("chair.obj", 13),
            ("wood and glass.mtl", 7),
            ("wood.png", 3),
        ] {
            let path = folder.path().join(name);
            let mut bytes = std::fs::read(&path).unwrap();
            let at = step * seed % bytes.len();
            match seed % 3 {
                0 => bytes.truncate(at),
                _ => bytes[at] ^= 1 << (seed % 8),
            }
            let whole = std::fs::read(&path).unwrap();
            std::fs::write(&path, bytes).unwrap();
            let mesh = folder.path().join("chair.obj");
            match import::read_mesh_with_materials(&mesh, 1 << 20) {
                Ok(mesh) => {
                    let (_, parts) = mesh.into_parts();
                    assert!(parts.iter().all(|part| !part.mesh.triangles.is_empty()));
                }
                Err(fault) => {
                    let fault = fault.to_string();
                    let is_named = [name, "chair.obj"].iter().any(|of| fault.contains(of));
                    assert!(is_named, "{fault}");
                }
            }
            std::fs::write(&path, whole).unwrap();
        }
    }
}

/// Two triangles of VTK, with colors at the points and of the cells, as bytes and as fractions.
const COLORED: &str = "# vtk DataFile Version 3.0\ncolors\nASCII\nDATASET POLYDATA\n\
    POINTS 4 float\n0 0 0 1 0 0 0 1 0 1 1 0\nPOLYGONS 2 8\n3 0 1 2\n3 1 3 2\n\
    POINT_DATA 4\nSCALARS seen unsigned_char 3\nLOOKUP_TABLE default\n\
    255 0 0 0 188 0 0 0 255 255 255 255\n\
    CELL_DATA 2\nFIELD cells 2\nshare 4 2 float\n1 0.735357 0 1 0 0 1 0.5\none 1 2 float\n0 1\n";

#[test]
fn arrays_of_vtk_may_be_colors_of_surfaces_and_spheres() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.vtk"), COLORED).unwrap();
    let with = |array: &str, object: &str| {
        let rest = format!(
            "materials: {{ own: {{ color: {{ vertex_colors: {{ array: {array} }} }} }} }}\n\
             objects: [{{ {object}, material: own }}]\n"
        );
        scene(folder.path(), &rest)
    };
    let surface = "mesh: { file: a.vtk }";
    assert_near(
        color_at(&with("seen", surface), [0.2, 0.5]),
        Vec3::new(0.3, 0.1, 0.5),
    );
    let cells = with("share, of: cells", surface);
    assert_near(color_at(&cells, [0.2, 0.5]), Vec3::new(1.0, 0.5, 0.0));
    assert_near(color_at(&cells, [0.8, 0.5]), Vec3::Z);
    let grains = with("seen", "spheres: { file: a.vtk, radius: 0.3 }");
    assert_near(color_at(&grains, [1.0, 0.0]), Vec3::new(0.0, 0.5, 0.0));
}
