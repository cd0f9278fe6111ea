//! ParaView loads the states without an error or a warning, and shows what the camera
//! sees. Screenshots remain in `target/paraview/` for inspection.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use image::imageops::{self, FilterType};
use image::{Rgb, RgbImage};

use crate::common::data_set::DataSet;
use crate::common::paraview::{
    NOTHING, folder, load, load_own, read, render, scene_file, screenshot, state,
};
use crate::common::{assert_success, in_repository, raycost};

/// A picture with fewer pixels than the scene's own, where their number does not matter: ParaView takes less time.
const SMALL: [&str; 2] = ["--width=200", "--height=150"];

/// The states of a rendering with all tables.
const STATES: [&str; 6] = [
    "geometry", "heatmap", "overview", "schedule", "surface", "bvh",
];

/// A scene far from the origin, taller than wide, without symmetry.
const TOWER: &str = "
image: { width: 240, height: 360, samples_per_pixel: 2 }
camera:
  look_at: { eye: [1003, 260, -2990], target: [1000, 252, -3000], fov_y_deg: 45 }
background:
  gradient: { bottom: [0.9, 0.8, 0.6], top: [0.2, 0.4, 0.9] }
materials:
  stone: { color: [0.5, 0.5, 0.45] }
  brick: { color: [0.7, 0.2, 0.1] }
  gold: { color: [0.9, 0.7, 0.1], specular: 0.8, reflection: 0.3 }
lights:
  - directional: { direction: [-1, -2, -1] }
objects:
  - box: { min: [996, 248, -3004], max: [1004, 249, -2996] }
    material: stone
  - box: { min: [997.5, 249, -3001], max: [999.5, 253.5, -2999] }
    material: brick
  - sphere: { center: [998.5, 254.3, -3000], radius: 0.8 }
    material: gold
  - sphere: { center: [1001.5, 249.7, -2999], radius: 0.7 }
    material: brick
