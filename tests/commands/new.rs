//! `raycost new` writes scenes that render, and a mesh is a scene.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::common::data_set::DataSet;
use crate::common::{assert_success, film, in_repository, parse, raycost};

fn run(folder: &Path, arguments: &[&str]) -> Output {
    raycost()
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

fn text(output: &[u8]) -> String {
    String::from_utf8(output.to_vec()).unwrap()
}

#[test]
fn the_first_scene_renders_and_no_file_is_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let written = run(folder.path(), &["new"]);
    assert_success(&written);
    assert!(text(&written.stdout).ends_with("next    raycost render scene.yaml\n"));
    let scene = fs::read_to_string(folder.path().join("scene.yaml")).unwrap();
    let mut config = parse(&scene);
    (config.image.width, config.image.height) = (64, 40);
    let film = film(&config, 1);
    let objects: std::collections::BTreeSet<i32> = film.values(|strip| &strip.object).collect();
    assert_eq!(
        objects.len(),
        config.objects.len() + 1,
        "each object and the sky is seen"
    );
    let again = run(folder.path(), &["new", "scene.yaml"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(text(&again.stderr).contains("`scene.yaml` exists already"));
    assert_eq!(
        fs::read_to_string(folder.path().join("scene.yaml")).unwrap(),
        scene
    );
    let nowhere = run(folder.path(), &["new", "none/scene.yaml"]);
    assert_eq!(nowhere.status.code(), Some(1), "{nowhere:?}");
}

#[test]
fn a_mesh_is_rendered_as_the_scene_that_new_writes() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("meshes")).unwrap();
    let mesh = folder.path().join("meshes/the cow.obj");
    fs::copy(in_repository("configs/meshes/spot.obj"), &mesh).unwrap();
    let size = ["--width", "60", "--height", "45", "--cost", "none"];
    let rendered = run(
        folder.path(),
        &[&["render", "meshes/the cow.obj", "--out", "a"], &size[..]].concat(),
    );
    assert_success(&rendered);
    let last = text(&rendered.stdout);
    let last = last.trim_end().lines().last().unwrap();
    assert_eq!(
        last,
        "keep    raycost new --mesh 'meshes/the cow.obj' 'the cow.yaml'"
    );
    assert_success(&run(
        folder.path(),
        &["new", "--mesh", "meshes/the cow.obj", "the cow.yaml"],
    ));
    assert_success(&run(
        folder.path(),
        &[&["render", "the cow.yaml", "--out", "b"], &size[..]].concat(),
    ));
    let picture = |out: &str| {
        image::open(folder.path().join(out).join("image.png"))
            .unwrap()
            .to_rgb8()
    };
    assert_eq!(picture("a"), picture("b"));
    // Beside the mesh, and in a folder that does not contain it.
    for file in ["meshes/scene.yaml", "other/scene.yaml"] {
        fs::create_dir_all(folder.path().join(file).parent().unwrap()).unwrap();
        assert_success(&run(
            folder.path(),
            &["new", "--mesh", "meshes/the cow.obj", file],
        ));
        assert_success(&run(folder.path(), &["check", file]));
    }
    let set = [
        "check",
        "meshes/the cow.obj",
        "--set",
        "materials.clai.color=1",
    ];
    assert!(text(&run(folder.path(), &set).stderr).contains("did you mean `clay`?"));
}

/// Returns a binary glTF file with a point light of so many candela at a node of its own.
fn with_light(glb: &[u8], candela: f32, at: [f32; 3]) -> Vec<u8> {
    let word = |at: usize| u32::from_le_bytes(*glb[at..].first_chunk().unwrap()) as usize;
    let (json, rest) = glb[20..].split_at(word(12));
    let mut json: serde_json::Value = serde_json::from_slice(json).unwrap();
    let light = serde_json::json!({ "type": "point", "intensity": candela });
    json["extensionsUsed"] = serde_json::json!(["KHR_lights_punctual"]);
    json["extensions"]["KHR_lights_punctual"]["lights"] = serde_json::json!([light]);
    let of_light = serde_json::json!({ "KHR_lights_punctual": { "light": 0 } });
    let node = serde_json::json!({ "translation": at, "extensions": of_light });
    let nodes = json["nodes"].as_array_mut().unwrap();
    let index = nodes.len();
    nodes.push(node);
    let of_scene = json["scenes"][0]["nodes"].as_array_mut().unwrap();
    of_scene.push(index.into());
    let mut json = json.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = (20 + json.len() + rest.len()) as u32;
    let head = [
        &glb[..8],
        &length.to_le_bytes(),
        &(json.len() as u32).to_le_bytes(),
        b"JSON",
    ];
    [&head.concat(), &json[..], rest].concat()
}

