//! `image.exr` holds what the VTK files hold, and is read by the reader of another hand.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use exr::prelude::{FlatSamples, ReadChannels, ReadLayers, Text, read};
use output::results::{FrameFile, Results};

use crate::common::{assert_success, in_repository, raycost};

/// Two blocks of rows, both with strips that are cut.
const SIZE: [usize; 2] = [37, 27];

fn render(scene: &str, out: &Path, flags: &[&str]) {
    let [width, height] = SIZE.map(|n| n.to_string());
    let scene = in_repository(&format!("configs/{scene}.yaml"));
    let mut command = raycost();
    command.arg("render").arg(scene).arg("--out").arg(out);
    command.args(["--width", &width, "--height", &height]);
    command.args(["--also=exr,radiance", "--quiet"]).args(flags);
    assert_success(&command.output().unwrap());
}

/// The channels of a file, and its run.
fn channels(folder: &Path) -> (BTreeMap<String, FlatSamples>, String) {
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(folder.join("image.exr"))
        .unwrap();
    let layer = image.layer_data;
    assert_eq!([layer.size.0, layer.size.1], SIZE);
    let run = &layer.attributes.other[&Text::from("raycost_run")];
    let list = layer.channel_data.list.into_iter();
    let channels = list.map(|channel| (channel.name.to_string(), channel.sample_data));
    (channels.collect(), run.to_text().unwrap().to_string())
}

#[test]
fn the_header_lists_the_totals_of_the_summary() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    render("cornell_box", &out, &["--spp=4"]);
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(out.join("image.exr"))
        .unwrap();
    let comments = image.layer_data.attributes.comments.unwrap().to_string();
    let summary = fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let totals = &summary["cost"]["totals"];
    for (name, unit) in [
        ("time_ns", " ns"),
        ("node_visits", " node visits"),
        ("camera_rays", ""),
    ] {
        let line = format!("\n{name} {}{unit}\n", totals[name]);
        assert!(comments.contains(&line), "{comments}");
    }
}

/// The floats of a channel.
fn floats(samples: &FlatSamples) -> &[f32] {
    match samples {
        FlatSamples::F32(floats) => floats,
        _ => panic!("no floats"),
    }
}

/// Checks that a layer has the components of an array of `frame.vti`, with `miss` for
/// NaN; returns the number of its channels.
fn assert_is_array(
    channels: &BTreeMap<String, FlatSamples>,
    frame: &FrameFile,
    [layer, array]: [&str; 2],
    names: &[&str],
    miss: f64,
) -> usize {
    let array = frame.read(array).unwrap();
    let values: Vec<f64> = array.values.iter().collect();
    assert_eq!(array.n_components, names.len());
    for (component, name) in names.iter().enumerate() {
        let of_array = values.iter().skip(component).step_by(names.len());
        let expected: Vec<f64> = of_array
            .map(|&value| if value.is_nan() { miss } else { value })
            .collect();
        let found: Vec<f64> = match &channels[&format!("{layer}{name}")] {
            FlatSamples::F32(floats) => floats.iter().map(|&value| value.into()).collect(),
            FlatSamples::U32(counts) => counts.iter().map(|&count| count.into()).collect(),
            FlatSamples::F16(_) => panic!("{layer} has lost precision"),
        };
        assert!(found == expected, "{layer}{name}");
    }
    names.len()
}

const COLOR: [&str; 3] = ["R", "G", "B"];
const SPACE: [&str; 3] = ["X", "Y", "Z"];

