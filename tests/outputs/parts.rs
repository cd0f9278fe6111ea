//! Pictures rendered in parts and merged.
#![cfg(unix)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use render::checkpoint::{Checkpoint, CheckpointFile};
use tempfile::TempDir;

use crate::common::same_output::{assert_same_output, summary};
use crate::common::{assert_success, in_repository, names, raycost};

/// A scene of an animated ball on a floor is a file of the folder.
pub struct Folder(pub TempDir);

impl Folder {
    pub fn new() -> Self {
        let temporary = tempfile::tempdir().unwrap();
        std::os::unix::fs::symlink(in_repository("configs"), temporary.path().join("configs"))
            .unwrap();
        Self(temporary)
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn run(&self, arguments: &[&str]) -> Output {
        let mut command = raycost();
        command.current_dir(self.0.path()).env("PATH", "/nowhere");
        command.args(arguments).output().unwrap()
    }

    /// Renders a scene whole.
    fn render(&self, scene: &str, flags: &[&str], out: &str) {
        let scene = format!("configs/{scene}.yaml");
        let command = ["render", &scene, "--quiet", "--out", out];
        assert_success(&self.run(&[&command, flags].concat()));
    }

    /// Renders the parts of a scene.
    fn render_parts(&self, scene: &str, flags: &[&str], out: &str, n: u32) {
        for number in 1..=n {
            // Any number of threads.
            let part = [
                format!("--part={number}/{n}"),
                format!("--threads={}", number % 3 + 1),
            ];
            let part = part.each_ref().map(String::as_str);
            self.render(scene, &[flags, &part].concat(), out);
        }
    }

    /// The message of a merge that is refused.
    fn refused(&self, out: &str) -> String {
        let output = self.run(&["merge", out]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(!self.path(out).join("summary.json").exists());
        message
    }

    fn part(&self, out: &str, name: &str) -> PathBuf {
        self.path(out).join("parts").join(name)
    }
}

const SMALL: [&str; 2] = ["--width=70", "--height=50"];

#[test]
fn merged_parts_are_the_whole_picture() {
    let cases: [(&str, &[&str], u32); 7] = [
        ("seed_extended", &["--cost=none"], 2),
        (
            "still_life",
            &["--cost=counters", "--also=objects,schedule,radiance"],
            3,
        ),
        ("glass", &["--cost=time", "--repeats=3", "--tile-size=7"], 5),
        (
            "cornell_box",
            &["--cost=single_ray_time", "--spp=4", "--also=exr,bounces"],
            2,
        ),
        (
            "marbles",
            &[
                "--cost=counters",
                "--spp=16",
                "--set=image.sampler=sobol",
                "--set=image.adaptive={noise: 0.05, min_samples: 4}",
            ],
            2,
        ),
        (
            "cornell_box",
            &[
                "--cost=counters",
                "--spp=16",
                "--set=image.adaptive={by: efficiency, min_samples: 4}",
            ],
            3,
        ),
        (
            "spot",
            &["--cost=counters", "--tile-order=cost", "--tile-size=64"],
            9,
        ),
    ];
    for (scene, flags, n) in cases {
        let folder = Folder::new();
        let flags = [&SMALL, flags].concat();
        folder.render(scene, &flags, "whole");
        folder.render_parts(scene, &flags, "merged", n);
        assert_eq!(names(&folder.path("merged/parts")).len(), n as usize);
        let merged = folder.run(&["merge", "merged"]);
        assert_success(&merged);
        assert_same_output(&folder.path("whole"), &folder.path("merged"));
        assert_success(&folder.run(&["check", "merged"]));
        let summary = summary(&folder.path("merged"));
        let files = summary["other_runs"]["files"].as_array().unwrap();
        assert_eq!(files.len(), n as usize);
        assert_eq!(files[0]["part"], format!("1/{n}"));
        // Threads of all machines.
        let threads: u64 = files
            .iter()
            .map(|file| file["threads"].as_u64().unwrap())
            .sum();
        assert_eq!(summary["threads"]["used"], threads);
    }
}

/// The sentence on squares in the times of an output.
pub fn squares(out: &Path) -> Option<String> {
    let notes = summary(out)["time_notes"].clone();
    let notes = notes.as_array().unwrap().iter();
    let mut notes = notes.map(|note| note.as_str().unwrap().to_owned());
    notes.find(|note| note.contains("squares"))
}

#[test]
fn repeats_of_parts_and_of_resumed_pictures_move_groups() {
    let folder = Folder::new();
    for repeats in ["--repeats=1", "--repeats=3"] {
        let flags = [
            "--width=80",
            "--height=64",
            "--spp=1",
            "--tile-size=16",
            repeats,
        ];
        let (parts, kept) = (format!("parts{repeats}"), format!("kept{repeats}"));
        folder.render_parts("seed_extended", &flags, &parts, 2);
        // Tiles of a moved grid have their own numbers.
        let files = ["part-1-of-2.tiles", "part-2-of-2.tiles"];
        let files = files.map(|name| CheckpointFile::open(&folder.part(&parts, name)).unwrap());
        let n_tiles: usize = files.iter().map(CheckpointFile::n_tiles).sum();
        let expected = if repeats == "--repeats=1" {
            5 * 4
        } else {
            5 * 4 + 2 * 6 * 5
        };
        assert_eq!(n_tiles, expected);
        assert_success(&folder.run(&["merge", &parts]));
        folder.render(
            "seed_extended",
            &[&flags[..], &["--resume"]].concat(),
            &kept,
        );
        for out in [&parts, &kept] {
            let said = squares(&folder.path(out));
            assert_eq!(said.is_some(), repeats == "--repeats=1", "{out}: {said:?}");
        }
    }
}

#[test]
fn frames_are_rendered_in_parts() {
    let folder = Folder::new();
    let flags = ["--width=24", "--height=24", "--spp=1", "--cost=counters"];
    let some = [&flags[..], &["--frames=1..2"]].concat();
    folder.render("hopper", &some, "whole");
    folder.render_parts("hopper", &some, "merged", 2);
    // A task of an array that is run again.
    let again = [
        "render",
        "configs/hopper.yaml",
        "--out=merged",
        "--part=2/2",
        "--threads=1",
    ];
    let output = folder.run(&[&again[..], &some].concat());
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains("0 frames rendered") && text.contains("2 complete"),
        "{text}"
    );
    let merged = folder.run(&["merge", "merged"]);
    assert_success(&merged);
    let text = String::from_utf8(merged.stdout).unwrap();
    assert!(text.contains("missing 18 frames"), "{text}");
    for frame in ["frames/0001", "frames/0002"] {
        let [whole, merged] = ["whole", "merged"].map(|out| folder.path(out).join(frame));
        assert_same_output(&whole, &merged);
    }
    let table = |out: &str| fs::read_to_string(folder.path(out).join("series.csv")).unwrap();
    assert_eq!(
        table("merged").lines().count(),
        table("whole").lines().count()
    );
    // A whole run keeps what was merged.
    let kept = folder.run(
        &[
            &["render", "configs/hopper.yaml", "--out=merged"],
            &some[..],
        ]
        .concat(),
    );
    let text = String::from_utf8(kept.stdout).unwrap();
    assert!(text.contains("0 frames rendered"), "{text}");
}

/// Two parts of a small picture in `out`.
fn two_parts(folder: &Folder) {
    folder.render_parts(
        "seed_extended",
        &["--width=40", "--height=40", "--cost=counters"],
        "out",
        2,
    );
}

/// A number that depends on `i` in no simple way.
fn scrambled(i: usize) -> usize {
    (i + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 20
}

/// Whether a file with these bytes passes for a complete part.
fn is_complete(path: &Path, bytes: &[u8]) -> bool {
    fs::write(path, bytes).unwrap();
    let found = CheckpointFile::open(path);
    found.is_ok_and(|file| file.is_complete && !file.is_torn)
}

#[test]
fn a_part_that_was_cut_or_changed_anywhere_is_found() {
    let folder = Folder::new();
    two_parts(&folder);
    let path = folder.part("out", "part-1-of-2.tiles");
    let whole = fs::read(&path).unwrap();
    assert!(is_complete(&path, &whole));
    for i in 0..200 {
        let at = scrambled(i) % whole.len();
        assert!(!is_complete(&path, &whole[..at]), "cut at {at}");
        let mut changed = whole.clone();
        changed[at] ^= 1 << (i % 8);
        assert!(!is_complete(&path, &changed), "changed at {at}");
        changed.splice(at..at, [0; 3]);
        assert!(!is_complete(&path, &changed), "longer at {at}");
    }
    assert!(!is_complete(&path, &[&whole[..], &[0]].concat()));
    for i in 0..5 {
        let at = scrambled(i) % whole.len();
        fs::write(&path, &whole[..at]).unwrap();
        let message = folder.refused("out");
        assert!(message.contains("part-1-of-2.tiles: "), "{message}");
        assert!(message.contains("--part 1/2"), "{message}");
    }
    // Rendered again alone.
    let flags = ["--width=40", "--height=40", "--cost=counters", "--part=1/2"];
    folder.render("seed_extended", &flags, "out");
    assert_success(&folder.run(&["merge", "out"]));
}

/// What precedes the cut of a file is unharmed.
#[test]
fn the_whole_tiles_of_a_cut_file_are_read() {
    let folder = Folder::new();
    two_parts(&folder);
    let path = folder.part("out", "part-2-of-2.tiles");
    let bytes = fs::read(&path).unwrap();
    let records = |path: &Path| -> Vec<_> {
        let file = Checkpoint::from_parts(vec![CheckpointFile::open(path).unwrap()]);
        (0..9).filter_map(|tile| file.restore(0, tile)).collect()
    };
    let whole = records(&path);
    assert!((3..=6).contains(&whole.len()));
    let mut counts = Vec::new();
    for i in 0..50 {
        let at = scrambled(i) % bytes.len();
        fs::write(&path, &bytes[..at]).unwrap();
        if CheckpointFile::open(&path).is_err() {
            continue;
        }
        let found = records(&path);
        assert!(found.iter().all(|record| whole.contains(record)));
        counts.push(found.len());
    }
    counts.sort_unstable();
    counts.dedup();
    assert!(counts.len() >= 3, "{counts:?}");
}

#[test]
fn parts_that_make_no_picture_are_named() {
    let folder = Folder::new();
    assert!(folder.refused("nothing").contains("has no parts"));
    two_parts(&folder);
    let [one, two] =
        ["part-1-of-2.tiles", "part-2-of-2.tiles"].map(|name| folder.part("out", name));
    let away = folder.path("away.tiles");
    fs::rename(&two, &away).unwrap();
    let message = folder.refused("out");
    assert!(message.contains("part 2/2 is missing"), "{message}");
    assert!(message.contains("--out out --part 2/2"), "{message}");
    // The same part twice.
    fs::copy(&one, &two).unwrap();
    let message = folder.refused("out");
    assert!(
        message.contains("part-2-of-2.tiles: it is part 1/2, as is part-1"),
        "{message}"
    );
    // Of another seed.
    fs::remove_file(&two).unwrap();
    let small = ["--width=40", "--height=40", "--cost=counters"];
    folder.render(
        "seed_extended",
        &[&small[..], &["--part=2/2", "--seed=8"]].concat(),
        "out",
    );
    let message = folder.refused("out");
    assert!(message.contains("of another scene"), "{message}");
    assert!(message.contains(".tiles: it is"), "{message}");
    // Of another version, and with tiles of another part.
    for (from, to, expected) in [
        ("\"raycost\":\"0.", "\"raycost\":\"9.", "raycost 9."),
        ("\"number\":2", "\"number\":1", "as is part-1-of-2.tiles"),
    ] {
        fs::write(&two, with_header(&fs::read(&away).unwrap(), from, to)).unwrap();
        let message = folder.refused("out");
        assert!(message.contains(expected), "{message}");
    }
    fs::write(
        &two,
        with_header(&fs::read(&one).unwrap(), "\"number\":1", "\"number\":2"),
    )
    .unwrap();
    let message = folder.refused("out");
    assert!(
        message.contains("part-1-of-2.tiles and part-2-of-2.tiles both have tile"),
        "{message}"
    );
    // Of another number of parts.
    fs::copy(&away, &two).unwrap();
    folder.render(
        "seed_extended",
        &[&small[..], &["--part=3/3"]].concat(),
        "out",
    );
    let message = folder.refused("out");
    assert!(
        message.contains("part-3-of-3.tiles: it is part 3/3, and other parts are of 2"),
        "{message}"
    );
    fs::remove_file(folder.part("out", "part-3-of-3.tiles")).unwrap();
    // Foreign, and a folder.
    fs::write(folder.part("out", "mine.tiles"), "mine").unwrap();
    fs::create_dir(folder.part("out", "folder.tiles")).unwrap();
    let message = folder.refused("out");
    assert!(
        message.contains("mine.tiles: raycost did not write it"),
        "{message}"
    );
    assert!(message.contains("folder.tiles: "), "{message}");
}

/// The bytes of a file whose header has another text of the same length.
fn with_header(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    const BEGIN: usize = 16 + 24;
    let mut bytes = bytes.to_vec();
    let length = u32::from_le_bytes(bytes[20..24].try_into().unwrap()) as usize;
    let header = String::from_utf8(bytes[BEGIN..BEGIN + length].to_vec()).unwrap();
    let changed = header.replace(from, to);
    assert!(changed.len() == length && changed != header, "{header}");
    bytes[BEGIN..BEGIN + length].copy_from_slice(changed.as_bytes());
    let mut hasher = twox_hash::XxHash3_128::new();
    hasher.write(&bytes[16..24]);
    hasher.write(&0_u64.to_le_bytes());
    hasher.write(changed.as_bytes());
    bytes[24..BEGIN].copy_from_slice(&hasher.finish_128().to_le_bytes());
    bytes
}

#[test]
fn a_scene_that_changed_since_is_refused() {
    let folder = Folder::new();
    let text = fs::read_to_string(in_repository("configs/seed_sphere.yaml")).unwrap();
    let scene = folder.path("scene.yaml");
    fs::write(&scene, &text).unwrap();
    for part in ["--part=1/2", "--part=2/2"] {
        let flags = [
            "render",
            "scene.yaml",
            "--width=30",
            "--height=30",
            "--out=out",
            part,
        ];
        assert_success(&folder.run(&flags));
    }
    // Comments are no change.
    fs::write(&scene, format!("{text}\n# The end.\n")).unwrap();
    assert_success(&folder.run(&["merge", "out"]));
    fs::remove_file(folder.path("out/summary.json")).unwrap();
    for name in names(&folder.path("out")) {
        if name != "parts" {
            fs::remove_file(folder.path("out").join(name)).unwrap();
        }
    }
    fs::write(&scene, text.replace("radius: 1", "radius: 0.9")).unwrap();
    let message = folder.refused("out");
    assert!(message.contains("do not fit"), "{message}");
    fs::rename(&scene, folder.path("elsewhere.yaml")).unwrap();
    let message = folder.refused("out");
    assert!(
        message.contains("there is no scene `scene.yaml`"),
        "{message}"
    );
    assert!(message.contains("--scene"), "{message}");
    fs::write(folder.path("elsewhere.yaml"), &text).unwrap();
    assert_success(&folder.run(&["merge", "out", "--scene=elsewhere.yaml"]));
}

#[test]
fn parts_that_cannot_be_are_refused() {
    let folder = Folder::new();
    let refused: [(&[&str], &str); 6] = [
        (&["--part=17/16"], "the parts are 1/16 to 16/16"),
        (&["--part=0/4"], "the parts are 1/4 to 4/4"),
        (&["--part=1"], "such as 3/16"),
        (&["--part=1/2", "--profile"], "`--profile`"),
        (
            &["--part=1/2", "--hardware-counters"],
            "`--hardware-counters`",
        ),
        (&["--part=1/2", "--format=vtkhdf"], "raycost merge"),
    ];
    for (flags, expected) in refused {
        let command = ["render", "configs/seed_sphere.yaml", "--out=out"];
        let output = folder.run(&[&command, flags].concat());
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(expected), "{message}");
    }
    let output = folder.run(&["render", "-", "--part=1/2", "--out=out"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(!folder.path("out").exists());
    // A file of others is not replaced.
    fs::create_dir_all(folder.path("out/parts")).unwrap();
    let path = folder.part("out", "part-1-of-2.tiles");
    fs::write(&path, "mine").unwrap();
    let command = [
        "render",
        "configs/seed_sphere.yaml",
        "--out=out",
        "--part=1/2",
    ];
    assert_eq!(folder.run(&command).status.code(), Some(1));
    assert_eq!(fs::read(path).unwrap(), b"mine");
}

/// The job array of the book, each task of it with the variables that Slurm sets.
#[test]
fn the_job_array_of_the_book_renders_all_parts() {
    let page = fs::read_to_string(in_repository("docs/cluster.md")).unwrap();
    let scripts: Vec<&str> = page.split("```bash\n").skip(1).collect();
    let script = |name: &str| {
        let found = scripts
            .iter()
            .find(|text| text.contains(&format!("--job-name={name}")));
        found.unwrap().split("```").next().unwrap()
    };
    let folder = Folder::new();
    let program = PathBuf::from(env!("CARGO_BIN_EXE_raycost"));
    let path = format!("{}:/usr/bin:/bin", program.parent().unwrap().display());
    let array = script("parts").split("--array=1-").nth(1).unwrap();
    let n: u32 = array.lines().next().unwrap().parse().unwrap();
    let small = script("parts").replace("--quiet", "--quiet --width 40 --height 40 --spp 1");
    let bash = |script: &str| {
        let mut command = Command::new("bash");
        command.args(["-c", script]).current_dir(folder.0.path());
        command.env("PATH", &path).env("SLURM_CPUS_PER_TASK", "1");
        command
    };
    for task in 1..=n {
        let mut command = bash(&small);
        command.env("SLURM_ARRAY_TASK_ID", task.to_string());
        command.env("SLURM_ARRAY_TASK_COUNT", n.to_string());
        assert!(command.status().unwrap().success());
    }
    assert!(bash(script("merge")).status().unwrap().success());
    let out = names(&folder.path("out"));
    assert_success(&folder.run(&["check", &format!("out/{}", out[0])]));
}

/// As a run leaves it that ends between the last tile and the final name.
#[test]
fn a_whole_part_that_was_not_renamed_is_kept() {
    let folder = Folder::new();
    two_parts(&folder);
    let part = folder.part("out", "part-1-of-2.tiles");
    let bytes = fs::read(&part).unwrap();
    fs::rename(&part, part.with_extension("unfinished")).unwrap();
    two_parts(&folder);
    // Another rendering would have other times.
    assert_eq!(fs::read(&part).unwrap(), bytes);
    assert!(!part.with_extension("unfinished").exists());
}

#[test]
fn a_part_is_rendered_by_one_run_at_a_time() {
    let folder = Folder::new();
    let arguments = [
        "render",
        "configs/cornell_box.yaml",
        "--part=1/2",
        "--threads=1",
        "--quiet",
        "--out=out",
    ];
    let mut command = raycost();
    command.current_dir(folder.0.path()).args(arguments);
    let mut first = command.spawn().unwrap();
    // Its first bytes are written when it is locked.
    let path = folder.path("out/parts/part-1-of-2.unfinished");
    while path.metadata().map_or(0, |found| found.len()) == 0 {
        assert!(first.try_wait().unwrap().is_none());
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let second = folder.run(&arguments);
    first.kill().unwrap();
    first.wait().unwrap();
    let message = String::from_utf8(second.stderr).unwrap();
    assert_eq!(second.status.code(), Some(1), "{message}");
    assert!(message.contains("another run is writing it"), "{message}");
}