/// However bright they are: programs write anything from 1 to millions of candela.
#[test]
fn the_lights_of_a_mesh_light_its_scene() {
    let folder = tempfile::tempdir().unwrap();
    let lamp = fs::read(in_repository("configs/meshes/lamp.glb")).unwrap();
    let mean = |candela: f32| {
        let lit = with_light(&lamp, candela, [3.0, 4.0, 5.0]);
        fs::write(folder.path().join("lamp.glb"), lit).unwrap();
        let _ = fs::remove_file(folder.path().join("lamp.yaml"));
        assert_success(&run(
            folder.path(),
            &["new", "--mesh", "lamp.glb", "lamp.yaml"],
        ));
        let scene = fs::read_to_string(folder.path().join("lamp.yaml")).unwrap();
        assert!(
            scene.contains(", lights: ") && !scene.contains("key light"),
            "{scene}"
        );
        let small = ["--width", "40", "--height", "30", "--spp", "1"];
        assert_success(&run(
            folder.path(),
            &[&["render", "lamp.yaml", "-o", "lamp.png"], &small[..]].concat(),
        ));
        let picture = image::open(folder.path().join("lamp.png")).unwrap();
        let picture = picture.to_luma8();
        let sum: f64 = picture.pixels().map(|pixel| f64::from(pixel.0[0])).sum();
        sum / f64::from(picture.width() * picture.height())
    };
    let dim = mean(1.0);
    assert!((40.0..220.0).contains(&dim), "{dim}");
    assert!((mean(5e6) / dim - 1.0).abs() < 0.01);
}

/// All vertices are in the picture, whatever the size and the place of the mesh.
#[test]
fn the_camera_sees_all_of_a_mesh() {
    let folder = tempfile::tempdir().unwrap();
    for (scale, shift) in [
        (1.0, [0.0; 3]),
        (1e-4, [0.5, 0.0, -3.0]),
        (1e6, [-1e6, 2e6, 5e5]),
        (0.01, [300_000.123, 4_000_000.456, 0.0]),
    ] {
        let mut obj = String::new();
        for corner in 0..8 {
            let at = |axis: i32| scale * f64::from(corner >> axis & 1) + shift[axis as usize];
            obj += &format!("v {} {} {}\n", at(0), at(1), at(2));
        }
        obj += "f 1 2 4 3\nf 5 6 8 7\nf 1 2 6 5\nf 3 4 8 7\nf 1 3 7 5\nf 2 4 8 6\n";
        fs::write(folder.path().join("cube.obj"), obj).unwrap();
        let source = tools::starter::scene_beside(&folder.path().join("cube.obj"), None).unwrap();
        let name = serde_json::json!(folder.path().join("cube.obj")).to_string();
        let mut config = parse(&source.text().replace("\"cube.obj\"", &name));
        (config.image.width, config.image.height) = (80, 60);
        config.image.samples_per_pixel = 1;
        let objects: Vec<i32> = film(&config, 1).values(|strip| &strip.object).collect();
        let border = objects.iter().enumerate().filter(|(i, _)| {
            let (x, y) = (i % 80, i / 80);
            x == 0 || y == 0 || x == 79 || y == 59
        });
        // The floor, which is seen beside it, is another object.
        assert!(
            border.into_iter().all(|(_, object)| *object != 0),
            "{scale}"
        );
        let n_hits = objects.iter().filter(|object| **object == 0).count();
        assert!((800..3600).contains(&n_hits), "{scale}: {n_hits}");
    }
}

