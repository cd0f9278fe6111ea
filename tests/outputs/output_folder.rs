//! The output folder of `raycost render`, and its messages.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use base::Keyword;
use serde_json::Value;
use tempfile::TempDir;

use output::writers::{Request, files};
use scene::config::{Config, CostMode, OptionalOutput};
use scene::yaml::Source;

use crate::common::data_set::DataSet;
use crate::common::{COUNTERS, assert_success, in_repository, names, raycost};

/// The files that a run of [`scene`] with these settings writes, sorted.
fn expected(cost: CostMode, optional: &[OptionalOutput]) -> Vec<&'static str> {
    let source = Source::read(&scene()).unwrap();
    let mut config: Config = source.parse().unwrap();
    config.cost = cost;
    optional
        .iter()
        .for_each(|output| config.output.add(*output));
    let request = Request {
        is_stored: false,
        vtkhdf: false,
        config: &config,
        is_profiled: false,
    };
    let wanted = files().filter(|file| file.is_wanted(&request));
    let mut names: Vec<&str> = wanted.map(|file| file.name).collect();
    names.sort_unstable();
    names
}

/// The files of every timed run.
fn expected_of_every_run() -> Vec<&'static str> {
    expected(CostMode::Time, &[])
}

#[test]
fn the_docs_list_every_file() {
    let docs = fs::read_to_string(in_repository("docs/outputs.md")).unwrap();
    for file in files() {
        let row = format!("| `{}` |", file.name);
        assert!(docs.contains(&row), "no row begins with {row}");
    }
}

#[test]
fn every_optional_output_but_an_array_has_a_file() {
    let n_without = expected_of_every_run().len();
    for output in OptionalOutput::KEYWORDS {
        let n_with = expected(CostMode::Time, &[*output]).len();
        let is_array = matches!(
            output,
            OptionalOutput::Radiance
                | OptionalOutput::Noise
                | OptionalOutput::Bounces
                | OptionalOutput::Groups
                | OptionalOutput::Tests
        );
        assert_eq!(n_with > n_without, !is_array, "{output:?}");
    }
}

#[test]
fn every_file_is_there_and_no_other() {
    let temporary = temporary();
    let out = temporary.path().join("not there yet/out");
    assert_success(&render(&out).output().unwrap());
    assert_eq!(names(&out), expected_of_every_run());
    for file in expected_of_every_run() {
        assert!(fs::metadata(out.join(file)).unwrap().len() > 0, "{file}");
    }
}

#[test]
fn the_scenes_name_is_the_default_folder() {
    let temporary = temporary();
    let mut command = raycost();
    command.arg("render").arg(scene()).current_dir(&temporary);
    assert_success(&command.args(["--width=8", "--height=6"]).output().unwrap());
    assert_eq!(
        names(&temporary.path().join("out/seed_extended")),
        expected_of_every_run()
    );
}

#[test]
fn a_second_run_overwrites_the_first() {
    let temporary = temporary();
    let out = temporary.path();
    assert_success(&render(out).output().unwrap());
    assert_success(&render_at([20, 10], out).output().unwrap());
    assert_eq!(names(out), expected_of_every_run());
    let picture = image::open(out.join("image.png")).unwrap();
    assert_eq!((picture.width(), picture.height()), (20, 10));
    let frame = DataSet::read(&out.join("frame.vti"));
    assert_eq!(frame.extent, Some([0, 19, 0, 9, 0, 0]));
    assert_eq!(summary(out)["image"]["width"], 20);
}

#[test]
fn a_run_without_cost_removes_the_files_of_an_earlier_cost() {
    let temporary = temporary();
    let out = temporary.path();
    assert_success(&render(out).output().unwrap());
    fs::write(out.join("notes.txt"), "the user's own").unwrap();
    assert_success(&render(out).arg("--no-cost").output().unwrap());
    let mut left = expected(CostMode::None, &[]);
    assert!(left.len() < expected_of_every_run().len());
    let n_listed = left.len() - 1;
    left.push("notes.txt");
    left.sort_unstable();
    assert_eq!(names(out), left);
    let summary = summary(out);
    assert_eq!(summary["cost"]["mode"], "none");
    assert_eq!(summary["cost"]["totals"], Value::Null);
    assert_eq!(summary["files"].as_array().unwrap().len(), n_listed);
}

