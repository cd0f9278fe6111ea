//! A stranger's folder, as `git clone` leaves it: no file in it makes raycost write, move or remove a
//! file elsewhere.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Output;

use tempfile::TempDir;

use crate::common::{assert_success, in_repository, names, raycost};

/// A file of the user, and one that raycost wrote for the user.
const MINE: &str = "the user's own";
const MARKED: &str = "raycost_run of the user's";
/// Keys that make a scene an animation of two frames.
const ANIMATION: &str = "\nanimation: { frames: 2, fps: 2 }\n";

/// A clone of a stranger's repository beside a folder of the user.
struct Clone(TempDir);

impl Clone {
    fn new() -> Self {
        let this = Self(tempfile::tempdir().unwrap());
        for folder in ["home", "clone/.git", "clone/out/mine"] {
            fs::create_dir_all(this.path(folder)).unwrap();
        }
        for file in [
            "home/notes.txt",
            "clone/.git/config",
            "clone/out/mine/thesis.txt",
        ] {
            fs::write(this.path(file), MINE).unwrap();
        }
        fs::write(this.path("home/marked"), MARKED).unwrap();
        fs::write(this.path("home/empty"), "").unwrap();
        fs::copy(
            in_repository("configs/seed_sphere.yaml"),
            this.path("clone/scene.yaml"),
        )
        .unwrap();
        this
    }

    fn path(&self, path: &str) -> PathBuf {
        self.0.path().join(path)
    }

    /// Runs raycost in the clone.
    fn run(&self, words: &str) -> Output {
        let mut command = raycost();
        command.current_dir(self.path("clone"));
        command.args(words.split(' ')).output().unwrap()
    }

    /// Renders a small picture of the scene.
    fn render(&self, words: &str) -> Output {
        self.run(&format!(
            "render scene.yaml --quiet --width 8 --height 6 {words}"
        ))
    }

    /// Checks that the user's files are as they were.
    fn assert_safe(&self, what: &str) {
        let found = ["empty", "marked", "notes.txt"];
        assert_eq!(names(&self.path("home")), found, "{what}");
        let read = |path: &str| fs::read_to_string(self.path(path)).unwrap();
        for file in [
            "home/notes.txt",
            "clone/.git/config",
            "clone/out/mine/thesis.txt",
        ] {
            assert_eq!(read(file), MINE, "{what}: {file}");
        }
        assert_eq!(read("home/marked"), MARKED, "{what}");
        assert_eq!(read("home/empty"), "", "{what}");
    }
}

/// The hidden folder of a killed run that was writing a file or folder of this name.
fn workspace(folder: &Path, name: &str) -> PathBuf {
    let hash = format!("{:032x}", twox_hash::XxHash3_128::oneshot(name.as_bytes()));
    folder.join(format!(".raycost-{}-AAAAAA", &hash[..16]))
}

/// The plans of commits that earlier versions believed.
#[test]
fn a_plan_in_a_hidden_folder_moves_and_removes_nothing() {
    let clone = Clone::new();
    assert_success(&clone.render("--out out"));
    let out = clone.path("clone/out");
    let (root, top) = (clone.path("clone"), clone.0.path());
    let mut planted = Vec::new();
    for (folder, name, victim, file) in [
        (&*root, "picture.png", ".git", "config"),
        (&root, "out", ".git", "config"),
        (&root, "any", ".git", "config"),
        (top, "clone", "home", "notes.txt"),
        (&out, "any", "mine", "thesis.txt"),
        (&out, "view.html", "mine", "thesis.txt"),
    ] {
        let left = workspace(folder, name);
        for inner in ["new", "old"] {
            fs::create_dir_all(left.join(inner)).unwrap();
            let newest = fs::File::create(left.join(inner).join(file)).unwrap();
            let late = std::time::SystemTime::now() + std::time::Duration::from_secs(1 << 30);
            newest.set_modified(late).unwrap();
        }
        for staged in [1, inode(&left.join("new"))] {
            let plan = serde_json::json!({
                "folder": victim, "staged": staged, "new": [file], "old": [], "kept": null,
            });
            fs::write(left.join("plan.json"), plan.to_string()).unwrap();
        }
        planted.push(left);
    }
    for command in [
        "render scene.yaml --width 8 --height 6 -o picture.png",
        "render scene.yaml --width 8 --height 6 --out out",
        "render scene.yaml --width 8 --height 6 --out .",
        "trace scene.yaml --pixel 3,3 --width 8 --height 6 --out out",
        "view out",
        "diff out . --out out",
        "check out",
    ] {
        assert_success(&clone.run(command));
        clone.assert_safe(command);
    }
    assert_eq!(clone.run("merge out").status.code(), Some(2));
    clone.assert_safe("merge");
    for left in planted {
        assert_eq!(names(&left), ["new", "old", "plan.json"], "{left:?}");
    }
}