/// The eye is above terrain whose third coordinate is its height, unless `--up` says otherwise.
#[test]
fn low_surfaces_and_stl_stand_upright() {
    let folder = tempfile::tempdir().unwrap();
    let low = "v 0 0 0\nv 9 0 1\nv 0 9 0\nf 1 2 3\n";
    fs::write(folder.path().join("low.obj"), low).unwrap();
    let wall = "v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n";
    fs::write(folder.path().join("wall.obj"), wall).unwrap();
    let facet = "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 9 0 0\nvertex 0 9 9\nendloop\nendfacet\n";
    let stl = format!("solid a\n{facet}endsolid a\n");
    fs::write(folder.path().join("part.stl"), stl).unwrap();
    for (mesh, up, is_turned) in [
        ("low.obj", &[][..], true),
        ("low.obj", &["--up=y"], false),
        ("wall.obj", &[], false),
        ("wall.obj", &["--up=z"], true),
        ("part.stl", &[], true),
    ] {
        let scene = folder.path().join("x.yaml");
        assert_success(&run(
            folder.path(),
            &[&["new", "--mesh", mesh, "x.yaml"], up].concat(),
        ));
        let text = fs::read_to_string(&scene).unwrap();
        assert_eq!(
            text.contains("transform:"),
            is_turned,
            "{mesh}, {up:?}: {text}"
        );
        fs::remove_file(scene).unwrap();
    }
    let flags = [
        "render",
        "low.obj",
        "--width=60",
        "--height=45",
        "--spp=1",
        "--cost=counters",
    ];
    assert_success(&run(folder.path(), &flags));
    let hits = DataSet::read(&folder.path().join("out/low_obj/hits.vtu"));
    let [objects, points] = ["object", "Points"].map(|name| hits.array(name));
    let points: Vec<f32> = points.f32s().collect();
    let of_mesh = objects
        .i32s()
        .zip(points.chunks(3))
        .filter(|(object, _)| *object == 0);
    let (mut n, mut highest) = (0, 0.0_f32);
    for (_, point) in of_mesh {
        highest = highest.max(point[1]);
        n += 1;
    }
    assert!(
        n > 100 && (0.7..1.01).contains(&highest),
        "{n} points up to {highest}"
    );
}

#[cfg(unix)]
#[test]
fn a_scene_that_cannot_be_written_is_not_left_in_part() {
    let folder = tempfile::tempdir().unwrap();
    for blocks in ["0", "1"] {
        let mut shell = Command::new("sh");
        shell.args(["-c", &format!("ulimit -f {blocks}; exec \"$@\""), "sh"]);
        shell
            .arg(raycost().get_program())
            .args(["new", "scene.yaml"]);
        let failed = shell.current_dir(folder.path()).output().unwrap();
        assert_eq!(failed.status.code(), Some(1), "{}", text(&failed.stderr));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "{blocks}");
    }
}

#[test]
fn a_mesh_that_cannot_be_read_gets_its_message() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.obj"), "v 1 x\n").unwrap();
    for (mesh, expected) in [
        ("a.obj", "`a.obj`, line 1: `x` is not a number"),
        ("b.ply", "`b.ply`: cannot read it"),
    ] {
        for arguments in [
            ["render", mesh].as_slice(),
            &["new", "--mesh", mesh, "x.yaml"],
        ] {
            let refused = run(folder.path(), arguments);
            assert_eq!(refused.status.code(), Some(2));
            assert!(
                text(&refused.stderr).contains(expected),
                "{}",
                text(&refused.stderr)
            );
        }
    }
    assert!(!folder.path().join("x.yaml").exists());
}

/// The surface of a data set is rendered, and then the cloud of its hits by their cost.
#[test]
fn what_raycost_writes_is_data_of_another_scene() {
    let folder = tempfile::tempdir().unwrap();
    let data = in_repository("configs/data/elbow.vtu");
    let size = ["--width", "60", "--height", "45", "--also", "surface"];
    let data = data.to_str().unwrap();
    let rendered = run(
        folder.path(),
        &[&["render", data, "--out", "a"], &size[..]].concat(),
    );
    assert_success(&rendered);
    let camera = "image: { width: 60, height: 45 }
camera: { look_at: { eye: [3, 4, 10], target: [1, 0.5, 0], fov_y_deg: 35 } }
materials:
  cost: { color: { array: { name: node_visits, scale: log, range: quantiles } } }
  surface: { color: { array: { name: tests, of: cells } } }
lights: [{ directional: { direction: [0, -1, -1] } }]
objects:
  - spheres: { file: a/hits.vtu, radius: { array: footprint } }
    material: cost
  - mesh: { file: a/surface.vtu }
    material: surface
    transform: [{ translate: [3, 0, 0] }]
";
    fs::write(folder.path().join("cloud.yaml"), camera).unwrap();
    assert_success(&run(folder.path(), &["render", "cloud.yaml", "--out", "b"]));
    let small = ["--width", "40", "--height", "30", "--spp", "1"];
    let points = [&["render", "a/hits.vtu"], &small[..]].concat();
    assert_success(&run(folder.path(), &points));
}

