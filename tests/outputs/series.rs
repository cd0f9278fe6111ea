//! Animated scenes: a folder for each frame, and the files that play them.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::SystemTime;

use tempfile::TempDir;

use crate::common::data_set::DataSet;
use crate::common::paraview::{folder, on_virtual_screen, render, screenshot};
use crate::common::{assert_success, in_repository, names, raycost};

/// The sections of a scene of a ball on a floor, without its animation.
const BALL: &str = "
image: { width: 32, height: 24 }
camera: { look_at: { eye: [0, 1.5, 6], target: [0, 0.5, 0], fov_y_deg: 40 } }
cost: counters
materials:
  red: { color: [0.8, 0.2, 0.1], reflection: 0.3 }
  floor: { color: { checker: { even: 1, odd: 0.2, size: 0.5, axes: xz } } }
lights: [{ point: { position: [5, 8, 6], intensity: 0.9 } }]
objects:
  - sphere: { center: [0, 0.8, 0], radius: 0.8 }
    material: red
  - plane: { point: [0, 0, 0], normal: [0, 1, 0] }
    material: floor
";

/// Four frames of the ball.
const ANIMATION: &str = "
animation:
  frames: 4
  fps: 2
  keyframes:
    objects[0].sphere.radius: [{ frame: 0, value: 0.8 }, { frame: 2, value: 0.4 }]
  orbit: { turns: 1 }
";

struct Scene {
    folder: TempDir,
}

impl Scene {
    fn new(text: &str) -> Self {
        let scene = Self {
            folder: tempfile::tempdir().unwrap(),
        };
        scene.write(text);
        scene
    }

    /// The ball with this animation.
    fn ball(animation: &str) -> Self {
        Self::new(&format!("{BALL}{animation}"))
    }

    fn write(&self, text: &str) {
        fs::write(self.path("scene.yaml"), text).unwrap();
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = raycost();
        command
            .current_dir(self.folder.path())
            .args(["render", "scene.yaml"]);
        // No ffmpeg.
        command.env("PATH", "/nowhere").args(arguments);
        command
    }

    fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// Runs a command on an output folder.
    fn of_folder(&self, command: &str, out: &str) -> Output {
        let mut of_folder = raycost();
        of_folder.current_dir(self.folder.path());
        of_folder.args([command, out]).output().unwrap()
    }

    /// Renders, and returns what was printed.
    fn render(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert_success(&output);
        String::from_utf8(output.stdout).unwrap()
    }

    /// The message of a run that the input makes fail.
    fn refused(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        String::from_utf8(output.stderr).unwrap()
    }
}

/// What a folder's run shows and counts.
fn pixels(out: &Path) -> [Vec<u8>; 4] {
    let frame = DataSet::read(&out.join("frame.vti"));
    let names = ["RGB", "object", "node_visits", "primitive_tests"];
    names.map(|name| frame.array(name).bytes.clone())
}

fn frame(out: &Path, number: u32) -> PathBuf {
    out.join(format!("frames/{number:04}"))
}

/// When the summaries of the frames were written.
fn written(out: &Path) -> Vec<SystemTime> {
    let at = |name: &String| {
        let summary = out.join("frames").join(name).join("summary.json");
        summary.metadata().unwrap().modified().unwrap()
    };
    names(&out.join("frames")).iter().map(at).collect()
}

#[test]
fn a_frame_is_the_still_with_its_values() {
    let scene = Scene::ball(ANIMATION);
    scene.render(&[]);
    let out = scene.path("out/scene");
    assert_eq!(names(&out.join("frames")), ["0000", "0001", "0002", "0003"]);
    scene.write(BALL);
    // Eyes after a quarter of a turn each, counterclockwise about +y.
    let eyes = ["[0, 1.5, 6]", "[6, 1.5, 0]", "[0, 1.5, -6]", "[-6, 1.5, 0]"];
    for (number, (eye, radius)) in eyes.into_iter().zip([0.8, 0.6, 0.4, 0.4]).enumerate() {
        let eye = format!("--set=camera.look_at.eye={eye}");
        let radius = format!("--set=objects[0].sphere.radius={radius}");
        scene.render(&[&eye, &radius, "--out=still"]);
        let [still, moving] =
            [scene.path("still"), frame(&out, number as u32)].map(|out| pixels(&out));
        // Rounding of the eye may move an edge.
        let differing = still[0]
            .iter()
            .zip(&moving[0])
            .filter(|(a, b)| a.abs_diff(**b) > 2);
        assert!(differing.count() <= 30, "frame {number}");
        assert!(number > 0 || still == moving);
    }
}

