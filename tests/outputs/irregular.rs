//! A FIFO without a writer, and a device without an end, in the place of a file that raycost
//! reads: each command ends, and says what is wrong.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::parts::Folder;
use crate::common::{assert_success, names, raycost};

const SCENE: &str = "configs/seed_sphere.yaml";
const SMALL: [&str; 3] = ["--width=24", "--height=16", "--quiet"];
/// A command that has not ended by then waits forever; it takes a fraction of a second.
const PATIENCE: Duration = Duration::from_secs(120);

/// What takes the place of a file.
const IRREGULAR: [fn(&Path); 2] = [
    |path| {
        let made = Command::new("mkfifo").arg(path).status();
        assert!(made.unwrap().success());
    },
    |path| symlink("/dev/zero", path).unwrap(),
];

/// The output of a command in the folder, which may use 8 GiB; kills one that waits.
fn run(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new("bash");
    command.args(["-c", "ulimit -v 8388608; exec \"$@\"", "bash"]);
    command.arg(raycost().get_program()).args(arguments);
    command.current_dir(folder).stdin(Stdio::null());
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let begin = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if begin.elapsed() > PATIENCE {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("{arguments:?} waits");
        }
        sleep(Duration::from_millis(2));
    }
    child.wait_with_output().unwrap()
}

/// Puts each irregular file in the place of `file`, and runs a command that has to refuse it.
fn refused(folder: &Path, file: &str, arguments: &[&str]) {
    let path = folder.join(file);
    let away = folder.join("away");
    let _ = fs::rename(&path, &away);
    for make in IRREGULAR {
        make(&path);
        let output = run(folder, arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        let code = output.status.code();
        assert!(
            matches!(code, Some(1 | 2)),
            "{file}, {arguments:?}: {code:?} {message}"
        );
        let name = path.file_name().unwrap().to_str().unwrap();
        // A command that writes follows the link; without its summary a folder has files of others.
        let said = [name, "/dev/zero", "raycost did not write"];
        assert!(
            said.iter().any(|said| message.contains(said)),
            "{file}, {arguments:?}: {message}"
        );
        fs::remove_file(&path).unwrap();
    }
    let _ = fs::rename(&away, &path);
}

fn render(folder: &Folder, arguments: &[&str]) {
    let mut command = raycost();
    command.current_dir(folder.0.path()).arg("render");
    assert_success(&command.args(arguments).args(SMALL).output().unwrap());
}

#[test]
fn files_of_an_output_are_regular() {
    let folder = Folder::new();
    render(&folder, &[SCENE, "--out=out", "--also=objects"]);
    let path = folder.0.path();
    let files = names(&path.join("out"));
    assert_success(&run(path, &["diff", "out", "out"]));
    for file in files {
        refused(path, &format!("out/{file}"), &["check", "out"]);
    }
    for (file, commands) in [
        (
            "summary.json",
            &[&["view", "out"][..], &["diff", "out", "out"]][..],
        ),
        ("frame.vti", &[&["view", "out"], &["diff", "out", "out"]]),
        ("hits.vtu", &[&["view", "out"]]),
        ("objects.csv", &[&["diff", "out", "out"]]),
    ] {
        for arguments in commands {
            refused(path, &format!("out/{file}"), arguments);
        }
    }
    let again = [&["render", SCENE, "--out=out"], &SMALL[..]].concat();
    for file in ["summary.json", "frame.vti", "image.png"] {
        refused(path, &format!("out/{file}"), &again);
    }
}

#[test]
fn files_of_parts_and_of_interrupted_runs_are_regular() {
    let folder = Folder::new();
    for part in ["--part=1/2", "--part=2/2"] {
        render(&folder, &[SCENE, "--out=out", part]);
    }
    let path = folder.0.path();
    let part = "out/parts/part-1-of-2.tiles";
    refused(path, part, &["merge", "out", "--quiet"]);
    let parts = [&["render", SCENE, "--out=out", "--part=1/2"], &SMALL[..]].concat();
    refused(path, part, &parts);
    assert_success(&run(path, &["merge", "out", "--quiet"]));
    let resumed = [&["render", SCENE, "--out=out", "--resume"], &SMALL[..]].concat();
    refused(path, "out/unfinished.tiles", &resumed);
}

#[test]
fn files_of_a_series_are_regular() {
    let folder = Folder::new();
    let scene = "include: [configs/seed_sphere.yaml]\nanimation: { frames: 2, keyframes: { 'objects[0].sphere.radius': [{ frame: 0, value: 1 }] } }\n";
    fs::write(folder.path("moving.yaml"), scene).unwrap();
    let arguments = ["moving.yaml", "--out=out"];
    render(&folder, &arguments);
    let path = folder.0.path();
    let again = [&["render"], &arguments[..], &SMALL[..]].concat();
    let in_out = names(&path.join("out")).into_iter();
    for file in in_out.filter(|name| name != "frames") {
        refused(path, &format!("out/{file}"), &again);
    }
    refused(path, "out/frames/0001/summary.json", &again);
}

#[test]
fn input_files_are_regular() {
    let folder = Folder::new();
    let path = folder.0.path();
    let sphere = fs::read_to_string(folder.path(SCENE)).unwrap();
    let write = |text: &str| fs::write(folder.path("scene.yaml"), text).unwrap();
    refused(path, "fifo.yaml", &["check", "fifo.yaml"]);
    write(&format!("include: [fifo.yaml]\n{sphere}"));
    refused(path, "fifo.yaml", &["check", "scene.yaml"]);
    for file in [
        "mesh.obj",
        "mesh.vtu",
        "mesh.gltf",
        "mesh.vtu.series",
        "mesh.pvd",
    ] {
        let mesh = format!("mesh: {{ file: {file} }}");
        write(&sphere.replace("sphere: { center: [0, 0, 1], radius: 1 }", &mesh));
        refused(path, file, &["render", "scene.yaml"]);
    }
}

#[test]
fn files_of_a_study_are_regular() {
    let folder = Folder::new();
    let study = "title: Sizes\nscenes: [configs/seed_sphere.yaml]\nvary: { image_size: [[8, 8]] }\nrepeats: 1\n";
    fs::write(folder.path("study.yaml"), study).unwrap();
    let path = folder.0.path();
    fs::create_dir(folder.path("runs")).unwrap();
    let arguments = ["study", "study.yaml", "--out=runs"];
    refused(path, "runs/runs.jsonl", &arguments);
}
