//! A study that a signal stops ends its run, too.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use super::{assert_success, folder, fs, lines, raycost, run, stderr_of};
use crate::common::with_signals;

/// A study with one run that takes hours.
const ENDLESS: &str = "
title: A study without end
scenes: [scene.yaml]
vary: { threads: [1] }
flags: [--spp=60000]
repeats: 1
";

/// Starts the study and waits until its run renders.
fn start(folder: &Path) -> Child {
    let mut command = raycost();
    command.current_dir(folder).args(["study", "study.yaml"]);
    command.args(["--out", "out", "--quiet"]);
    let mut command = with_signals(&[], &command);
    let mut child = command.stderr(Stdio::null()).spawn().unwrap();
    while renderers(folder).is_empty() {
        assert!(child.try_wait().unwrap().is_none(), "it has ended");
        std::thread::sleep(Duration::from_millis(10));
    }
    child
}

/// The rendering processes that work in this folder.
fn renderers(folder: &Path) -> Vec<PathBuf> {
    let processes = fs::read_dir("/proc").unwrap().flatten();
    let is_one = |process: &PathBuf| {
        let words = fs::read(process.join("cmdline")).unwrap_or_default();
        let words = String::from_utf8_lossy(&words).into_owned();
        words.contains("\0render\0")
            && fs::read_link(process.join("cwd")).is_ok_and(|cwd| cwd == folder)
    };
    let processes = processes.map(|process| process.path());
    processes.filter(is_one).collect()
}

fn signal(child: &Child, name: &str) {
    let id = child.id().to_string();
    let mut kill = Command::new("kill");
    kill.args([&format!("-{name}"), &id]);
    assert!(kill.status().unwrap().success());
}

/// A study of another program that takes an hour, and says its number.
const ANOTHER_PROGRAM: &str = "
title: A study of another program
scenes: [scene.yaml]
steps: [{ name: sleeps, command: sh sleep.sh }]
repeats: 1
";

#[test]
fn a_stopped_study_ends_another_program() {
    let folder = folder(ANOTHER_PROGRAM);
    let script = "echo $$ > id; exec sleep 3600\n";
    fs::write(folder.path().join("sleep.sh"), script).unwrap();
    let mut command = raycost();
    command
        .current_dir(folder.path())
        .args(["study", "study.yaml"]);
    command.args(["--out", "out", "--quiet", "--allow-commands"]);
    let mut study = with_signals(&[], &command).spawn().unwrap();
    let id = loop {
        let id = fs::read_to_string(folder.path().join("id")).unwrap_or_default();
        if id.ends_with('\n') {
            break id;
        }
        assert!(study.try_wait().unwrap().is_none(), "it has ended");
        std::thread::sleep(Duration::from_millis(10));
    };
    signal(&study, "TERM");
    // Otherwise this would wait for an hour.
    assert_eq!(study.wait().unwrap().code(), Some(143));
    assert!(!Path::new("/proc").join(id.trim()).exists());
}

#[test]
fn a_stopped_study_ends_its_run() {
    for (name, code) in [("INT", Some(130)), ("TERM", Some(143)), ("KILL", None)] {
        let folder = folder(ENDLESS);
        let path = folder.path().canonicalize().unwrap();
        let mut study = start(&path);
        let second = run(&path, &[]);
        assert_eq!(second.status.code(), Some(1));
        assert!(
            stderr_of(&second).contains("another run"),
            "{}",
            stderr_of(&second)
        );
        signal(&study, name);
        assert_eq!(study.wait().unwrap().code(), code);
        // The run ends itself; otherwise this loop would not end.
        while !renderers(&path).is_empty() {
            std::thread::sleep(Duration::from_millis(10));
        }
        assert_eq!(lines(&path).len(), 1);
        let names = fs::read_dir(path.join("out")).unwrap();
        let names: Vec<_> = names.map(|entry| entry.unwrap().file_name()).collect();
        if name != "KILL" {
            assert_eq!(names, ["runs.jsonl"]);
        }
        // The next study removes the files that a killed one left.
        fs::write(path.join("study.yaml"), ENDLESS.replace("60000", "1")).unwrap();
        fs::remove_file(path.join("out/runs.jsonl")).unwrap();
        assert_success(&run(&path, &["--quiet"]));
        let hidden = fs::read_dir(path.join("out")).unwrap();
        let mut hidden = hidden.map(|entry| entry.unwrap().file_name());
        assert!(hidden.all(|name| !name.to_string_lossy().starts_with('.')));
    }
}