#[test]
fn every_array_is_a_layer() {
    for flags in [&["--cost=time", "--repeats=2"][..], &["--cost=none"]] {
        let folder = tempfile::tempdir().unwrap();
        render("trellis", folder.path(), flags);
        let results = Results::open(folder.path()).unwrap();
        let frame = results.frame().unwrap();
        let (channels, run) = channels(folder.path());
        assert_eq!(results.summary.run.unwrap().to_string(), run);
        // `P`, `albedo` and `Z`, which VTK files do not have.
        let mut n = 7;
        n += assert_is_array(&channels, &frame, ["", "radiance"], &COLOR, 0.0);
        n += assert_is_array(&channels, &frame, ["N.", "Normals"], &SPACE, 0.0);
        let arrays: Vec<String> = (frame.arrays().iter().map(|array| array.name.clone()))
            .filter(|name| {
                // Programs for pictures know the pixel, and the rest is tested above.
                let others = ["pixel_x", "pixel_y", "RGB", "Normals", "radiance"];
                !others.contains(&name.as_str())
            })
            .collect();
        for array in &arrays {
            let layer = match array.as_str() {
                "depth" => "path_depth.",
                name => &format!("{name}."),
            };
            let far = f64::from(1e10_f32);
            let miss = if array == "distance" { far } else { 0.0 };
            n += assert_is_array(&channels, &frame, [layer, array], &["X"], miss);
        }
        assert_eq!(channels.len(), n);
    }
}

#[test]
fn depth_is_along_the_view_and_positions_are_those_of_the_cloud() {
    let folder = tempfile::tempdir().unwrap();
    render("trellis", folder.path(), &["--cost=none"]);
    let (channels, _) = channels(folder.path());
    let hits = Results::open(folder.path()).unwrap().hits().unwrap();
    let pixels: Vec<f64> = hits.read("pixel").unwrap().values.iter().collect();
    let points = hits.read_points().unwrap();
    // Those of the scene's `look_at`.
    let (eye, target) = ([2.5, 1.9, 8.4], [0.1, 1.45, -0.6]);
    let ahead: [f64; 3] = [0, 1, 2].map(|i| target[i] - eye[i]);
    let length = ahead.iter().map(|x| x * x).sum::<f64>().sqrt();
    for (point, pixel) in points.iter().zip(pixels) {
        let pixel = pixel as usize;
        let found = SPACE.map(|name| floats(&channels[&format!("P.{name}")])[pixel]);
        assert_eq!(found.map(f64::from), *point);
        let depth = (0..3).map(|i| ahead[i] / length * (point[i] - eye[i]));
        let found = f64::from(floats(&channels["Z"])[pixel]);
        let depth = depth.sum::<f64>();
        assert!((found - depth).abs() < 1e-5 * depth, "{found} {depth}");
    }
    let n_far = floats(&channels["Z"]).iter().filter(|z| **z == 1e10);
    assert_eq!(n_far.count() + points.len(), SIZE[0] * SIZE[1]);
}

#[test]
fn albedo_is_the_color_of_the_surface() {
    let folder = tempfile::tempdir().unwrap();
    render("spot", folder.path(), &["--cost=counters"]);
    let (channels, _) = channels(folder.path());
    let albedo = COLOR.map(|name| floats(&channels[&format!("albedo.{name}")]));
    let materials = floats(&channels["material.X"]);
    for (pixel, &material) in materials.iter().enumerate() {
        let found = albedo.map(|channel| channel[pixel]);
        match material {
            -1.0 => assert_eq!(found, [0.0; 3]),
            // The checker of the meadow.
            0.0 => assert!([[0.34, 0.5, 0.15], [0.25, 0.41, 0.11]].contains(&found)),
            _ => assert_eq!(found, [0.9, 0.77, 0.62]),
        }
    }
    assert!(
        [-1.0, 0.0, 1.0]
            .iter()
            .all(|material| materials.contains(material))
    );
}

#[test]
fn threads_change_no_byte() {
    let folder = tempfile::tempdir().unwrap();
    let files = ["1", "3"].map(|n_threads| {
        let out = folder.path().join("out");
        let _ = fs::remove_dir_all(&out);
        render("blocks", &out, &["--cost=none", "--threads", n_threads]);
        fs::read(out.join("image.exr")).unwrap()
    });
    assert!(files[0] == files[1]);
}
