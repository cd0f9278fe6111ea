//! ParaView's window opens every state without an error or a warning, and shows it: the
//! window reports messages that `pvbatch` does not. Screenshots remain in
//! `target/paraview/` for inspection.

use std::ffi::OsStr;
use std::fs;
use std::path::Path;
use std::process::Output;

use crate::common::paraview::{
    folder, for_pieces, on_virtual_screen_of, render, screenshot, trace,
};
use crate::common::{assert_success, in_repository, raycost};

/// The screen that tests/in-paraview-window expects.
const SCREEN: &str = "1600x1000";

/// The messages of the window for a state.
fn open(state: &Path, out: &Path, name: &str) -> Output {
    on_virtual_screen_of(SCREEN)
        .arg(in_repository("tests/in-paraview-window"))
        .args([state, &screenshot(out, name)])
        .env("RAYCOST_OUT", out)
        .envs(for_pieces(out))
        .output()
        .expect("run tests/with-paraview")
}

/// Opens states of an output folder one after the other.
fn open_all(out: &Path, states: &[&str]) {
    for state in states {
        let file = out.join(state).with_extension("pvsm");
        assert_success(&open(&file, out, state));
    }
}

// Several tests, which run side by side: each window takes seconds.

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn the_states_of_a_rendering_open_in_the_window_without_a_message() {
    let out = render(&in_repository("configs/seed_extended.yaml"), "window", &[]);
    open_all(&out, &["geometry", "heatmap", "overview"]);
    let template = in_repository("paraview/heatmap.pvsm");
    assert_success(&open(&template, &out, "heatmap by variable"));
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn the_states_of_pieces_open_in_the_window_without_a_message() {
    let flags = ["--memory=60M", "--width=600", "--height=500", "--spp=1"];
    let scene = in_repository("configs/seed_extended.yaml");
    let out = render(&scene, "window of pieces", &flags);
    open_all(&out, &["geometry", "heatmap", "overview"]);
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn the_other_states_open_in_the_window_without_a_message() {
    let scene = in_repository("configs/seed_extended.yaml");
    let out = render(&scene, "window of others", &["--also=schedule,surface,bvh"]);
    trace(&scene, "window of others", &["--pixel=290,190"]);
    let before = render(&scene, "before the window", &[]);
    let mut diff = raycost();
    diff.arg("diff")
        .args([&before, &out])
        .arg("--out")
        .arg(&out);
    assert_success(&diff.output().unwrap());
    open_all(&out, &["schedule", "surface", "bvh", "rays", "diff"]);
}

/// The messages of the window after the plugin's macro has printed these words.
fn press(picture: &Path, program: &OsStr, words: &str) -> Output {
    on_virtual_screen_of(SCREEN)
        .arg(in_repository("tests/in-paraview-window"))
        .arg(in_repository("tests/paraview/ball.py"))
        .arg(picture)
        .arg(in_repository("paraview/render_with_raycost.py"))
        .arg(words)
        .env("PYTHONPATH", in_repository("paraview"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("RAYCOST", program)
        .output()
        .expect("run tests/with-paraview")
}

/// The macro of the plugin shows picture and cost in a layout of its own.
#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn the_macro_shows_the_view_and_its_cost() {
    let picture = folder("macro").join("window.png");
    let words = "raycost: the scene is";
    assert_success(&press(&picture, raycost().get_program(), words));
    let window = image::open(&picture).unwrap().into_rgb8();
    // The middle of the upper right of the four views.
    let middle = image::imageops::crop_imm(&window, 1200, 340, 150, 100).to_image();
    let is_colored = |pixel: &&image::Rgb<u8>| pixel[0].abs_diff(pixel[2]) > 60;
    let n_colored = middle.pixels().filter(is_colored).count();
    assert!(n_colored > 10_000, "{n_colored} pixels show a cost");
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn the_macro_says_what_is_missing() {
    let picture = folder("macro").join("no program.png");
    let words = "raycost: there is no program /no/raycost, which the variable RAYCOST names";
    let pressed = press(&picture, "/no/raycost".as_ref(), words);
    let said = String::from_utf8_lossy(&pressed.stdout);
    assert_eq!(pressed.status.code(), Some(1), "{said}");
    assert!(
        said.contains(words) && !said.contains("Traceback"),
        "{said}"
    );
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn a_message_of_the_window_is_noticed() {
    let scene = in_repository("configs/seed_sphere.yaml");
    let out = render(&scene, "window with messages", &[]);
    // As these pictures were shown once.
    let state = fs::read_to_string(out.join("heatmap.pvsm")).unwrap();
    let slices = state.replace("\"Point Gaussian\"", "\"Slice\"");
    let file = out.join("slices.pvsm");
    fs::write(&file, slices).unwrap();
    let opened = open(&file, &out, "slices");
    assert_eq!(opened.status.code(), Some(1));
    let said = String::from_utf8_lossy(&opened.stdout);
    assert!(said.contains("Mapper has no vtkImageData input"), "{said}");
}
