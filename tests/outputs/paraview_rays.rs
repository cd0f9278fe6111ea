//! ParaView loads `rays.pvsm` without an error or a warning, and shows rays in
//! the colors of their kinds. Screenshots stay in `target/paraview/`.

use std::path::PathBuf;

use image::RgbImage;

use crate::common::paraview::{
    NOTHING, load, load_own, read, scene_file, screenshot, state, trace,
};
use crate::common::{assert_success, in_repository};

/// Camera, shadow and reflection rays, as the state has them.
const KINDS: [[u8; 3]; 3] = [[0, 115, 179], [230, 158, 0], [214, 94, 0]];

/// Traces pixels of a scene of `configs/` and shows the state's own folder.
fn shown(scene: &str, name: &str, arguments: &[&str], cost: &str) -> (PathBuf, RgbImage) {
    let scene = in_repository("configs").join(scene).with_extension("yaml");
    let out = trace(&scene, name, arguments);
    let arrays = format!("kind,length,contribution,RGB,{cost}");
    load_own(&out, &[("rays", &arrays)]);
    let picture = image::open(screenshot(&out, "rays")).unwrap();
    (out, picture.to_rgb8())
}

/// The number of pixels with this color, without the legends: below two views side by side, or below
/// each of two views on top of each other. The view of costs has other colors.
fn n_pixels(picture: &RgbImage, color: [u8; 3]) -> usize {
    let percent = |y: u32| 100 * y / picture.height();
    let pixels = picture.enumerate_pixels();
    let like = |pixel: &[u8; 3]| pixel.iter().zip(&color).all(|(a, b)| a.abs_diff(*b) <= 2);
    let in_view = pixels.filter(|(_, y, _)| matches!(percent(*y), 0..44 | 51..80));
    in_view.filter(|(.., pixel)| like(&pixel.0)).count()
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn the_rays_of_a_pixel_are_shown_by_kind_and_by_time() {
    let (out, picture) = shown("seed_extended", "rays", &["--pixel=290,190"], "time_ns");
    for color in KINDS {
        assert!(n_pixels(&picture, color) > 300, "{color:?}");
    }
    assert!(read(&out, "rays").contains("Time of each ray (&#181;s)"));
    // The state of the repository shows any output.
    let file = in_repository("paraview/rays.pvsm");
    let by_variable = screenshot(&out, "rays by variable");
    let state = state(&file, &out, &by_variable, &["--from-state"]);
    assert_success(&load(&out, &[state]));
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn the_rays_of_a_rectangle_are_shown() {
    let pixels = ["--pixel=380..419,200..229", "--spp=1"];
    let (_, picture) = shown("hall_of_mirrors", "rays of many", &pixels, "time_ns");
    for color in KINDS {
        assert!(n_pixels(&picture, color) > 1000, "{color:?}");
    }
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn rays_through_parallel_pixels_and_to_a_light_without_end_are_shown() {
    let pixels = ["--pixel=150..250,200", "--cost=counters"];
    let (out, picture) = shown("orthographic_grid", "parallel rays", &pixels, "node_visits");
    for color in &KINDS[..2] {
        assert!(n_pixels(&picture, *color) > 300, "{color:?}");
    }
    assert!(read(&out, "rays").contains("BVH nodes visited by each ray"));
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn rays_of_brute_force_are_shown_by_tests() {
    let scene = std::fs::read_to_string(in_repository("configs/seed_sphere.yaml")).unwrap();
    let scene = scene_file(
        "brute rays",
        &format!("{scene}\nacceleration: brute_force\n"),
    );
    let out = trace(
        &scene,
        "rays of brute force",
        &["--pixel=200,200", "--no-cost"],
    );
    load_own(&out, &[("rays", "primitive_tests")]);
    assert!(read(&out, "rays").contains("Primitive tests of each ray"));
}

#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn a_ray_that_meets_nothing_is_shown() {
    let out = trace(&scene_file("no rays", NOTHING), "no hits", &["--pixel=3,4"]);
    let picture = screenshot(&out, "rays");
    let flags = ["--from-state", "--allow-empty"];
    let state = state(&out.join("rays.pvsm"), &out, &picture, &flags);
    assert_success(&load(&out, &[state]));
    let picture = image::open(picture).unwrap().to_rgb8();
    assert!(n_pixels(&picture, KINDS[0]) > 300);
}