";

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn the_extended_scene_is_shown() {
    let scene = in_repository("configs/seed_extended.yaml");
    shows_its_output(&render(&scene, "extended", &[]), "time_ns");
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn counters_without_a_time_are_shown() {
    let scene = in_repository("configs/seed_extended.yaml");
    let out = render(
        &scene,
        "counters",
        &[&SMALL[..], &["--cost=counters"]].concat(),
    );
    shows_its_output(&out, "node_visits");
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn counters_of_brute_force_are_shown() {
    let tower = format!("{TOWER}acceleration: brute_force\ncost: counters\n");
    let out = render(&scene_file("brute", &tower), "brute force", &[]);
    shows_its_output(&out, "primitive_tests");
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn the_tower_is_shown() {
    shows_its_output(
        &render(&scene_file("tower", TOWER), "tower", &[]),
        "time_ns",
    );
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn an_orthographic_view_is_shown() {
    let scene = in_repository("configs/orthographic_grid.yaml");
    let size = ["--width=350", "--height=350"];
    shows_its_output(&render(&scene, "orthographic", &size), "time_ns");
}

/// The states of the folder load by their own paths, with this array of the
/// cost, and the cloud looks like the picture.
fn shows_its_output(out: &Path, cost: &str) {
    let states = ["geometry", "heatmap", "overview"];
    for state in states {
        assert!(read(out, state).contains(cost));
    }
    let arrays = format!("{cost},RGB");
    load_own(out, &states.map(|state| (state, &*arrays)));
    assert_likeness(out);
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn compressed_files_are_shown() {
    let scene = in_repository("configs/seed_extended.yaml");
    for codec in ["lz4", "zlib"] {
        let out = render(
            &scene,
            codec,
            &[&SMALL[..], &["--compress", codec]].concat(),
        );
        shows_its_output(&out, "time_ns");
    }
}

/// A picture that is larger than the memory that it may use.
#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn pieces_are_shown() {
    let scene = in_repository("configs/seed_extended.yaml");
    let flags = ["--memory=60M", "--width=600", "--height=500", "--spp=1"];
    let out = render(&scene, "pieces", &flags);
    assert!(out.join("frame.pvti").exists());
    let arrays = "time_ns,RGB";
    let states = ["geometry", "heatmap", "overview"].map(|state| (state, arrays));
    load_own(&out, &states);
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn what_things_cost_is_shown() {
    let flat = TOWER.to_owned() + "output: [surface, bvh: { max_depth: 0 }]\n";
    let outputs = [
        // Three spheres, and a mesh without any.
        (
            "charged spheres",
            in_repository("configs/seed_extended.yaml"),
            None,
        ),
        (
            "charged mesh",
            in_repository("configs/spot.yaml"),
            Some("--cost=counters"),
        ),
        ("charged root", scene_file("flat", &flat), None),
    ];
    for (name, scene, cost) in outputs {
        let mut flags = [&SMALL[..], &["--also=surface,bvh"]].concat();
        flags.extend(cost);
        let out = render(&scene, name, &flags);
        for state in ["surface", "bvh"] {
            let is_timed = cost.is_none() && !(state == "bvh" && name == "charged root");
            let text = read(&out, state);
            assert_eq!(text.contains("time_ns*"), is_timed, "{name}, {state}");
        }
        let [surface, bvh] = ["wasted_tests,radius", "wasted_visits,RGB"];
        load_own(&out, &[("surface", surface), ("bvh", bvh)]);
    }
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn noise_and_efficiency_are_shown_if_files_have_no_other_cost() {
    let scene = in_repository("configs/cornell_box.yaml");
    let arrays = "--set=output={ also: [noise], arrays: [RGB, noise, efficiency] }";
    let flags = [&SMALL[..], &["--spp=16", arrays]].concat();
    let out = render(&scene, "noise", &flags);
    let text = read(&out, "heatmap");
    assert!(text.contains("log10(max(noise,") && text.contains("Efficiency of the samples"));
    load_own(&out, &[("heatmap", "noise,efficiency")]);
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn idle_lanes_are_shown_beside_the_cost() {
    let scene = in_repository("configs/glass.yaml");
    let out = render(&scene, "lanes", &[&SMALL[..], &["--also=lanes"]].concat());
    load_own(&out, &[("heatmap", "time_ns,idle_lanes")]);
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn a_state_without_measured_cost_shows_the_distance() {
    let scene = in_repository("configs/seed_extended.yaml");
    let out = render(&scene, "no cost", &[&SMALL[..], &["--no-cost"]].concat());
    assert!(read(&out, "geometry").contains("Distance from the camera"));
    load_own(&out, &[("geometry", "distance,RGB")]);
    assert_likeness(&out);
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn a_state_of_no_hits_loads() {
    let out = render(&scene_file("nothing", NOTHING), "nothing", &[]);
    let file = out.join("geometry.pvsm");
    let flags = ["--from-state", "--allow-empty"];
    let state = state(&file, &out, &screenshot(&out, "geometry"), &flags);
    assert_success(&load(&out, &[state]));
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn a_diff_is_shown() {
    for (cost, array) in [("time", "time_ns"), ("counters", "primitive_tests")] {
        let cost = format!("--cost={cost}");
        let out = diff(&format!("diff {array}"), &[&cost]);
        assert!(read(&out, "diff").contains(&format!("{array}_ratio")));
        let require = format!("--require={array}_difference,{array}_ratio");
        // The template, too.
        let template = in_repository("paraview/diff.pvsm");
        let states = [
            (out.join("diff.pvsm"), "diff"),
            (template, "diff by variable"),
        ];
        let states = states.map(|(file, name)| {
            let flags = ["--from-state", &require];
            state(&file, &out, &screenshot(&out, name), &flags)
        });
        // It shows times.
        let n = if array == "time_ns" { 2 } else { 1 };
        assert_success(&load(&out, &states[..n]));
    }
}

/// The diff of two outputs of a scene, the second without a hierarchy.
fn diff(name: &str, arguments: &[&str]) -> PathBuf {
    let grid = "
  - sphere_grid: { counts: [5, 5, 5], min: [997, 250, -3004], max: [1003, 254, -3002], radius: 0.2 }
    material: gold
";
    let [a, b] = ["bvh", "brute_force"].map(|acceleration| {
        let scene = format!("{TOWER}{}acceleration: {acceleration}\n", &grid[1..]);
        let file = scene_file(acceleration, &scene);
        let arguments = [&["--width=120", "--height=180"], arguments].concat();
        render(&file, &format!("{name} {acceleration}"), &arguments)
    });
    let out = folder("out ü & co").join(name);
    let output = raycost()
        .arg("diff")
        .args([&a, &b])
        .arg("--out")
        .arg(&out)
        .output();
    assert_success(&output.unwrap());
    out
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn the_schedule_is_shown() {
    let tower = scene_file("schedule", TOWER);
    for (name, flags) in [
        ("schedule", ["--tile-order=cost", "--threads=3"]),
        // Taller than wide, and a tile that is larger than the picture.
        ("one tile", ["--tile-size=256", "--height=250"]),
        (
            "schedule without cost",
            ["--tile-order=hilbert", "--no-cost"],
        ),
    ] {
        let out = render(&tower, name, &[&["--also=schedule"], &flags[..]].concat());
        load_own(&out, &[("schedule", "RGB,duration_ns,thread,start_ns")]);
    }
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn the_repositorys_states_show_any_output() {
    let scene = in_repository("configs/seed_extended.yaml");
    let flags = [&SMALL[..], &["--also=schedule,surface,bvh"]].concat();
    let out = render(&scene, "repository", &flags);
    let states = STATES.iter().flat_map(|name| {
        let file = in_repository("paraview").join(name).with_extension("pvsm");
        // The paths begin with the variable RAYCOST_OUT, which `load` sets, unless a folder is chosen.
        [("variable", &["--from-state"][..]), ("folder", &[])].map(|(by, flags)| {
            let picture = screenshot(&out, &format!("{name} by {by}"));
            state(&file, &out, &picture, flags)
        })
    });
    assert_success(&load(&out, &states.collect::<Vec<_>>()));
}

/// `adopt.py` makes templates that are an output's states, and keep their marks.
#[test]
#[ignore = "needs Python: run tests/with-paraview"]
fn templates_adopt_the_values_of_an_output() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().canonicalize().unwrap().join("out");
    let output = raycost()
        .arg("render")
        .arg(in_repository("configs/seed_extended.yaml"))
        .args(SMALL)
        .args(["--also=schedule,surface,bvh", "--quiet", "--out"])
        .arg(&out)
        .output();
    assert_success(&output.unwrap());
    let states = STATES.map(|name| format!("{name}.pvsm"));
    let repository = in_repository("paraview");
    for name in states.iter().map(String::as_str).chain(["adopt.py"]) {
        fs::copy(repository.join(name), folder.path().join(name)).unwrap();
    }
    let python = std::env::var("RAYCOST_PYTHON").expect("run tests/with-paraview");
    let script = folder.path().join("adopt.py");
    assert_success(&Command::new(python).arg(script).arg(&out).output().unwrap());
    for name in states {
        let read = |folder: &Path| fs::read_to_string(folder.join(&name)).unwrap();
        let (adopted, marks) = without_marks(&read(folder.path()));
        assert_eq!(marks, without_marks(&read(&repository)).1, "{name}");
        let state = read(&out).replace(out.to_str().unwrap(), "$RAYCOST_OUT");
        // Behind the run's ID; not all lines are indented.
        let lines = state.lines().skip(1).map(str::trim_start);
        assert!(adopted.lines().map(str::trim_start).eq(lines), "{name}");
    }
}

/// A template without its marks, and the marks.
fn without_marks(template: &str) -> (String, Vec<String>) {
    let mut parts = template.split(" fill=\"");
    let (mut text, mut marks) = (parts.next().unwrap().to_owned(), Vec::new());
    for (mark, rest) in parts.map(|part| part.split_once('"').unwrap()) {
        marks.push(mark.to_owned());
        text += rest;
    }
    (text, marks)
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn a_moved_folder_is_found_by_its_new_name_alone() {
    let before = render(&scene_file("moved", TOWER), "before the move", &[]);
    let out = before.with_file_name("moved");
    let _ = fs::remove_dir_all(&out);
    fs::rename(before, &out).unwrap();
    let file = out.join("heatmap.pvsm");
    let picture = screenshot(&out, "heatmap");
    let load = |flags: &[&str]| load(&out, &[state(&file, &out, &picture, flags)]);
    let by_old_name = load(&["--from-state"]);
    assert_eq!(by_old_name.status.code(), Some(1));
    let text = String::from_utf8_lossy(&by_old_name.stdout);
    assert!(text.contains("FAIL frame.vti: there is no file"), "{text}");
    assert_success(&load(&[]));
}

/// ParaView 5.12 and later opens `image.png` as a state.
#[test]
fn the_picture_carries_the_geometry_state() {
    let out = render(&scene_file("carried", TOWER), "carried", &[]);
    let picture = fs::File::open(out.join("image.png")).unwrap();
    let reader = png::Decoder::new(std::io::BufReader::new(picture))
        .read_info()
        .unwrap();
    let chunks = &reader.info().uncompressed_latin1_text;
    let text_of = |keyword| {
        let mut found = chunks.iter().filter(|chunk| chunk.keyword == keyword);
        let chunk = found.next().unwrap_or_else(|| panic!("no {keyword}"));
        assert!(found.next().is_none(), "{keyword} twice");
        chunk.text.as_str()
    };
    let run = format!("<!-- raycost_run={} -->\n", text_of("raycost_run"));
    let state = fs::read_to_string(out.join("geometry.pvsm")).unwrap();
    assert_eq!(state.matches(&run).count(), 1);
    // With names in the place of paths.
    let folder = format!("{}/", out.display());
    let folder = folder.replace('&', "&amp;").replace('ü', "&#252;");
    let is_carried = text_of("ParaViewState") == state.replace(&run, "").replace(&folder, "");
    assert!(is_carried, "the text is not geometry.pvsm");
}

/// The screenshot's cloud in its own colors is the picture, and neither its
/// mirror image nor the same upside down.
fn assert_likeness(out: &Path) {
    let picture = hits_on_white(&DataSet::read(&out.join("frame.vti")));
    let screenshot = image::open(screenshot(out, "geometry")).unwrap().to_rgb8();
    // The left one of two views, without its caption.
    let [width, height] = [screenshot.width(), screenshot.height()];
    let view = imageops::crop_imm(
        &screenshot,
        0,
        height / 12,
        width / 2 - 10,
        height * 10 / 12,
    )
    .to_image();
    let [picture, view] = [picture, view].map(|picture| cells(&picture));
    let same = difference(&view, &picture);
    let mirrored = difference(&view, &imageops::flip_horizontal(&picture));
    let upside_down = difference(&view, &imageops::flip_vertical(&picture));
    println!(
        "{}: {same:.1}; mirrored {mirrored:.1}, upside down {upside_down:.1}",
        out.display()
    );
    assert!(
        same < 5.0 && same < 0.5 * mirrored.min(upside_down),
        "{same}, {mirrored}, {upside_down}"
    );
}

const WHITE: Rgb<u8> = Rgb([255; 3]);

fn hits_on_white(frame: &DataSet) -> RgbImage {
    let [_, right, _, top, _, _] = frame.extent.unwrap().map(|n| n as u32);
    let [rgb, object] = ["RGB", "object"].map(|name| &frame.array(name).bytes);
    RgbImage::from_fn(right + 1, top + 1, |x, y| {
        let i = ((top - y) * (right + 1) + x) as usize;
        match i32::from_ne_bytes(object[4 * i..][..4].try_into().unwrap()) {
            -1 => WHITE,
            _ => Rgb(rgb[3 * i..][..3].try_into().unwrap()),
        }
    })
}

/// The cells of a coarse grid that are not white.
fn cells(picture: &RgbImage) -> RgbImage {
    let drawn = || {
        picture
            .enumerate_pixels()
            .filter(|(.., pixel)| **pixel != WHITE)
    };
    let span = |numbers: &mut dyn Iterator<Item = u32>| {
        let (least, most) = numbers.fold((u32::MAX, 0), |(a, b), n| (a.min(n), b.max(n)));
        (least, most - least + 1)
    };
    let (left, width) = span(&mut drawn().map(|(x, ..)| x));
    let (top, height) = span(&mut drawn().map(|(_, y, _)| y));
    let drawn = imageops::crop_imm(picture, left, top, width, height).to_image();
    imageops::resize(&drawn, 20, 20, FilterType::Triangle)
}

/// Mean difference of the channels, 0 to 255.
fn difference(a: &RgbImage, b: &RgbImage) -> f64 {
    let differences = a
        .iter()
        .zip(b.iter())
        .map(|(a, b)| f64::from(a.abs_diff(*b)));
    differences.sum::<f64>() / a.len() as f64
}