#[test]
fn a_frame_rendered_alone_has_the_same_bytes() {
    let scene = Scene::ball(ANIMATION);
    scene.render(&["--out=all"]);
    let text = scene.render(&["--out=one", "--frames=2"]);
    assert!(text.contains("frames  1 frame rendered"), "{text}");
    assert!(text.contains("missing 3 frames"), "{text}");
    let [all, one] = ["all", "one"].map(|out| pixels(&frame(&scene.path(out), 2)));
    assert!(all == one);
    // The same scene, raycost and flags: the same run.
    let run = |out: &str| {
        let text = fs::read_to_string(frame(&scene.path(out), 2).join("summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
        (
            summary["raycost_run"].clone(),
            summary["frame"]["fingerprint"].clone(),
        )
    };
    assert_eq!(run("all"), run("one"));
}

#[test]
fn a_hierarchy_is_kept_where_nothing_moves_and_changes_nothing() {
    let keyframes = "keyframes: { 'objects[0].sphere.radius': [{ frame: 1, value: 0.8 }, { frame: 2, value: 0.4 }] }";
    let scene = Scene::ball(&format!(
        "animation:\n  frames: 4\n  {keyframes}\n  orbit: {{ turns: 0.5 }}\n"
    ));
    let text = scene.render(&["--out=all"]);
    let kept: Vec<bool> = text
        .lines()
        .take(4)
        .map(|line| line.contains("hierarchy kept"))
        .collect();
    assert_eq!(kept, [false, true, false, true], "{text}");
    for number in 0..4 {
        scene.render(&["--out=one", &format!("--frames={number}")]);
        let [all, one] = ["all", "one"].map(|out| pixels(&frame(&scene.path(out), number)));
        assert!(all == one, "{number}");
    }
}

/// The ball and a cloud that spreads.
fn spreading(hierarchy: &str) -> Scene {
    let cloud = "  - sphere_cloud: { count: 400, min: [-1, 0, -1], max: [1, 2, 1], radius: [0.02, 0.1], seed: 3 }\n    material: red\n";
    let keyframes = "objects[2].sphere_cloud.max: [{ frame: 1, value: [1, 2, 1] }, { frame: 4, value: [9, 2, 1] }]";
    Scene::new(&format!(
        "{BALL}{cloud}animation:\n  frames: 5\n  hierarchy: {hierarchy}\n  keyframes:\n    {keyframes}\n"
    ))
}

/// How each frame came to its hierarchy, by what is printed and by the table.
fn hierarchies(scene: &Scene, printed: &str) -> Vec<(String, String)> {
    let table = fs::read_to_string(scene.path("all/series.csv")).unwrap();
    let rows = table.lines().skip(1).map(|row| row.split(',').nth(3));
    let lines = printed
        .lines()
        .filter(|line| line.starts_with("frame "))
        .map(|line| {
            let (_, how) = line.split_once("hierarchy ").unwrap();
            how.split([' ', ',']).next().unwrap().to_owned()
        });
    lines.zip(rows.map(|row| row.unwrap().to_owned())).collect()
}

#[test]
fn refitted_hierarchies_do_not_depend_on_the_frames_before() {
    let scene = spreading("refit");
    let printed = scene.render(&["--out=all"]);
    let words = |pairs: &[(&str, &str)]| -> Vec<(String, String)> {
        let owned = |&(a, b): &(&str, &str)| (a.to_owned(), b.to_owned());
        pairs.iter().map(owned).collect()
    };
    let refitted = ("refitted", "refitted");
    let expected = [
        ("built", "built"),
        ("kept", "built"),
        refitted,
        refitted,
        refitted,
    ];
    assert_eq!(hierarchies(&scene, &printed), words(&expected), "{printed}");
    let same_picture = |out: &str, number| {
        let [all, one] = ["all", out].map(|out| pixels(&frame(&scene.path(out), number)));
        assert!(all == one, "{out} {number}");
    };
    scene.render(&["--out=range", "--frames=1..3"]);
    (1..4).for_each(|number| same_picture("range", number));
    scene.render(&["--out=one", "--frames=4", "--threads=1"]);
    same_picture("one", 4);
    // What is built anew shows the same, with other counts.
    let rebuilt = spreading("rebuild");
    rebuilt.render(&["--out=all"]);
    let [refit, rebuild] = [&scene, &rebuilt].map(|scene| pixels(&frame(&scene.path("all"), 4)));
    assert_eq!(refit[..2], rebuild[..2]);
    assert_ne!(refit[2], rebuild[2]);
    // `trace` counts what `render` counts.
    let mut trace = raycost();
    trace.current_dir(scene.folder.path());
    let output = trace
        .args(["trace", "scene.yaml", "--frame=4", "--pixel=16,12"])
        .output();
    let text = String::from_utf8(output.unwrap().stdout).unwrap();
    // The rows of VTK's images begin at the lowest.
    let pixel = (23 - 12) * 32 + 16;
    let counted: u32 = bytemuck::pod_read_unaligned(&refit[2][4 * pixel..][..4]);
    let total = text.lines().find(|line| line.contains(" rays ")).unwrap();
    let traced = total.split_whitespace().nth(2).unwrap();
    assert_eq!(traced, counted.to_string(), "{text}");
}

#[test]
fn the_cheaper_hierarchy_is_chosen_by_its_expected_cost() {
    let cloud = "  - sphere_cloud: { count: 400, min: [-1, 0, -1], max: [1, 2, 1], radius: [0.02, 0.1] }\n    material: red\n";
    // All spheres are elsewhere: the first frame's nodes become as large as the cloud.
    let keyframes =
        "objects[2].sphere_cloud.seed: [{ frame: 0, value: 3 }, { frame: 1, value: 4 }]";
    let scene = Scene::new(&format!(
        "{BALL}{cloud}animation:\n  frames: 2\n  hierarchy: auto\n  keyframes:\n    {keyframes}\n"
    ));
    for (size, expected) in [
        (["--width=4", "--height=3"], "refitted"),
        (["--width=96", "--height=72"], "built"),
    ] {
        let printed = scene.render(&["--out=all", size[0], size[1]]);
        let pair = (expected.to_owned(), expected.to_owned());
        assert_eq!(hierarchies(&scene, &printed)[1], pair, "{printed}");
    }
}

#[test]
fn complete_frames_are_kept_and_others_rendered_again() {
    let scene = Scene::ball(ANIMATION);
    scene.render(&[]);
    let out = scene.path("out/scene");
    let first = written(&out);
    let text = scene.render(&[]);
    assert!(text.contains("0 frames rendered"), "{text}");
    assert_eq!(written(&out), first);

    fs::remove_file(frame(&out, 1).join("image.png")).unwrap();
    fs::write(frame(&out, 3).join("frame.vti"), "cut off").unwrap();
    let text = scene.render(&[]);
    assert!(text.contains("2 frames rendered"), "{text}");
    let second = written(&out);
    assert_eq!((second[0], second[2]), (first[0], first[2]));
    assert!(second[1] > first[1] && second[3] > first[3]);

    // The last two frames have another radius; the first two keep theirs.
    let changed = "{ frame: 1, value: 0.6 }, { frame: 2, value: 0.5 }";
    scene.write(&format!("{BALL}{ANIMATION}").replace("{ frame: 2, value: 0.4 }", changed));
    let text = scene.render(&[]);
    assert!(text.contains("2 frames rendered"), "{text}");
    let third = written(&out);
    assert_eq!(third[..2], second[..2]);

    let text = scene.render(&["--spp=2"]);
    assert!(text.contains("4 frames rendered"), "{text}");
    let check = raycost().arg("check").arg(&out).output().unwrap();
    assert_success(&check);
    assert!(String::from_utf8_lossy(&check.stdout).contains("in 4 frames"));
}

#[test]
fn the_files_of_the_series_list_all_frames_with_their_times() {
    let scene = Scene::ball(ANIMATION);
    scene.render(&["--also=surface,schedule"]);
    let out = scene.path("out/scene");
    for (file, data) in [
        ("hits", "hits.vtu"),
        ("frame", "frame.vti"),
        ("surface", "surface.vtu"),
    ] {
        let text = fs::read_to_string(out.join(format!("series_{file}.pvd"))).unwrap();
        for (number, time) in ["0", "0.5", "1", "1.5"].into_iter().enumerate() {
            let path = format!("frames/{number:04}/{data}");
            let line = text.lines().find(|line| line.contains(&path)).unwrap();
            assert!(line.contains(&format!("timestep=\"{time}\"")), "{line}");
            assert!(out.join(path).is_file());
        }
    }
    let table = fs::read_to_string(out.join("series.csv")).unwrap();
    let rows: Vec<Vec<&str>> = table
        .lines()
        .map(|line| line.split(',').collect())
        .collect();
    assert_eq!(rows.len(), 5);
    assert_eq!(rows[0][..3], ["frame", "time", "raycost_run"]);
    let visits = rows[0]
        .iter()
        .position(|name| *name == "node_visits")
        .unwrap();
    for (number, row) in rows[1..].iter().enumerate() {
        assert_eq!(row.len(), rows[0].len());
        let counts = &pixels(&frame(&out, number as u32))[2];
        let counts = counts
            .chunks(4)
            .map(|n| u32::from_ne_bytes(n.try_into().unwrap()));
        assert_eq!(row[visits].parse(), Ok(counts.map(u64::from).sum::<u64>()));
    }
    assert!(
        fs::read_to_string(out.join("series.svg"))
            .unwrap()
            .contains("<svg")
    );
}

/// The ends of the colors in a state of one axis: the first and the last value of its map.
fn ends(state: &Path, key: &str) -> [f64; 2] {
    let text = fs::read_to_string(state).unwrap();
    let map = text
        .split("name=\"RGBPoints\"")
        .nth(if key == "cost" { 1 } else { 2 })
        .unwrap();
    // Four numbers for each of 52 colors.
    [0, 204].map(|index| {
        let id = format!("index=\"{index}\" value=\"");
        let value = map.split_once(&id).unwrap().1.split_once('"').unwrap().0;
        value.parse().unwrap()
    })
}

#[test]
fn overviews_name_scene_size_and_samples_and_those_of_a_series_the_time() {
    let scene = Scene::ball(ANIMATION);
    scene.render(&["--width=24", "--height=18", "--spp=2"]);
    let out = scene.path("out/scene");
    let subject = "value=\"scene: 24 &#215; 18 pixels, 2 samples per pixel";
    for (file, end) in [
        (out.join("series_overview.pvsm"), ", time {time:g}\""),
        (frame(&out, 1).join("overview.pvsm"), "\""),
    ] {
        let text = fs::read_to_string(&file).unwrap();
        assert_eq!(text.matches(subject).count(), 1, "{}", file.display());
        assert!(text.contains(&format!("{subject}{end}")), "{text}");
    }
}

#[test]
fn the_states_have_one_range_of_colors_for_all_frames() {
    let scene = Scene::ball(ANIMATION);
    scene.render(&[]);
    let out = scene.path("out/scene");
    let state = out.join("series_heatmap.pvsm");
    for key in ["cost", "counter"] {
        let frames = (0..4).map(|number| ends(&frame(&out, number).join("heatmap.pvsm"), key));
        let spanning = frames.fold([f64::MAX, f64::MIN], |[a, b], [low, high]| {
            [a.min(low), b.max(high)]
        });
        let ends = ends(&state, key);
        let is_near = |i: usize| (ends[i] - spanning[i]).abs() <= 1e-9 * spanning[i].abs();
        assert!(
            is_near(0) && is_near(1),
            "{key}: {ends:?}, not {spanning:?}"
        );
    }
    let text = fs::read_to_string(&state).unwrap();
    assert!(text.contains("type=\"PVDReader\"") && text.contains("series_frame.pvd"));
}

#[test]
fn runs_share_a_folder() {
    let scene = Scene::ball(ANIMATION);
    let parts = ["0", "1", "2", "3"].map(|frames| {
        let frames = format!("--frames={frames}");
        scene.command(&["--quiet", &frames]).spawn().unwrap()
    });
    for mut part in parts {
        assert!(part.wait().unwrap().success());
    }
    let table = fs::read_to_string(scene.path("out/scene/series.csv")).unwrap();
    assert_eq!(table.lines().count(), 5);
}

#[test]
fn a_killed_run_leaves_whole_frames_and_the_next_one_goes_on() {
    let scene = Scene::ball(&ANIMATION.replace("frames: 4", "frames: 60"));
    let out = scene.path("out/scene");
    for n_frames in [1, 20] {
        let mut child = scene.command(&["--quiet"]).spawn().unwrap();
        while !frame(&out, n_frames).exists() && child.try_wait().unwrap().is_none() {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        let _ = child.kill();
        child.wait().unwrap();
    }
    let before = names(&out.join("frames")).len();
    let text = scene.render(&[]);
    let kept = text
        .split(" complete from")
        .next()
        .unwrap()
        .rsplit(' ')
        .next()
        .unwrap();
    let kept: usize = kept.parse().unwrap();
    assert!(kept >= 19 && kept <= before, "{text}");
    let check = raycost().arg("check").arg(&out).output().unwrap();
    assert!(String::from_utf8_lossy(&check.stdout).contains("in 60 frames"));
    // No temporary file is left.
    assert_eq!(names(&out.join("frames")).len(), 60);
}

#[test]
fn files_of_others_are_never_replaced() {
    for name in [
        "series.csv",
        "series.mp4",
        "series_hits.pvd",
        "series_heatmap.pvsm",
    ] {
        let scene = Scene::ball(ANIMATION);
        let out = scene.path("out/scene");
        fs::create_dir_all(&out).unwrap();
        fs::write(out.join(name), "mine").unwrap();
        let output = scene.run(&[]);
        assert_eq!(output.status.code(), Some(1), "{name}");
        assert_eq!(names(&out), [name]);
        assert_eq!(fs::read_to_string(out.join(name)).unwrap(), "mine");
    }
}

/// A folder with a program `ffmpeg` that does this.
fn with_ffmpeg(scene: &Scene, script: &str) -> PathBuf {
    let folder = scene.path("bin");
    fs::create_dir_all(&folder).unwrap();
    let program = folder.join("ffmpeg");
    fs::write(&program, format!("#!/bin/sh\n{script}\n")).unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    folder
}

#[test]
fn ffmpeg_makes_the_video_of_all_frames() {
    let scene = Scene::ball(ANIMATION);
    let out = scene.path("out/scene");
    let text = scene.render(&["--frames=0..2"]);
    assert!(
        text.contains("no video yet") && !text.contains("ffmpeg"),
        "{text}"
    );
    let text = scene.render(&[]);
    assert!(text.contains("ffmpeg is not installed"), "{text}");

    let tools = with_ffmpeg(
        &scene,
        "for last; do :; done\nls frames/0003/image.png\necho \"$@\" >\"$last\"",
    );
    let path = format!("{}:/usr/bin:/bin", tools.display());
    let output = scene.command(&[]).env("PATH", &path).output().unwrap();
    assert_success(&output);
    let said = fs::read_to_string(out.join("series.mp4")).unwrap();
    assert!(
        said.contains("-framerate 2 -i frames/%04d/image.png -frames:v 4"),
        "{said}"
    );
    // Again: the old one is raycost's.
    assert_success(&scene.command(&[]).env("PATH", &path).output().unwrap());
    let said = fs::read_to_string(out.join("series.mp4")).unwrap();

    with_ffmpeg(&scene, "echo no such codec >&2; exit 1");
    let output = scene.command(&[]).env("PATH", &path).output().unwrap();
    assert_success(&output);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("ffmpeg failed: no such codec"), "{text}");
    assert_eq!(fs::read_to_string(out.join("series.mp4")).unwrap(), said);
}

/// A file of two points with the numbers of an array.
fn points(numbers: [f32; 2]) -> String {
    let [a, b] = numbers;
    format!(
        "# vtk DataFile Version 3.0\npoints\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n-0.6 0.5 0 0.6 0.5 0\n\
         POINT_DATA 2\nSCALARS speed float 1\nLOOKUP_TABLE default\n{a} {b}\n"
    )
}

/// The points of a series, colored by the array.
const POINTS: &str = "
image: { width: 32, height: 24 }
camera: { look_at: { eye: [0, 0.5, 4], target: [0, 0.5, 0], fov_y_deg: 40 } }
cost: counters
shading: { ambient: 1 }
materials: { hot: { color: { array: { name: speed } }, diffuse: 0 } }
lights: []
objects: [{ spheres: { file: SERIES, radius: 0.5 }, material: hot }]
";

/// A scene of a series of three steps.
fn series(file: &str) -> Scene {
    let scene = Scene::new(&POINTS.replace("SERIES", file));
    for (number, numbers) in [(0, [0.0, 0.0]), (10, [1.0, 4.0]), (20, [2.0, 3.0])] {
        fs::write(scene.path(&format!("p{number:03}.vtk")), points(numbers)).unwrap();
    }
    let pvd =
        |(time, file): (&str, &str)| format!("<DataSet timestep=\"{time}\" file=\"{file}\"/>");
    let steps = [("0", "p000.vtk"), ("0.25", "p010.vtk"), ("3", "p020.vtk")];
    let pvd = steps.map(pvd).concat();
    let text = format!("<VTKFile type=\"Collection\"><Collection>{pvd}</Collection></VTKFile>");
    fs::write(scene.path("p.pvd"), text).unwrap();
    let json = steps.map(|(time, name)| format!("{{ \"name\": \"{name}\", \"time\": {time} }}"));
    let text = format!(
        "{{ \"file-series-version\": \"1.0\", \"files\": [{}] }}",
        json.join(", ")
    );
    fs::write(scene.path("p.vtk.series"), text).unwrap();
    scene
}

#[test]
fn time_steps_are_frames_with_their_times_and_one_range_of_colors() {
    let stills = |range: &str| -> Vec<[Vec<u8>; 4]> {
        let scene = series("p000.vtk");
        let text = POINTS.replace("name: speed", &format!("name: speed, range: {range}"));
        let still = |file: &str| {
            scene.write(&text.replace("SERIES", file));
            scene.render(&["--quiet", "--out=still"]);
            pixels(&scene.path("still"))
        };
        ["p000.vtk", "p010.vtk", "p020.vtk"].map(still).into()
    };
    let expected = stills("[0, 4]");
    for (file, times) in [
        ("p%03d.vtk", ["0", "10", "20"]),
        ("p.pvd", ["0", "0.25", "3"]),
        ("p.vtk.series", ["0", "0.25", "3"]),
    ] {
        let scene = series(file);
        scene.render(&["--quiet"]);
        let out = scene.path("out/scene");
        let table = fs::read_to_string(out.join("series.csv")).unwrap();
        let found: Vec<&str> = table
            .lines()
            .skip(1)
            .filter_map(|row| row.split(',').nth(1))
            .collect();
        assert_eq!(found, times);
        for (number, expected) in expected.iter().enumerate() {
            assert!(
                pixels(&frame(&out, number as u32)) == *expected,
                "{file}, {number}"
            );
        }
    }
}

/// As ParaView does: files of one time together, without a time at 0, in the order of their times.
#[test]
fn parts_of_a_time_step_are_shown_together() {
    let scene = series("p000.vtk");
    let text = POINTS.replace("name: speed", "name: speed, range: [0, 4]");
    let stills = ["p000.vtk", "p010.vtk"].map(|file| {
        scene.write(&text.replace("SERIES", file));
        scene.render(&["--quiet", "--out=still"]);
        pixels(&scene.path("still"))
    });
    for (name, x, number) in [("a", -0.6, 0), ("b", 0.6, 0), ("c", -0.6, 1), ("d", 0.6, 4)] {
        let part = format!(
            "# vtk DataFile Version 3.0\npart\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n{x} 0.5 0\n\
             POINT_DATA 1\nSCALARS speed float 1\nLOOKUP_TABLE default\n{number}\n"
        );
        fs::write(scene.path(&format!("{name}.vtk")), part).unwrap();
    }
    let list = "<VTKFile><Collection><DataSet timestep='7' part='0' file='c.vtk'/><DataSet file='a.vtk'/>\
                <DataSet timestep='7' part='1' file='d.vtk'/><DataSet timestep='0' file='b.vtk'/>\
                </Collection></VTKFile>";
    fs::write(scene.path("parts.pvd"), list).unwrap();
    scene.write(&text.replace("SERIES", "parts.pvd"));
    scene.render(&["--quiet"]);
    let out = scene.path("out/scene");
    let found = [0, 1].map(|number| pixels(&frame(&out, number)));
    assert!(found == stills);
    // One step of them is a still.
    scene.write(&text.replace("SERIES", "parts.pvd, step: 1"));
    scene.render(&["--quiet", "--out=still"]);
    assert!(pixels(&scene.path("still")) == stills[1]);
    scene.write(&text.replace("SERIES", "parts.pvd, step: 2"));
    let message = scene.refused(&[]);
    assert!(message.contains("it has no time step 2"), "{message}");
}

#[test]
fn broken_series_are_refused_with_file_and_place() {
    let scene = series("p%03d.vtk");
    let message = |prepare: &dyn Fn(&Scene), file: &str| {
        let scene = series(file);
        prepare(&scene);
        let message = scene.refused(&[]);
        assert!(message.contains("--> scene.yaml:8:30"), "{message}");
        assert!(!scene.path("out").exists());
        message
    };
    let remove = |scene: &Scene| fs::remove_file(scene.path("p010.vtk")).unwrap();
    let missing = message(
        &|scene| {
            fs::write(scene.path("p030.vtk"), points([1.0, 1.0])).unwrap();
            fs::write(scene.path("p050.vtk"), points([1.0, 1.0])).unwrap();
        },
        "p%03d.vtk",
    );
    assert!(
        missing.contains("the time step `p040.vtk` is missing"),
        "{missing}"
    );
    for file in ["p.pvd", "p.vtk.series"] {
        let missing = message(&remove, file);
        assert!(
            missing.contains("its time step `p010.vtk` is missing"),
            "{missing}"
        );
    }
    let none = message(&|_| (), "q%04d.vtk");
    assert!(
        none.contains("no file matches") && none.contains("q0000.vtk"),
        "{none}"
    );
    for (text, expected) in [
        ("<VTKFile><Collection/></VTKFile>", "no time steps"),
        ("<VTKFile/>", "not a collection"),
        (
            "<VTKFile><Collection><DataSet timestep=\"x\" file=\"p000.vtk\"/></Collection></VTKFile>",
            "`timestep` is `x`",
        ),
        (
            "<VTKFile><Collection><DataSet timestep=\"nan\" file=\"p000.vtk\"/><DataSet timestep=\"1\" file=\"p010.vtk\"/></Collection></VTKFile>",
            "nan",
        ),
        (
            "<VTKFile><Collection><DataSet timestep=\"2\" file=\"p000.vtk\"/><DataSet timestep=\"2\" file=\"none.vtk\"/></Collection></VTKFile>",
            "its time step `none.vtk` is missing",
        ),
        ("<VTKFile><Collection>", "it ends early"),
        ("", "not a collection"),
    ] {
        let message = message(
            &|scene| fs::write(scene.path("p.pvd"), text).unwrap(),
            "p.pvd",
        );
        assert!(
            message.to_lowercase().contains(expected),
            "{text}: {message}"
        );
    }
    for text in [
        "",
        "[]",
        "{}",
        "{ \"files\": [] }",
        "{ \"files\": [{ \"name\": \"p000.vtk\", \"time\": null }] }",
    ] {
        message(
            &|scene| fs::write(scene.path("p.vtk.series"), text).unwrap(),
            "p.vtk.series",
        );
    }
    // A step that is damaged is found before the first ray, for the range of the colors.
    fs::write(scene.path("p020.vtk"), "nothing of the kind").unwrap();
    let damaged = scene.refused(&[]);
    assert!(
        damaged.contains("p020.vtk") && !scene.path("out").exists(),
        "{damaged}"
    );
}

#[test]
fn mistakes_in_keyframes_are_shown_at_their_path() {
    for (animation, expected) in [
        (
            "keyframes: { 'objects[0].sphere.radios': [{ frame: 0, value: 1 }] }",
            "unknown key `radios`",
        ),
        (
            "keyframes: { 'objects[7].sphere.radius': [{ frame: 0, value: 1 }] }",
            "no `objects[7]`",
        ),
        (
            "keyframes: { objekts: [{ frame: 0, value: 1 }] }",
            "unknown key `objekts`",
        ),
        (
            "keyframes: { materials.blue.color: [{ frame: 0, value: 1 }] }",
            "no `materials.blue`",
        ),
        (
            "keyframes: { 'objects[0].sphere.radius': [{ frame: 0, value: [1, 2] }] }",
            "expected a number greater than 0",
        ),
        (
            "keyframes: { 'objects[0].sphere.radius': [{ frame: 0, value: 1 }, { frame: 3, value: -1 }] }",
            "cannot be `-",
        ),
        (
            "keyframes: { 'objects[0].sphere.center': [{ frame: 0, value: 1 }] }",
            "a point [x, y, z]",
        ),
        (
            "keyframes: { 'objects[0': [{ frame: 0, value: 1 }] }",
            "named by its number",
        ),
        (
            "keyframes: { '': [{ frame: 0, value: 1 }] }",
            "a key is missing",
        ),
        (
            "keyframes: { animation.fps: [{ frame: 0, value: 1 }] }",
            "the same in all frames",
        ),
        (
            "keyframes: { image.width: [{ frame: 0, value: 1 }] }",
            "the same in all frames",
        ),
    ] {
        let scene = Scene::ball(&format!("animation:\n  frames: 4\n  {animation}\n"));
        let message = scene.refused(&[]);
        assert!(message.contains(expected), "{animation}: {message}");
        // The line with the path.
        assert!(
            message.contains("--> scene.yaml:16:"),
            "{animation}: {message}"
        );
        assert!(!scene.path("out").exists());
    }
    let scene = Scene::new(&format!("{BALL}{ANIMATION}").replace(
        "look_at: { eye: [0, 1.5, 6], target: [0, 0.5, 0], fov_y_deg: 40 }",
        "window: { eye: [0, 1, 6], x: [-1, 1], y: [-1, 1], z: 0 }",
    ));
    let message = scene.refused(&[]);
    assert!(message.contains("this camera cannot move"), "{message}");
}

/// What a run leaves that is killed once a frame is in its place.
#[test]
fn complete_frames_are_cleared_of_what_a_killed_run_left() {
    let scene = Scene::ball(ANIMATION);
    let render = || assert_success(&scene.run(&["--frames=0..0"]));
    render();
    let frames = scene.path("out/scene/frames");
    let hash = format!("{:032x}", twox_hash::XxHash3_128::oneshot(b"0000"));
    let workspace = frames.join(format!(".raycost-{}-left", &hash[..16]));
    fs::create_dir(&workspace).unwrap();
    let number = fs::metadata(&workspace).unwrap().ino();
    fs::create_dir(workspace.join(format!("new-{number}"))).unwrap();
    // A file with all tiles.
    assert_success(&scene.run(&["--frames=0..0", "--part=1/1", "--out=parts"]));
    let tiles = scene.path("parts/frames/0000/parts/part-1-of-1.tiles");
    let left = frames.join("0000/unfinished.tiles");
    fs::copy(tiles, &left).unwrap();
    render();
    assert_eq!(names(&frames), ["0000"]);
    assert!(!left.exists());
}

/// What a run leaves that is killed within a frame, once this frame is complete.
#[test]
fn tiles_of_a_killed_run_are_removed_or_reported() {
    let scene = Scene::ball(ANIMATION);
    let left = scene.path("out/scene/frames/0000/unfinished.tiles");
    let leave = |spp: &str| {
        let _ = fs::remove_dir_all(scene.path("parts"));
        let part = ["--quiet", "--frames=0", "--part=1/2", "--out=parts"];
        scene.render(&[&part, &[spp][..]].concat());
        let tiles = scene.path("parts/frames/0000/parts/part-1-of-2.tiles");
        fs::create_dir_all(left.parent().unwrap()).unwrap();
        fs::copy(tiles, &left).unwrap();
    };
    let check = || scene.of_folder("check", "out/scene");
    leave("--spp=1");
    let message = String::from_utf8(check().stderr).unwrap();
    assert!(message.contains("of an interrupted run"), "{message}");
    assert!(message.contains("render scene.yaml --resume"), "{message}");
    let text = scene.render(&[]);
    assert!(!left.exists() && !text.contains("unfinished"), "{text}");
    // Tiles of other settings.
    leave("--spp=4");
    fs::remove_file(frame(&scene.path("out/scene"), 0).join("image.png")).unwrap();
    for expected in ["1 frame rendered", "0 frames rendered"] {
        let text = scene.render(&[]);
        assert!(text.contains(expected), "{text}");
        let note = "kept    out/scene/frames/0000/unfinished.tiles of an interrupted run";
        assert!(left.exists() && text.contains(note), "{text}");
    }
    let output = check();
    assert_success(&output);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("0000/unfinished.tiles of an"), "{text}");
    // The tiles of all parts are merged.
    for part in ["--part=1/2", "--part=2/2"] {
        scene.render(&["--quiet", "--frames=0", "--spp=4", part]);
    }
    assert_success(&scene.of_folder("merge", "out/scene"));
    assert!(!left.exists());
}

#[test]
fn a_folder_of_parts_has_no_output_yet() {
    let scene = Scene::ball(ANIMATION);
    scene.render(&["--quiet", "--frames=1", "--part=1/2"]);
    let output = scene.of_folder("check", "out/scene");
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("has parts of a picture"), "{message}");
    assert!(message.contains("`raycost merge out/scene`"), "{message}");
}