/// A data set whose first array has texts.
const TEXTS: &str = "<VTKFile type='UnstructuredGrid' version='1.0'><UnstructuredGrid>\
    <Piece NumberOfPoints='3' NumberOfCells='1'><PointData>\
    <DataArray type='String' Name='s' format='ascii'>97 0 98 0 99 0</DataArray>\
    <DataArray type='Float64' Name='t' format='ascii'>1 2 3</DataArray></PointData>\
    <Points><DataArray type='Float32' NumberOfComponents='3' format='ascii'>\
    0 0 0 1 0 0 0 1 0</DataArray></Points>\
    <Cells><DataArray type='Int64' Name='connectivity' format='ascii'>0 1 2</DataArray>\
    <DataArray type='Int64' Name='offsets' format='ascii'>3</DataArray>\
    <DataArray type='UInt8' Name='types' format='ascii'>5</DataArray></Cells>\
    </Piece></UnstructuredGrid></VTKFile>";

#[test]
fn tables_series_and_points_are_rendered_by_themselves() {
    let folder = tempfile::tempdir().unwrap();
    let step = |x: f32| {
        format!(
            "# vtk DataFile Version 3.0\nstep\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n\
             {x} 0 0 {x} 1 0 {x} 0 1\nPOLYGONS 1 4\n3 0 1 2\n"
        )
    };
    let list = "<VTKFile type='Collection'><Collection><DataSet timestep='0' file='0.vtk'/>\
                <DataSet timestep='1' file='1.vtk'/></Collection></VTKFile>";
    let cloud = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n\
                 property float z\nend_header\n0 0 0\n1 2 3\n";
    for (name, text) in [("0.vtk", step(0.0)), ("1.vtk", step(9.0))] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    for (name, text, geometry) in [
        (
            "points.csv",
            "X;Y;Z;heat\n0;0;0;1\n1;2;3;4\n",
            "spheres: { file: \"points.csv\", radius: ",
        ),
        (
            "balls.csv",
            "x,y,z,r\n0,0,0,1\n1,2,3,2\n",
            "spheres: { file: \"balls.csv\" }",
        ),
        (
            "lines.csv",
            "x,y,z,line\n0,0,0,a\n1,2,3,a\n",
            "tubes: { file: \"lines.csv\", radius: ",
        ),
        ("steps.pvd", list, "mesh: { file: \"steps.pvd\", "),
        // An array of texts gives no colors: then the scene would not be rendered.
        ("texts.vtu", TEXTS, "mesh: { file: \"texts.vtu\""),
        (
            "cloud.ply",
            cloud,
            "spheres: { file: \"cloud.ply\", radius: ",
        ),
    ] {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        let scene = tools::starter::scene_beside(&path, None).unwrap();
        assert!(scene.text().contains(geometry), "{}", scene.text());
        // The camera sees all time steps.
        let looks_at_the_middle = scene.text().contains("target: [4.5, 0.5, 0.5]");
        assert_eq!(looks_at_the_middle, name == "steps.pvd", "{}", scene.text());
        let small = ["--width", "40", "--height", "30", "--spp", "1", "--no-cost"];
        assert_success(&run(
            folder.path(),
            &[&["render", name], &small[..]].concat(),
        ));
    }
}

