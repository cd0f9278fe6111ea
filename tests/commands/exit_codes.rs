//! A failure gives its exit code, one message on standard error, and nothing on
//! standard output.

use std::fs;
use std::path::Path;
use std::process::Output;

use crate::common::in_repository;

/// Runs the program in a folder.
fn raycost(folder: &Path, arguments: &[&str]) -> Output {
    crate::common::raycost()
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

/// Returns the error message of a command that fails with this exit code.
fn failure(folder: &Path, arguments: &[&str], exit_code: i32) -> String {
    let output = raycost(folder, arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(exit_code), "{message}");
    assert_eq!(String::from_utf8(output.stdout).unwrap(), "", "{message}");
    assert!(!message.contains('\u{1b}'), "{message:?} has colors");
    assert!(message.starts_with("error: "), "{message}");
    message
}

/// A folder with a scene that renders in no time.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let scene = fs::read_to_string(in_repository("configs/seed_sphere.yaml")).unwrap();
    let small = scene.replace("width: 400, height: 400", "width: 8, height: 6");
    fs::write(folder.path().join("scene.yaml"), small).unwrap();
    folder
}

#[test]
#[cfg(unix)]
fn the_root_is_no_output_folder() {
    let folder = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink("/", folder.path().join("link")).unwrap();
    let scene = in_repository("configs/seed_sphere.yaml");
    let scene = scene.to_str().unwrap();
    for flags in [
        &["--out=/"][..],
        &["--out=link"],
        &["--out=/", "--part=1/2"],
    ] {
        let message = failure(folder.path(), &[&["render", scene], flags].concat(), 1);
        assert!(message.contains("root of the file system"), "{message}");
    }
}

#[test]
fn a_fine_scene_ends_with_0_and_says_so_on_standard_output() {
    let folder = folder();
    for arguments in [["check", "scene.yaml"], ["render", "scene.yaml"]] {
        let output = raycost(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(0));
        assert!(!output.stdout.is_empty() && output.stderr.is_empty());
        assert!(!output.stdout.contains(&0x1b), "colors in a pipe");
    }
    assert!(folder.path().join("out/scene/image.png").exists());
    let quiet = raycost(folder.path(), &["render", "scene.yaml", "--quiet"]);
    assert!(quiet.status.success() && quiet.stdout.is_empty() && quiet.stderr.is_empty());
}

#[test]
fn a_mistake_in_the_scene_ends_with_2_before_anything_is_written() {
    let folder = folder();
    let scene = fs::read_to_string(folder.path().join("scene.yaml")).unwrap();
    fs::write(
        folder.path().join("bad.yaml"),
        scene.replace("radius: 1", "radius: -1"),
    )
    .unwrap();
    for command in ["check", "render"] {
        let message = failure(folder.path(), &[command, "bad.yaml"], 2);
        let expected = "\
error: `objects[0].sphere.radius` cannot be `-1`
  --> bad.yaml:17:42
   |
17 |   - sphere: { center: [0, 0, 1], radius: -1 }
   |                                          ^^ expected a number greater than 0 (1e-15 to 1e15)
";
        assert_eq!(message, expected);
    }
    assert!(!folder.path().join("out").exists());
}

#[test]
fn a_scene_that_cannot_be_read_ends_with_2() {
    let folder = folder();
    fs::create_dir(folder.path().join("folder")).unwrap();
    for (scene, system) in [
        ("nowhere.yaml", "No such file"),
        ("folder", "Is a directory"),
    ] {
        let message = failure(folder.path(), &["check", scene], 2);
        let expected = format!("error: cannot read the scene `{scene}`: {system}");
        assert!(message.starts_with(&expected), "{message}");
        assert!(
            message.contains("= help: give the path of a YAML file"),
            "{message}"
        );
    }
}

#[test]
fn a_binary_scene_ends_with_2() {
    let folder = folder();
    fs::write(
        folder.path().join("latin1.yaml"),
        b"image: 1\nmaterials: { gr\xfcn: 1 }\n",
    )
    .unwrap();
    let expected = "\
error: the file is not UTF-8 text
 --> latin1.yaml:2:16
  |
2 | materials: { gr\u{fffd}n: 1 }
  |                ^ not a UTF-8 character
  |
  = help: save the scene as UTF-8
";
    assert_eq!(
        failure(folder.path(), &["check", "latin1.yaml"], 2),
        expected
    );

    let utf16: Vec<u8> = "\u{feff}image: 1\n"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    fs::write(folder.path().join("utf16.yaml"), utf16).unwrap();
    let message = failure(folder.path(), &["check", "utf16.yaml"], 2);
    assert!(message.contains("--> utf16.yaml:1:1\n"), "{message}");

    fs::write(folder.path().join("empty.yaml"), "").unwrap();
    let message = failure(folder.path(), &["check", "empty.yaml"], 2);
    assert!(
        message.starts_with("error: the scene is empty\n --> empty.yaml:1:1\n"),
        "{message}"
    );
}

#[test]
fn a_byte_order_mark_and_the_line_ends_of_windows_are_fine() {
    let folder = folder();
    let scene = fs::read_to_string(folder.path().join("scene.yaml")).unwrap();
    let windows = format!("\u{feff}{}", scene.replace('\n', "\r\n"));
    fs::write(folder.path().join("windows.yaml"), windows).unwrap();
    assert!(
        raycost(folder.path(), &["check", "windows.yaml"])
            .status
            .success()
    );
}