/// The job array of the book, each task of it with the variables that Slurm sets.
#[test]
fn the_job_array_of_the_book_renders_all_frames() {
    let page = fs::read_to_string(in_repository("docs/time.md")).unwrap();
    let script = page
        .split("```bash\n")
        .nth(1)
        .unwrap()
        .split("```")
        .next()
        .unwrap();
    let temporary = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink(in_repository("configs"), temporary.path().join("configs")).unwrap();
    let program = PathBuf::from(env!("CARGO_BIN_EXE_raycost"));
    let path = format!("{}:/usr/bin:/bin", program.parent().unwrap().display());
    let array = script
        .split("--array=0-")
        .nth(1)
        .unwrap()
        .lines()
        .next()
        .unwrap();
    let last: u32 = array.parse().unwrap();
    let small = script.replace(
        "--quiet",
        "--quiet --width 40 --height 40 --spp 1 --repeats 1",
    );
    let tasks = (0..=last).map(|task| {
        let mut command = Command::new("bash");
        command.args(["-c", &small]).current_dir(temporary.path());
        command.env("PATH", &path).env("SLURM_CPUS_PER_TASK", "1");
        command
            .env("SLURM_ARRAY_TASK_ID", task.to_string())
            .spawn()
            .unwrap()
    });
    let tasks: Vec<_> = tasks.collect();
    for mut task in tasks {
        assert!(task.wait().unwrap().success());
    }
    let out = temporary.path().join("out/hopper");
    let table = fs::read_to_string(out.join("series.csv")).unwrap();
    assert_eq!(table.lines().count(), 21);
    assert_eq!(names(&out.join("frames")).len(), 20);
}

