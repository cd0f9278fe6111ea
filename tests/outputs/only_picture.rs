//! `raycost render SCENE -o FILE` writes the picture of a run, and no other file.

use std::fs;
use std::path::Path;
use std::process::Output;

use exr::prelude::{RgbaChannels, read_first_rgba_layer_from_file};

use crate::common::{assert_success, in_repository, raycost};

fn render(scene: &str, flags: &[&str], folder: &Path) -> Output {
    let mut command = raycost();
    command.current_dir(folder).arg("render");
    command.arg(in_repository(&format!("configs/{scene}.yaml")));
    command.args(["--width=40", "--height=30"]).args(flags);
    command.output().unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let name = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name();
    entries
        .map(|entry| name(entry).into_string().unwrap())
        .collect()
}

#[test]
fn the_picture_is_that_of_a_whole_run_and_alone() {
    // With outputs that need costs, with color bars, and an array that a run without costs
    // has not.
    for scene in ["seed_extended", "hill_vortex"] {
        let folder = tempfile::tempdir().unwrap();
        let whole = tempfile::tempdir().unwrap();
        let out = whole.path().to_str().unwrap();
        assert_success(&render(scene, &["--quiet", "--out", out], folder.path()));
        let run = render(scene, &["-o", "picture.PNG"], folder.path());
        assert_success(&run);
        let text = String::from_utf8(run.stdout).unwrap();
        assert!(text.contains("\nwrote   picture.PNG ("), "{text}");
        assert_eq!(names(folder.path()), ["picture.PNG"]);
        let picture = image::open(folder.path().join("picture.PNG")).unwrap();
        assert_eq!(
            picture,
            image::open(whole.path().join("image.png")).unwrap()
        );
        // A second time, over the first one.
        assert_success(&render(scene, &["-o", "picture.PNG"], folder.path()));
    }
}

#[test]
fn the_light_is_that_of_a_whole_run_with_its_costs_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let whole = tempfile::tempdir().unwrap();
    let out = whole.path().to_str().unwrap();
    let flags = ["--quiet", "--also=exr", "--out", out];
    assert_success(&render("blocks", &flags, folder.path()));
    assert_success(&render("blocks", &["-o", "light.exr"], folder.path()));
    let flags = ["-o", "costs.exr", "--cost=counters"];
    assert_success(&render("blocks", &flags, folder.path()));
    let light = |path: &Path| {
        let image = read_first_rgba_layer_from_file(
            path,
            |size, _: &RgbaChannels| vec![vec![[0.0_f32; 3]; size.0]; size.1],
            |pixels, at, (r, g, b, _): (f32, f32, f32, f32)| pixels[at.1][at.0] = [r, g, b],
        );
        image.unwrap().layer_data.channel_data.pixels
    };
    let [alone, with_costs] = ["light.exr", "costs.exr"].map(|name| folder.path().join(name));
    let expected = light(&whole.path().join("image.exr"));
    assert_eq!(light(&alone), expected);
    assert_eq!(light(&with_costs), expected);
    assert!(fs::metadata(&with_costs).unwrap().len() > fs::metadata(&alone).unwrap().len());
}

#[test]
fn a_frame_has_to_be_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let run = render("hopper", &["-o", "frame.png"], folder.path());
    assert_eq!(run.status.code(), Some(2));
    let message = String::from_utf8(run.stderr).unwrap();
    assert!(message.contains("the scene has frames"), "{message}");
    assert!(message.contains("--frames 7"), "{message}");
    assert_success(&render(
        "hopper",
        &["-o", "frame.png", "--frames=3"],
        folder.path(),
    ));
    assert_eq!(names(folder.path()), ["frame.png"]);
}

#[test]
fn what_is_wrong_is_said_and_nothing_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let refused = [
        (&["-o", "picture.jpg"][..], 2, "ends in .png or .exr"),
        (&["-o", "picture.png", "--resume"], 2, "cannot be used with"),
        (&["-o", "none/picture.png"], 1, "none/picture.png"),
        (&["-o", "photo.png"], 1, "photo.png"),
    ];
    fs::write(folder.path().join("photo.png"), "of another program").unwrap();
    for (flags, code, said) in refused {
        let run = render("blocks", flags, folder.path());
        let message = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(code), "{message}");
        assert!(message.contains(said), "{message}");
    }
    assert_eq!(names(folder.path()), ["photo.png"]);
    let photo = fs::read(folder.path().join("photo.png")).unwrap();
    assert_eq!(photo, b"of another program");
}