#[test]
fn a_folder_that_cannot_be_written_ends_with_1() {
    let folder = folder();
    fs::write(folder.path().join("file"), "not a folder").unwrap();
    for out in ["file", "file/below"] {
        let message = failure(folder.path(), &["render", "scene.yaml", "--out", out], 1);
        assert!(
            message.starts_with(&format!("error: cannot write `{out}`: ")),
            "{message}"
        );
        assert!(
            message.contains("= help: choose another folder with `--out`"),
            "{message}"
        );
    }
    assert_eq!(
        fs::read_to_string(folder.path().join("file")).unwrap(),
        "not a folder"
    );
}

#[test]
fn a_wrong_command_line_ends_with_2() {
    let folder = folder();
    let lines: [&[&str]; 14] = [
        &["render"],
        &["paint", "scene.yaml"],
        &["render", "scene.yaml", "--width", "0"],
        &["render", "scene.yaml", "--width", "65536"],
        &["render", "scene.yaml", "--tile-size", "1"],
        &["render", "scene.yaml", "--tile-size", "257"],
        &["render", "scene.yaml", "--tile-order", "spiral"],
        &["render", "scene.yaml", "--height", "tall"],
        &["render", "scene.yaml", "--spp", "-1"],
        &["render", "scene.yaml", "--seed", "1.5"],
        &["render", "scene.yaml", "--cost", "timer"],
        &["render", "scene.yaml", "--cost", "time", "--no-cost"],
        &["render", "scene.yaml", "--threads", "0"],
        &["render", "scene.yaml", "--treads", "2"],
    ];
    for arguments in lines {
        let message = failure(folder.path(), arguments, 2);
        assert!(message.contains("--help"), "{message}");
    }
    let output = raycost(folder.path(), &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty() && !output.stderr.contains(&0x1b));
    assert!(!folder.path().join("out").exists());
}

#[test]
fn a_command_that_would_do_nothing_or_damage_an_output_is_refused() {
    let folder = folder();
    let rendered = raycost(
        folder.path(),
        &["render", "scene.yaml", "--quiet", "--out", "o"],
    );
    assert_eq!(rendered.status.code(), Some(0));
    for (arguments, expected) in [
        (
            ["check", "o", "--width=3"].as_slice(),
            "do not change an output folder",
        ),
        (&["view", "o", "--out=o/summary.json"], "is not a page"),
        (&["states", "none"], "`none` does not exist"),
    ] {
        let message = failure(folder.path(), arguments, 2);
        assert!(message.contains(expected), "{message}");
    }
    failure(folder.path(), &["check", "o", "--frame=1"], 2);
    let checked = raycost(folder.path(), &["check", "o"]);
    assert_eq!(checked.status.code(), Some(0));
}

#[test]
fn files_of_what_is_not_measured_are_refused() {
    let folder = folder();
    let scene = fs::read_to_string(folder.path().join("scene.yaml")).unwrap();
    let asking = format!("{scene}output: [schedule, surface]\n");
    fs::write(folder.path().join("asking.yaml"), asking).unwrap();

    let by_flag = [
        "render",
        "scene.yaml",
        "--no-cost",
        "--also",
        "schedule,objects",
    ];
    let message = failure(folder.path(), &by_flag, 2);
    assert!(message.contains("`objects` requires counters"), "{message}");
    assert!(
        message.contains("--cost counters") && !message.contains("-->"),
        "{message}"
    );
    let by_file = ["check", "asking.yaml", "--no-cost"];
    let message = failure(folder.path(), &by_file, 2);
    assert!(message.contains("`surface` requires counters"), "{message}");
    assert!(message.contains("--> asking.yaml"), "{message}");
    assert!(!folder.path().join("out").exists());
}

#[test]
fn noise_that_samples_do_not_show_is_refused() {
    let folder = folder();
    let one_sample = ["render", "scene.yaml", "--also", "noise"];
    let message = failure(folder.path(), &one_sample, 2);
    assert!(message.contains("at least 2 samples"), "{message}");
    assert!(message.contains("--spp 16"), "{message}");
    let by_time = ["--set", "output=[noise: { cost: time_ns }]"];
    let untimed = ["check", "scene.yaml", "--spp", "4", "--cost", "counters"];
    let message = failure(folder.path(), &[&untimed[..], &by_time].concat(), 2);
    assert!(message.contains("requires `cost: time`"), "{message}");
    assert!(!folder.path().join("out").exists());
}

#[test]
fn idle_lanes_without_counters_are_refused() {
    let folder = folder();
    let uncounted = ["render", "scene.yaml", "--also", "lanes", "--cost", "none"];
    let message = failure(folder.path(), &uncounted, 2);
    assert!(message.contains("`lanes` requires counters"), "{message}");
    assert!(message.contains("use `--cost counters`"), "{message}");
    assert!(!folder.path().join("out").exists());
}

#[test]
fn sampling_until_a_noise_says_how_many_pixels_reached_it() {
    let folder = folder();
    for (noise, most, said) in [
        ("0.2", "4096", "all pixels"),
        ("0.01", "17", "the others have 17 samples"),
        (
            "0.3",
            "16",
            "not compared with 0.3: it takes more than 16 samples",
        ),
    ] {
        let until = ["render", "scene.yaml", "--until-noise", noise];
        let most = ["--spp", most, "--out", noise];
        let output = raycost(folder.path(), &[&until[..], &most].concat());
        assert!(output.status.success(), "{output:?}");
        let summary = fs::read_to_string(folder.path().join(noise).join("summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        let n_below = summary["n_below_noise"].as_u64();
        let is_all = n_below == summary["n_pixels"].as_u64();
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(text.contains(said), "{text}");
        assert_eq!(is_all, noise == "0.2");
        assert_eq!(n_below.is_none(), noise == "0.3");
    }
    failure(
        folder.path(),
        &["check", "scene.yaml", "--until-noise", "0"],
        2,
    );
}