/// Identifiers of more than 53 bits, in a table and in a binary file of VTK.
#[test]
fn a_note_says_that_large_integers_are_rounded() {
    let folder = tempfile::tempdir().unwrap();
    for (least, is_noted) in [(1_i64 << 53, true), (1 << 40, false)] {
        let ids = [1, 2, 3].map(|i| least + i);
        let [a, b, c] = ids;
        let table = format!("x,y,z,id\n0,0,0,{a}\n1,0,0,{b}\n0,1,0,{c}\n");
        fs::write(folder.path().join("a.csv"), table).unwrap();
        let mut mesh = b"# vtk DataFile Version 3.0\nids\nBINARY\nDATASET POLYDATA\n\
            POINTS 3 float\n"
            .to_vec();
        let corners = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        mesh.extend(corners.map(f32::to_be_bytes).concat());
        mesh.extend(b"\nPOLYGONS 1 4\n");
        mesh.extend([3_i32, 0, 1, 2].map(i32::to_be_bytes).concat());
        mesh.extend(b"\nPOINT_DATA 3\nSCALARS id vtktypeint64 1\nLOOKUP_TABLE default\n");
        mesh.extend(ids.map(i64::to_be_bytes).concat());
        fs::write(folder.path().join("a.vtk"), mesh).unwrap();
        for geometry in [
            "mesh: { file: a.vtk }",
            "spheres: { file: a.vtk, radius: 0.1 }",
            "spheres: { file: a.csv, radius: 0.1 }",
        ] {
            let scene = format!(
                "image: {{ width: 4, height: 3 }}\n\
                 camera: {{ look_at: {{ eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 40 }} }}\n\
                 lights: []\nmaterials: {{ seen: {{ color: {{ array: {{ name: id }} }} }} }}\n\
                 objects: [{{ {geometry}, material: seen }}]\n"
            );
            fs::write(folder.path().join("a.yaml"), scene).unwrap();
            let checked = run(folder.path(), &["check", "a.yaml"]);
            assert_success(&checked);
            let said = text(&checked.stdout) + &text(&checked.stderr);
            let note = "integers of `id` from 2^53 on are rounded: neighbors may be equal";
            assert_eq!(said.contains(note), is_noted, "{geometry}: {said}");
        }
    }
}

#[test]
fn files_that_cannot_be_shown_are_named_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let lfs = "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n";
    let far = "v 0 0 0\nv 1e19 0 0\nv 0 1 0\nf 1 2 3\n";
    for (name, text, message, help) in [
        (
            "a.yaml",
            lfs,
            "`a.yaml` is a pointer of Git LFS",
            "git lfs pull",
        ),
        (
            "a.msh",
            "",
            "raycost does not read Gmsh files: `a.msh`",
            "meshio convert",
        ),
        (
            "a.xdmf",
            "",
            "raycost does not read XDMF files: `a.xdmf`",
            "ParaView",
        ),
        (
            "a.nii",
            "",
            "raycost does not read NIfTI files: `a.nii`",
            ".vti",
        ),
        (
            "a.off",
            "",
            "raycost does not read OFF files: `a.off`",
            "PLY",
        ),
        (
            "a.obj",
            lfs,
            "`a.obj`: it is a pointer of Git LFS",
            "git lfs pull",
        ),
        (
            "a.csv",
            "a;b\n",
            "`a.csv`, line 1: there is no column `x`",
            "not `a,b`",
        ),
        (
            "far.obj",
            far,
            "`far.obj` has coordinates up to 1e19",
            "a larger unit",
        ),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
        let refused = run(folder.path(), &["render", name]);
        assert_eq!(refused.status.code(), Some(2));
        let said = self::text(&refused.stderr);
        assert!(said.contains(message) && said.contains(help), "{said}");
    }
}

/// Names may have characters that YAML does not have, or that stand for a series of files.
#[cfg(unix)]
#[test]
fn meshes_of_any_name_are_scenes() {
    let folder = tempfile::tempdir().unwrap();
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    for name in [
        "\u{feff}a\u{2028}b\u{85}",
        "\u{fffe}\u{7f}\u{1b}\u{e0001}",
        "a%04d\": #",
    ] {
        let [mesh, scene] = ["obj", "yaml"].map(|ending| format!("{name}.{ending}"));
        fs::write(folder.path().join(&mesh), text).unwrap();
        assert_success(&run(folder.path(), &["new", "--mesh", &mesh, &scene]));
        // A setting makes one text of the scene.
        let checked = run(folder.path(), &["check", &scene, "--set", "image.seed=1"]);
        assert_success(&checked);
    }
}