#[test]
fn the_schedule_is_written_on_request_and_removed_later() {
    let temporary = temporary();
    let out = temporary.path();
    for cost in [CostMode::Time, CostMode::None] {
        let flag = match cost {
            CostMode::None => "--cost=none",
            _ => "--cost=time",
        };
        let with_schedule = expected(cost, &[OptionalOutput::Schedule]);
        assert_eq!(with_schedule.len(), expected(cost, &[]).len() + 3);
        let command = &mut render(out);
        assert_success(&command.args(["--also=schedule", flag]).output().unwrap());
        assert_eq!(names(out), with_schedule);
    }
    assert_success(&render(out).output().unwrap());
    assert_eq!(names(out), expected_of_every_run());
    // The summary always has it.
    assert_eq!(summary(out)["schedule"]["n_tiles"], 6);
}

#[test]
fn counters_alone_have_no_times() {
    let temporary = temporary();
    let out = temporary.path();
    assert_success(&render(out).arg("--cost=counters").output().unwrap());
    assert_eq!(names(out), expected_of_every_run());
    let frame = DataSet::read(&out.join("frame.vti"));
    assert!(frame.arrays.iter().all(|array| array.name != "time_ns"));
    let cost = &summary(out)["cost"];
    assert_eq!(
        (&cost["mode"], &cost["kernel"]),
        (&"counters".into(), &"stream".into())
    );
    assert_eq!(
        (&cost["clock"], &cost["totals"]["time_ns"]),
        (&Value::Null, &Value::Null)
    );
    // Rays that are traced one by one.
    let single = render(out)
        .args(["--cost=counters", "--traversal=single"])
        .output();
    assert_success(&single.unwrap());
    assert_eq!(summary(out)["cost"]["kernel"], "single_ray");
    let state = fs::read_to_string(out.join("heatmap.pvsm")).unwrap();
    assert!(state.contains("log10(max(node_visits,") && state.contains("primitive_tests"));
    assert!(!state.contains("\"time_ns\""), "{state}");
}

#[test]
fn the_summary_agrees_with_the_files_and_with_itself() {
    let temporary = temporary();
    let out = temporary.path();
    assert_success(&render(out).arg("--spp=3").output().unwrap());
    let summary = summary(out);

    // Every file except the summary itself, with its length.
    let mut listed = Vec::new();
    for file in summary["files"].as_array().unwrap() {
        let name = file["file"].as_str().unwrap();
        assert_eq!(file["bytes"], fs::metadata(out.join(name)).unwrap().len());
        listed.push(name);
    }
    listed.sort();
    let mut expected = expected_of_every_run();
    expected.retain(|file| *file != "summary.json");
    assert_eq!(listed, expected);

    // Totals: sums of the arrays, and of one another.
    let totals = &summary["cost"]["totals"];
    let total = |name: &str| totals[name].as_u64().unwrap_or_else(|| panic!("{name}"));
    let frame = DataSet::read(&out.join("frame.vti"));
    let sum = |name: &str| frame.array(name).u32s().map(u64::from).sum::<u64>();
    for counter in &COUNTERS[..7] {
        assert_eq!(total(counter), sum(counter), "{counter}");
    }
    assert_eq!(
        total("depth"),
        u64::from(frame.array("depth").u32s().max().unwrap())
    );
    let kinds = [
        "camera_rays",
        "shadow_rays",
        "reflection_rays",
        "refraction_rays",
        "diffuse_rays",
    ];
    assert_eq!(total("rays"), kinds.map(total).iter().sum::<u64>());
    assert_eq!(total("camera_rays"), 40 * 30 * 3);
    assert!(totals["time_ns"].as_f64().unwrap() >= 40.0 * 30.0);

    assert_eq!(summary["n_pixels"], 40 * 30);
    let hits = DataSet::read(&out.join("hits.vtu"));
    assert_eq!(summary["n_hits"], hits.n_points);
}

#[test]
fn the_last_line_opens_the_state_in_a_shell() {
    let temporary = temporary();
    let out = temporary.path().join("it's ü & two  blanks");
    for (arguments, state) in [(&[][..], "heatmap.pvsm"), (&["--no-cost"], "geometry.pvsm")] {
        let output = render(&out).args(arguments).output().unwrap();
        assert_success(&output);
        let text = String::from_utf8(output.stdout).unwrap();
        let (_, command) = text.trim_end().rsplit_once("\nnext    ").unwrap();
        assert!(command.starts_with("paraview "), "{command}");
        if cfg!(unix) {
            let echo = format!("paraview() {{ printf %s \"$*\"; }}; {command}");
            let typed = Command::new("sh").args(["-c", &echo]).output().unwrap();
            let typed = String::from_utf8(typed.stdout).unwrap();
            assert_eq!(typed, format!("--state={}", out.join(state).display()));
        }
    }
    assert!(out.join("image.png").is_file());
}

