//! The field data of all VTK files: the scene, the run, the camera, units, time.

use std::fs;
use std::path::Path;

use crate::common::data_set::DataSet;
use crate::common::{assert_success, raycost};

const SCENE: &str = "
image: { width: 40, height: 20 }
camera: { look_at: { eye: [1, 2, 6], target: [1, 2, 0], fov_y_deg: 90 } }
materials:
  red: { color: [0.8, 0.2, 0.1] }
lights: [{ point: { position: [5, 8, 6] } }]
objects:
  - sphere: { center: [1, 2, 0], radius: 1 }
    material: red
  - plane: { point: [0, 0, 0], normal: [0, 1, 0] }
    material: red
";

/// Runs a command with the scene and what is added to it, and returns the root attribute
/// `raycost_run` of a file and its content.
fn written(added: &str, command: &[&str], file: &str) -> (String, DataSet) {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("ball.yaml");
    fs::write(&scene, format!("{SCENE}{added}")).unwrap();
    let mut raycost = raycost();
    raycost.args(&command[..1]).arg(&scene);
    raycost.args(&command[1..]).arg("--out").arg(folder.path());
    assert_success(&raycost.arg("--quiet").output().unwrap());
    let path = folder.path().join(file);
    (run_of(&path), DataSet::read(&path))
}

fn run_of(path: &Path) -> String {
    let bytes = fs::read(path).unwrap();
    let head = String::from_utf8_lossy(&bytes[..1000]);
    let (_, run) = head.split_once("raycost_run=\"").unwrap();
    run[..32].to_owned()
}

#[test]
fn every_file_names_its_scene_its_run_and_its_camera() {
    let render = ["render", "--also=schedule,surface,bvh", "--cost=counters"];
    let trace = ["trace", "--pixel=20,10"];
    let of_render = [
        "frame.vti",
        "hits.vtu",
        "tiles.vti",
        "surface.vtu",
        "bvh.vtu",
    ];
    let of_trace = ["rays.vtp", "rays_cloud.vtu"];
    let files = of_render.map(|file| (&render[..], file)).into_iter();
    for (command, file) in files.chain(of_trace.map(|file| (&trace[..], file))) {
        let (run, found) = written("", command, file);
        assert_eq!(found.texts("scene"), ["ball"], "{file}");
        assert_eq!(found.texts("raycost_version"), [env!("CARGO_PKG_VERSION")]);
        assert_eq!(found.texts("raycost_run"), [run], "{file}");
        let numbers = |name: &str| found.array(name).f64s();
        assert_eq!(numbers("camera_position"), [1.0, 2.0, 6.0], "{file}");
        assert_eq!(numbers("camera_direction"), [0.0, 0.0, -1.0], "{file}");
        assert_eq!(numbers("camera_up"), [0.0, 1.0, 0.0], "{file}");
        let [x, y] = numbers("camera_fov_deg")[..] else {
            panic!("{file}");
        };
        let expected = 2.0 * 2_f64.atan().to_degrees();
        assert!(
            (x - expected).abs() < 1e-4 && (y - 90.0).abs() < 1e-4,
            "{x} {y}"
        );
        assert!(found.array("resolution").i32s().eq([40, 20]), "{file}");
        assert_eq!(found.time, None, "{file}");
    }
}

#[test]
fn objects_and_materials_have_their_names() {
    let render = ["render", "--cost=counters"];
    for file in ["frame.vti", "hits.vtu"] {
        let named = "output: { also: [objects] }\n";
        let (_, found) = written(named, &render, file);
        assert_eq!(
            found.texts("object_names"),
            ["sphere 0", "plane 1"],
            "{file}"
        );
        assert_eq!(found.texts("material_names"), ["red"], "{file}");
    }
}

#[test]
fn other_cameras_have_the_extent_of_their_picture() {
    let extent = |camera: &str, name: &str| {
        let set = format!("--set=camera={camera}");
        let (_, found) = written("", &["render", "--cost=none", &set], "frame.vti");
        // Sums of single precision.
        let numbers = found.array(name).f64s();
        numbers
            .iter()
            .map(|n| (n * 1e4).round() / 1e4)
            .collect::<Vec<f64>>()
    };
    let parallel = "{ orthographic: { eye: [0, 1, 5], target: [0, 1, 0], height: 3 } }";
    assert_eq!(extent(parallel, "camera_size"), [6.0, 3.0]);
    let panorama = "{ panorama: { eye: [0, 1, 5], target: [0, 1, 0] } }";
    assert_eq!(extent(panorama, "camera_fov_deg"), [360.0, 180.0]);
}

#[test]
fn units_are_those_of_the_arrays() {
    let (_, found) = written("", &["render", "--also=schedule"], "tiles.vti");
    let units = found.texts("units");
    for unit in ["start_ns: ns", "depth: bounces", "rays: rays"] {
        assert!(units.iter().any(|found| found == unit), "{units:?}");
    }
    assert!(!units.iter().any(|unit| unit.starts_with("thread")));
}

#[test]
fn the_range_of_the_cost_is_that_of_cost_png() {
    for (mode, name) in [
        ("time", "time_ns"),
        ("single_ray_time", "time_ns"),
        ("counters", "node_visits"),
    ] {
        for file in ["frame.vti", "hits.vtu"] {
            let mode = format!("--cost={mode}");
            let (_, found) = written("", &["render", &mode], file);
            let range = found.array(&format!("{name}_range")).f64s();
            assert!(range[0] > 0.0 && range[0] < range[1], "{range:?}");
        }
    }
    let (_, found) = written("", &["render", "--cost=none"], "frame.vti");
    assert!(
        !found
            .arrays
            .iter()
            .any(|array| array.name.ends_with("_range"))
    );
}

#[test]
fn a_frame_has_its_time() {
    let animation = "animation: { frames: 3, fps: 2, orbit: { turns: 1 } }\n";
    for (file, time) in [("0000", 0.0), ("0001", 0.5), ("0002", 1.0)] {
        let file = format!("frames/{file}/hits.vtu");
        let (_, found) = written(animation, &["render", "--cost=counters"], &file);
        assert_eq!(found.time, Some(time));
    }
    let trace = ["trace", "--pixel=20,10", "--frame=2"];
    assert_eq!(written(animation, &trace, "rays.vtp").1.time, Some(1.0));
}

/// The plane behind the ball reaches to its horizon.
#[test]
fn the_horizon_is_beyond_four_times_the_median() {
    let (_, found) = written("", &["render", "--cost=none"], "hits.vtu");
    let distances: Vec<f32> = found.array("distance").f32s().collect();
    let mut sorted = distances.clone();
    sorted.sort_by(f32::total_cmp);
    let median = sorted[(sorted.len() - 1) / 2];
    let expected: Vec<u8> = distances
        .iter()
        .map(|&d| u8::from(d > 4.0 * median))
        .collect();
    assert_eq!(found.array("horizon").bytes, expected);
    assert!(expected.contains(&0) && expected.contains(&1));
}