/// The journey of the book: a simulation's series becomes frames that a real ParaView plays.
#[test]
#[ignore = "needs ParaView: run tests/with-paraview"]
fn paraview_steps_through_the_hopper() {
    let scene = in_repository("configs/hopper.yaml");
    let out = render(
        &scene,
        "hopper",
        &["--width=240", "--height=240", "--spp=1"],
    );
    for state in ["series_heatmap", "series_geometry", "series_overview"] {
        let picture = screenshot(&out, state);
        let output = on_virtual_screen()
            .arg("pvbatch")
            .arg(in_repository("tests/paraview/play.py"))
            .args([&out.join(state).with_extension("pvsm"), &picture])
            .args(["20", "0", "1.14"])
            .output()
            .expect("run tests/with-paraview");
        assert_success(&output);
    }
    // A collection alone, as from File > Open.
    let output = on_virtual_screen()
        .arg("pvbatch")
        .arg(in_repository("tests/paraview/play.py"))
        .args([&out.join("series.pvd"), &folder("").join("series.png")])
        .args(["20", "0", "1.14"])
        .output()
        .expect("run tests/with-paraview");
    assert_success(&output);
}

#[test]
fn a_check_finds_missing_frames_and_cut_files_of_the_series() {
    let scene = Scene::ball(ANIMATION);
    scene.render(&["--quiet"]);
    let out = scene.path("out/scene");
    let check = || raycost().arg("check").arg(&out).output().unwrap();
    assert_success(&check());
    let damaged = |what: &str| {
        let output = check();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(what), "{message}");
    };
    for name in names(&out).into_iter().filter(|name| name != "frames") {
        let path = out.join(&name);
        let text = fs::read(&path).unwrap();
        for n_kept in [0, text.len() / 2, text.len() - 20] {
            fs::write(&path, &text[..n_kept]).unwrap();
            damaged(&name);
        }
        fs::remove_file(&path).unwrap();
        damaged(&format!("{name}: it is missing"));
        fs::write(&path, text).unwrap();
    }
    assert_success(&check());
    let moved = scene.path("moved");
    fs::rename(&out, &moved).unwrap();
    assert_success(&raycost().arg("check").arg(&moved).output().unwrap());
    fs::rename(&moved, &out).unwrap();
    // Other frames than those that were rendered.
    for name in ["series.pvd", "series_hits.pvd", "series.csv"] {
        let path = out.join(name);
        let text = fs::read_to_string(&path).unwrap();
        let changed = match name {
            "series.csv" => text.replacen("\n1,", "\n2,", 1),
            _ => text.replace("0001", "0002"),
        };
        fs::write(&path, changed).unwrap();
        damaged(&format!("{name}: it was changed"));
        fs::write(&path, text).unwrap();
    }
    fs::remove_dir_all(frame(&out, 2)).unwrap();
    damaged("frames/0002: it is missing, 1 frame in all");
}

/// The frames of two animations whose frames have the same files.
#[test]
fn frames_of_a_longer_animation_are_reported_and_not_counted() {
    let animation = |n: u32| format!("{BALL}animation: {{ frames: {n} }}\n");
    let scene = Scene::new(&animation(5));
    scene.render(&["--quiet", "--frames=0..3"]);
    scene.write(&animation(2));
    let note = "frames/0002 and 1 frame more are left of a longer animation";
    let text = scene.render(&[]);
    assert!(text.contains("2 complete from an earlier run"), "{text}");
    assert!(text.contains(note), "{text}");
    let whole = |n_frames: &str| {
        let output = scene.of_folder("check", "out/scene");
        assert_success(&output);
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains(n_frames), "{text}");
        text
    };
    let text = whole("in 2 frames");
    assert!(text.contains(note), "{text}");
    scene.write(&animation(6));
    scene.render(&["--quiet"]);
    let text = whole("in 6 frames");
    assert!(!text.contains("note"), "{text}");
}