#[test]
fn quiet_prints_nothing() {
    let temporary = temporary();
    let output = render(temporary.path()).arg("--quiet").output().unwrap();
    assert_success(&output);
    assert!(
        output.stdout.is_empty() && output.stderr.is_empty(),
        "{output:?}"
    );
    assert_eq!(names(temporary.path()), expected_of_every_run());
}

#[test]
fn an_impossible_folder_is_refused() {
    let temporary = temporary();
    let file = temporary.path().join("file");
    fs::write(&file, "in the way").unwrap();
    for out in [file.clone(), file.join("below")] {
        assert_refused(&render(&out).output().unwrap());
    }
    assert_eq!(names(temporary.path()), ["file"]);
    assert_eq!(fs::read(&file).unwrap(), b"in the way");
}

/// Even root cannot create a file in `/sys`.
#[test]
#[cfg(target_os = "linux")]
fn a_read_only_folder_is_refused() {
    let before = names(Path::new("/sys"));
    let output = render(Path::new("/sys")).output().unwrap();
    assert_refused(&output);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(
        message.contains("a folder that you may write to"),
        "{message}"
    );
    assert_eq!(names(Path::new("/sys")), before);
}

/// A limit on the length of files simulates a disk that becomes full: `image.png` fits,
/// the VTK files do not.
#[test]
#[cfg(unix)]
fn a_run_that_fails_half_way_leaves_the_old_files() {
    let temporary = temporary();
    let out = temporary.path();
    assert_success(&render(out).output().unwrap());
    let contents = || -> Vec<_> {
        let files = expected_of_every_run().into_iter();
        files
            .map(|file| fs::read(out.join(file)).unwrap())
            .collect()
    };
    let before = contents();
    let large = render_at([300, 200], out);
    let output = in_shell("trap '' XFSZ; ulimit -f 1000", &large)
        .output()
        .unwrap();
    assert_refused(&output);
    let message = String::from_utf8_lossy(&output.stderr);
    let of_vtk = ["hits.vtu", "frame.vti"].map(|file| message.contains(file));
    assert!(of_vtk.contains(&true), "{message}");
    assert_eq!(names(out), expected_of_every_run());
    assert!(contents() == before, "a file has changed");
}

#[test]
#[cfg(unix)]
fn files_have_the_permissions_of_any_other_program() {
    use std::os::unix::fs::PermissionsExt;
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    for (umask, file_mode) in [("022", 0o644), ("027", 0o640), ("002", 0o664)] {
        let temporary = temporary();
        let out = temporary.path().join("out");
        assert_success(
            &in_shell(&format!("umask {umask}"), &render(&out))
                .output()
                .unwrap(),
        );
        assert_eq!(
            mode(&out),
            file_mode | 0o111 & !u32::from_str_radix(umask, 8).unwrap()
        );
        for file in expected_of_every_run() {
            assert_eq!(mode(&out.join(file)), file_mode, "{file}, umask {umask}");
        }
    }
}

/// The command that renders a small picture into `out`.
fn render(out: &Path) -> Command {
    render_at([40, 30], out)
}

fn render_at([width, height]: [u32; 2], out: &Path) -> Command {
    let mut command = raycost();
    command.arg("render").arg(scene()).arg("--out").arg(out);
    command.args([format!("--width={width}"), format!("--height={height}")]);
    command
}

/// Runs the command in a shell after `before`.
#[cfg(unix)]
fn in_shell(before: &str, command: &Command) -> Command {
    let mut shell = Command::new("sh");
    shell
        .arg("-c")
        .arg(format!("{before}; exec \"$@\""))
        .arg("sh");
    shell.arg(command.get_program()).args(command.get_args());
    shell
}

fn scene() -> PathBuf {
    in_repository("configs/seed_extended.yaml")
}

fn temporary() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn summary(out: &Path) -> Value {
    serde_json::from_slice(&fs::read(out.join("summary.json")).unwrap()).unwrap()
}

/// Checks exit code 1 and a message on standard error only.
fn assert_refused(output: &Output) {
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(
        output.stdout.is_empty(),
        "{}",
        String::from_utf8_lossy(&output.stdout)
    );
    assert!(
        message.contains("cannot write") && message.contains("--out"),
        "{message}"
    );
}