fn inode(path: &Path) -> u64 {
    std::os::unix::fs::MetadataExt::ino(&fs::metadata(path).unwrap())
}

#[test]
fn a_link_in_the_place_of_a_file_is_not_followed() {
    let study = "study study.yaml --quiet --out out";
    for (link, to, command) in [
        ("picture.png", "marked", "-o picture.png"),
        ("picture.png", "new.png", "-o picture.png"),
        ("out/image.png", "marked", "--out out"),
        ("out/unfinished.tiles", "empty", "--out out --resume"),
        ("out/unfinished.tiles", "new.tiles", "--out out --resume"),
        ("out/parts", "", "--out out --part 1/2"),
        (
            "out/parts/part-1-of-2.unfinished",
            "empty",
            "--out out --part 1/2",
        ),
        (
            "out/parts/part-1-of-2.unfinished",
            "new",
            "--out out --part 1/2",
        ),
        ("out/frames", "", "--out out"),
        ("out/frames/0000", "", "--out out"),
        ("out/series.csv", "marked", "--out out"),
        ("out/series.pvd", "new.pvd", "--out out"),
        ("out/view.html", "marked", "view out"),
        ("out/view.html", "new.html", "view out"),
        ("out/runs.jsonl", "empty", study),
        ("out/runs.jsonl", "new.jsonl", study),
        ("out/statistics.csv", "notes.txt", study),
        ("out/statistics.json", "new.json", study),
    ] {
        let clone = Clone::new();
        let what = format!("{link} -> {to}: {command}");
        let link = clone.path("clone").join(link);
        fs::create_dir_all(link.parent().unwrap()).unwrap();
        if command == study {
            let text = "title: One\nscenes: [scene.yaml]\nvary: { threads: [1] }\nrepeats: 1\n\
                        flags: [--width=8, --height=6]\n";
            fs::write(clone.path("clone/study.yaml"), text).unwrap();
            fs::write(clone.path("clone/out/runs.jsonl"), "").unwrap();
            let _ = fs::remove_file(&link);
        } else if command == "view out" {
            assert_success(&clone.render("--out out"));
        } else if ["frames", "0000", "series"].iter().any(|name| {
            let file = link.file_name().unwrap();
            file.to_string_lossy().starts_with(name)
        }) {
            let scene = clone.path("clone/scene.yaml");
            let text = fs::read_to_string(&scene).unwrap() + ANIMATION;
            fs::write(&scene, text).unwrap();
        }
        symlink(clone.path("home").join(to), &link).unwrap();
        let output = match command.split_once(' ') {
            Some(("view" | "study", _)) => clone.run(command),
            _ => clone.render(command),
        };
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(
            !output.status.success() && said.contains("symbolic link"),
            "{what}: {said}"
        );
        clone.assert_safe(&what);
    }
}

/// Names in the summary of a frame become names of files beside the frames.
#[test]
fn names_in_a_summary_do_not_lead_out_of_its_folder() {
    let clone = Clone::new();
    let scene = clone.path("clone/scene.yaml");
    fs::write(&scene, fs::read_to_string(&scene).unwrap() + ANIMATION).unwrap();
    assert_success(&clone.render("--out out"));
    let frame = clone.path("clone/out/frames/0000");
    for folder in [frame.join("a"), clone.path("clone/out/series_a")] {
        fs::create_dir(folder).unwrap();
    }
    fs::write(clone.path("clone/out/evil.vtu"), "").unwrap();
    let path = frame.join("summary.json");
    let mut summary: serde_json::Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    let files = summary["files"].as_array_mut().unwrap();
    let mut evil = files[0].clone();
    evil["file"] = "a/../../../evil.vtu".into();
    evil["bytes"] = 0.into();
    files.push(evil);
    fs::write(&path, summary.to_string()).unwrap();
    let before = names(clone.0.path());
    let output = clone.run("render scene.yaml --width 8 --height 6 --out out");
    assert_success(&output);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("2 complete from an earlier run"), "{said}");
    assert_eq!(names(clone.0.path()), before);
}
