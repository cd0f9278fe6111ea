//! Renderings that are killed, or end at a timeout, and go on.
#![cfg(unix)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::Duration;

use render::checkpoint::CheckpointFile;

use super::parts::Folder;
use crate::common::data_set::DataSet;
use crate::common::same_output::{assert_same_output, summary};
use crate::common::{assert_success, names, raycost, with_signals};

/// A rendering that takes some seconds.
struct Slow {
    folder: Folder,
    flags: Vec<&'static str>,
}

impl Slow {
    fn new(flags: &[&'static str]) -> Self {
        let scene = "configs/hall_of_mirrors.yaml";
        let small = ["render", scene, "--width=112", "--height=96", "--threads=2"];
        Self {
            folder: Folder::new(),
            flags: [&small, flags].concat(),
        }
    }

    fn command(&self, out: &str, more: &[&str]) -> Command {
        let mut command = raycost();
        command.current_dir(self.folder.0.path()).args(&self.flags);
        command.args(["--out", out]).args(more);
        command
    }

    fn run(&self, out: &str, more: &[&str]) -> Output {
        self.command(out, more).output().unwrap()
    }

    fn path(&self, out: &str) -> PathBuf {
        self.folder.path(out)
    }

    /// The finished tiles of an interrupted run.
    fn n_kept(&self, out: &str) -> usize {
        let file = CheckpointFile::open(&self.path(out).join("unfinished.tiles"));
        file.map_or(0, |file| file.n_tiles())
    }

    /// Starts a run that keeps its tiles, and waits until it has kept this many in all; it
    /// may end before.
    fn until(&self, out: &str, n_tiles: usize) -> Child {
        let mut command = self.command(out, &["--resume", "--quiet"]);
        let mut child = command.stderr(Stdio::null()).spawn().unwrap();
        while self.n_kept(out) < n_tiles && child.try_wait().unwrap().is_none() {
            sleep(Duration::from_millis(3));
        }
        child
    }

    /// Kills a run when it has kept this many tiles in all; returns how many there are.
    fn kill_at(&self, out: &str, n_tiles: usize) -> usize {
        let mut child = self.until(out, n_tiles);
        let _ = child.kill();
        child.wait().unwrap();
        self.n_kept(out)
    }
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_killed_rendering_goes_on_with_the_same_bytes() {
    // 42 tiles each time.
    let cases: [(&[&str], &[usize]); 3] = [
        (&["--cost=counters", "--spp=150"], &[1, 7, 8, 30]),
        (&["--cost=time", "--repeats=3", "--spp=40"], &[20, 50, 90]),
        (
            &[
                "--cost=single_ray_time",
                "--spp=150",
                "--also=objects,radiance",
            ],
            &[15],
        ),
    ];
    for (flags, kills) in cases {
        let slow = Slow::new(flags);
        assert_success(&slow.run("whole", &["--quiet"]));
        let mut n_kept = 0;
        for &at in kills {
            let before = n_kept;
            n_kept = slow.kill_at("out", at);
            assert!(n_kept >= before, "{n_kept} tiles, there were {before}");
        }
        let text = {
            let output = slow.run("out", &["--resume"]);
            assert_success(&output);
            stdout(&output)
        };
        println!("{n_kept} tiles survived the kills");
        if n_kept > 0 {
            let line = format!("resumed {n_kept} tile");
            assert!(text.contains(&line), "{text}");
            let summary = summary(&slow.path("out"));
            assert_eq!(summary["other_runs"]["n_tiles"], n_kept);
            let runs = &summary["other_runs"]["files"][0];
            assert!(
                runs["n_runs"].as_u64().unwrap() >= 1 && runs["cpu_ms"].as_f64().unwrap() > 0.0
            );
        }
        assert_same_output(&slow.path("whole"), &slow.path("out"));
        assert_success(&slow.folder.run(&["check", "out"]));
    }
}

/// Tears the end off, as a power cut does.
#[test]
fn a_torn_end_is_rendered_again() {
    let slow = Slow::new(&["--cost=counters", "--spp=200"]);
    assert_success(&slow.run("whole", &["--quiet"]));
    let n_kept = slow.kill_at("out", 12);
    assert!(n_kept > 0, "it has ended before it was killed");
    let path = slow.path("out").join("unfinished.tiles");
    let bytes = fs::read(&path).unwrap();
    // The kill itself may have left a torn end, of less than a tile.
    let two_less = bytes.len() - 2 * bytes.len() / n_kept;
    for (end, garbage) in [
        (bytes.len() - 1, 0),
        (bytes.len() - 1000, 300),
        (two_less, 9),
        (bytes.len() / 2, 9),
        (30, 0),
        (0, 0),
    ] {
        let torn = [&bytes[..end], &vec![7; garbage]].concat();
        fs::write(&path, torn).unwrap();
        let n_left = slow.n_kept("out");
        assert!(n_left <= n_kept && (n_left < n_kept || end > two_less));
        assert_success(&slow.run("out", &["--resume"]));
        assert!(!path.exists());
        assert_same_output(&slow.path("whole"), &slow.path("out"));
    }
}

#[test]
fn a_stopped_run_says_what_it_has_kept_and_how_to_go_on() {
    let slow = Slow::new(&["--cost=counters", "--spp=800"]);
    let mut command = with_signals(&[], &slow.command("out", &["--resume"]));
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    while slow.n_kept("out") < 5 {
        assert!(child.try_wait().unwrap().is_none(), "it has ended");
        sleep(Duration::from_millis(3));
    }
    let kill = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(kill.unwrap().success());
    let stopped = child.wait_with_output().unwrap();
    assert_eq!(stopped.status.code(), Some(130));
    let n_kept = slow.n_kept("out");
    let kept = format!("stopped: kept {n_kept} finished tiles in `out/unfinished.tiles`");
    let message = stderr(&stopped);
    assert!(message.contains(&kept), "{message}");
    assert!(
        message.contains("hall_of_mirrors.yaml --resume`"),
        "{message}"
    );
}

#[test]
fn what_an_interrupted_run_has_kept_is_not_lost() {
    let slow = Slow::new(&["--cost=counters", "--spp=800"]);
    let child = slow.until("out", 5);
    let kill = Command::new("kill")
        .args(["-TERM", &child.id().to_string()])
        .status();
    assert!(kill.unwrap().success());
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(143));
    let n_kept = slow.n_kept("out");
    assert!(n_kept >= 5);
    assert_eq!(names(&slow.path("out")), ["unfinished.tiles"]);
    let few = |more: &[&str]| slow.run("out", &[&["--max-depth=0"], more].concat());
    // Not of this scene.
    let other = few(&["--resume"]);
    assert_eq!(other.status.code(), Some(2));
    assert!(
        stderr(&other).contains("of other settings"),
        "{}",
        stderr(&other)
    );
    // Not replaced.
    let again = few(&["--timeout=1h"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(
        stderr(&again).contains(&format!("{n_kept} finished tiles")),
        "{}",
        stderr(&again)
    );
    let without = few(&[]);
    assert_success(&without);
    assert!(
        stdout(&without).contains("kept    out/unfinished.tiles"),
        "{}",
        stdout(&without)
    );
    assert_eq!(slow.n_kept("out"), n_kept);
    // A file of others.
    let path = slow.path("out").join("unfinished.tiles");
    fs::write(&path, "mine").unwrap();
    assert_eq!(few(&["--resume"]).status.code(), Some(1));
    assert_eq!(fs::read(&path).unwrap(), b"mine");
}

/// The partial output of a run that took over some tiles, and had no time for others.
#[test]
fn a_partial_output_has_whole_tiles_and_says_so_everywhere() {
    let also = "--also=objects,schedule,surface,bvh,exr";
    let slow = Slow::new(&["--cost=counters", "--spp=100", also]);
    assert_success(&slow.run("whole", &["--quiet"]));
    let n_kept = slow.kill_at("out", 12);
    assert!((12..42).contains(&n_kept), "{n_kept}");
    let output = slow.run("out", &["--resume", "--timeout=1ms"]);
    assert_eq!(output.status.code(), Some(4), "{output:?}");
    let last = stdout(&output).lines().last().unwrap().to_owned();
    let what = format!("{} of 42 tiles are missing", 42 - n_kept);
    assert!(last.contains(&what) && last.contains("--resume"), "{last}");
    let out = slow.path("out");
    let partial = &summary(&out)["partial"];
    assert_eq!(
        [&partial["n_missing_tiles"], &partial["n_tiles"]],
        [42 - n_kept, 42]
    );
    let mut n_marked = 0;
    for name in names(&out) {
        let bytes = fs::read(out.join(&name)).unwrap();
        let has = |text: &str| {
            bytes
                .windows(text.len())
                .any(|part| part == text.as_bytes())
        };
        match name.rsplit('.').next().unwrap() {
            "vti" | "vtu" | "vtp" => {
                let data = DataSet::read(&out.join(&name));
                assert_eq!(
                    data.texts("partial"),
                    [format!("partial: {what}")],
                    "{name}"
                );
            }
            "pvsm" | "json" | "exr" => assert!(has("partial"), "{name}"),
            "png" if name == "image.png" => assert!(has("partial: "), "{name}"),
            _ => continue,
        }
        n_marked += 1;
    }
    assert!(n_marked >= 12, "{n_marked}");
    for state in ["heatmap.pvsm", "geometry.pvsm"] {
        let text = fs::read_to_string(out.join(state)).unwrap();
        assert!(text.contains("(partial picture)"), "{state}");
    }
    assert_success(&slow.folder.run(&["view", "out"]));
    let page = fs::read_to_string(out.join("view.html")).unwrap();
    assert!(page.contains("(partial)</h1>") && page.contains(&what));
    assert_missing_tiles_are_empty(&out, &slow.path("whole"));
    let check = slow.folder.run(&["check", "out"]);
    assert_success(&check);
    assert!(stdout(&check).contains(&what));
    // It goes on.
    assert_success(&slow.run("out", &["--resume"]));
    fs::remove_file(out.join("view.html")).unwrap();
    assert_same_output(&slow.path("whole"), &out);
}

/// Checks every pixel of a partial output: it is that of the whole, or empty.
fn assert_missing_tiles_are_empty(out: &Path, whole: &Path) {
    let [found, expected] = [out, whole].map(|folder| DataSet::read(&folder.join("frame.vti")));
    let threads: Vec<i32> = found.array("thread").i32s().collect();
    let is_missing: Vec<bool> = threads.iter().map(|&thread| thread == -1).collect();
    let n_missing = is_missing.iter().filter(|&&missing| missing).count();
    assert!(n_missing > 0 && n_missing < is_missing.len());
    for array in &found.arrays {
        // Field data is shorter.
        let is_field = array.bytes.len() < is_missing.len();
        if is_field || ["thread", "tile", "pixel_x", "pixel_y"].contains(&&*array.name) {
            continue;
        }
        let stride = array.bytes.len() / is_missing.len();
        let empty: Vec<u8> = match &*array.name {
            "object" | "material" => (-1_i32).to_le_bytes().to_vec(),
            "Normals" | "distance" | "footprint" => f32::NAN.to_le_bytes().repeat(stride / 4),
            _ => vec![0; stride],
        };
        let wholes = expected.array(&array.name).bytes.chunks_exact(stride);
        let pixels = array.bytes.chunks_exact(stride).zip(wholes);
        for ((pixel, whole), &is_missing) in pixels.zip(&is_missing) {
            assert_eq!(
                pixel,
                if is_missing { &empty } else { whole },
                "{}",
                array.name
            );
        }
    }
    // Counters are exact.
    let totals = &summary(out)["cost"]["totals"];
    for name in [
        "node_visits",
        "primitive_tests",
        "rays",
        "shadow_rays",
        "reflection_rays",
    ] {
        let sum: u64 = found.array(name).u32s().map(u64::from).sum();
        assert_eq!(totals[name], sum, "{name}");
    }
}

#[test]
fn a_timeout_before_the_first_tile_leaves_an_empty_picture() {
    for cost in [
        "--cost=none",
        "--cost=counters",
        "--cost=time",
        "--cost=single_ray_time",
    ] {
        let slow = Slow::new(&["--spp=1", cost, "--also=objects,schedule,bvh,surface"]);
        let slow = if cost == "--cost=none" {
            Slow::new(&["--spp=1", cost])
        } else {
            slow
        };
        let output = slow.run("out", &["--timeout=0.001ms"]);
        assert_eq!(output.status.code(), Some(4), "{output:?}");
        assert_eq!(summary(&slow.path("out"))["n_hits"], 0);
        assert_success(&slow.run("out", &["--resume"]));
        assert_success(&slow.run("whole", &[]));
        assert_same_output(&slow.path("whole"), &slow.path("out"));
        // Time enough.
        assert_success(&slow.run("ample", &["--timeout=1h", "--quiet"]));
        assert_same_output(&slow.path("whole"), &slow.path("ample"));
    }
}

#[test]
fn frames_and_parts_go_on_after_a_timeout() {
    let folder = Folder::new();
    let command = [
        "render",
        "configs/hopper.yaml",
        "--width=24",
        "--height=24",
        "--spp=1",
    ];
    let flags = [&command[..], &["--frames=1..2", "--cost=counters"]].concat();
    let run = |more: &[&str]| folder.run(&[&flags, more].concat());
    assert_success(&run(&["--out=whole"]));
    let partial = run(&["--out=out", "--timeout=0.001ms"]);
    assert_eq!(partial.status.code(), Some(4), "{partial:?}");
    assert!(stdout(&partial).contains("partial: "), "{partial:?}");
    // A partial frame is no frame of the series.
    assert!(
        stdout(&partial).contains("missing 20 frames"),
        "{partial:?}"
    );
    assert_success(&run(&["--out=out", "--resume"]));
    let part = |more: &[&str]| run(&[&["--out=parts", "--part=1/1"], more].concat());
    let partial = part(&["--timeout=0.001ms"]);
    assert_eq!(partial.status.code(), Some(4), "{partial:?}");
    assert_eq!(folder.run(&["merge", "parts"]).status.code(), Some(2));
    assert_success(&part(&[]));
    assert_success(&folder.run(&["merge", "parts"]));
    for frame in ["frames/0001", "frames/0002"] {
        let [whole, resumed, merged] =
            ["whole", "out", "parts"].map(|out| folder.path(out).join(frame));
        assert_same_output(&whole, &resumed);
        assert_same_output(&whole, &merged);
    }
}

#[test]
fn a_timeout_without_a_unit_or_below_0_is_refused() {
    let folder = Folder::new();
    for flag in ["--timeout=5", "--timeout=-5s"] {
        let output = folder.run(&["render", "configs/seed_sphere.yaml", flag]);
        assert_eq!(output.status.code(), Some(2));
        let message = stderr(&output);
        assert!(message.contains("such as 90s"), "{message}");
    }
}
