//! Runs that are stopped, killed or refused leave one complete run and all files of
//! others.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::MetadataExt;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::Duration;

use crate::common::{assert_success, in_repository, names, raycost, with_signals};

const SIGKILL: i32 = 9;

/// A run of a small picture of this width into a folder.
fn render(out: &Path, width: u32) -> Command {
    let mut command = raycost();
    command.arg("render").arg("--quiet").arg("--out").arg(out);
    command.arg(in_repository("configs/seed_extended.yaml"));
    command.args([format!("--width={width}"), "--height=60".to_owned()]);
    command
}

/// Starts a run that takes hours, and waits until it writes to its folder.
fn endless(out: &Path, flags: &[&str]) -> Child {
    endless_with_signals(&[], out, flags)
}

/// Starts an endless run with these flags of [`with_signals`].
fn endless_with_signals(signals: &[&str], out: &Path, flags: &[&str]) -> Child {
    let mut command = raycost();
    command.arg("render").arg("--quiet").arg("--out").arg(out);
    command.arg(in_repository("configs/hall_of_mirrors.yaml"));
    let mut child = with_signals(signals, command.args(["--spp=60000"]).args(flags))
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    while !is_locked(out) {
        if child.try_wait().unwrap().is_some() {
            panic!(
                "it has ended: {}",
                message(&child.wait_with_output().unwrap())
            );
        }
        sleep(Duration::from_millis(5));
    }
    child
}

/// Whether a run has a workspace for the folder.
fn is_locked(folder: &Path) -> bool {
    let file = fs::File::open(folder);
    file.is_ok_and(|file| file.try_lock().is_err())
}

fn signal(child: &Child, name: &str) {
    let kill = Command::new("kill")
        .args([&format!("-{name}"), &child.id().to_string()])
        .status();
    assert!(kill.unwrap().success());
}

fn check(out: &Path) -> Output {
    raycost().arg("check").arg(out).output().unwrap()
}

fn message(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A folder with a complete run and a file of the user.
fn rendered(out: &Path) {
    assert_success(&render(out, 80).output().unwrap());
    fs::write(out.join("notes.txt"), "mine").unwrap();
}

/// Kills runs at moments spread over their duration; returns how many were killed, and how many left
/// a part of a run, which `check` names.
fn kill_runs(out: &Path, n_tries: u32) -> [u32; 2] {
    rendered(out);
    let begin = std::time::Instant::now();
    assert_success(&render(out, 90).output().unwrap());
    let whole = begin.elapsed();
    let [mut n_killed, mut n_unfinished] = [0; 2];
    for number in 0..n_tries {
        // The second half of a run writes files.
        let mut child = render(out, [80, 90][number as usize % 2]).spawn().unwrap();
        sleep(whole * (number + 1) / (n_tries + 1));
        let _ = child.kill();
        let status = child.wait().unwrap();
        n_killed += u32::from(status.signal() == Some(SIGKILL));
        assert_eq!(fs::read(out.join("notes.txt")).unwrap(), b"mine");
        let checked = check(out);
        if checked.status.success() {
            let width = image::open(out.join("image.png")).unwrap().width();
            assert!([80, 90].contains(&width));
        } else {
            assert_unfinished(&checked);
            n_unfinished += 1;
        }
    }
    assert_success(&render(out, 80).output().unwrap());
    assert_success(&check(out));
    [n_killed, n_unfinished]
}

/// Checks that a reader has refused a folder because a run was killed while it replaced files.
fn assert_unfinished(reader: &Output) {
    assert_eq!(reader.status.code(), Some(2), "{reader:?}");
    let said = message(reader);
    assert!(said.contains("only a part of its files"), "{said}");
    assert!(said.contains("render again"), "{said}");
}

#[test]
fn a_killed_run_leaves_one_whole_run() {
    let temporary = tempfile::tempdir().unwrap();
    let out = temporary.path().join("out");
    let [n_killed, n_unfinished] = kill_runs(&out, 25);
    println!("{n_killed} runs were killed");
    assert_eq!(n_unfinished, 0);
    assert_eq!(names(temporary.path()), ["out"]);
    assert!(names(&out).iter().all(|name| !name.starts_with('.')));
}

/// A folder of the user in the output folder prevents the exchange of folders.
#[test]
fn a_killed_run_leaves_what_readers_recognize_where_folders_cannot_be_exchanged() {
    let temporary = tempfile::tempdir().unwrap();
    let out = temporary.path().join("out");
    fs::create_dir_all(out.join("mine")).unwrap();
    let [n_killed, n_unfinished] = kill_runs(&out, 25);
    println!("{n_killed} runs were killed, {n_unfinished} left a part");
    assert_eq!(names(temporary.path()), ["out"]);
    assert!(names(&out).iter().all(|name| !name.starts_with('.')));
    assert!(out.join("mine").is_dir());
}

/// The state of a folder if the run is killed after it has moved two old files away.
#[test]
fn readers_name_a_part_of_a_run_and_the_next_run_replaces_it() {
    let temporary = tempfile::tempdir().unwrap();
    let [out, other] = ["out", "other"].map(|name| temporary.path().join(name));
    rendered(&out);
    rendered(&other);
    let before = names(&out);
    let left = out.join(".raycost-0");
    fs::create_dir(&left).unwrap();
    let number = fs::metadata(&left).unwrap().ino();
    let [new, old] = ["new", "old"].map(|name| left.join(format!("{name}-{number}")));
    fs::create_dir(&new).unwrap();
    fs::create_dir(&old).unwrap();
    fs::write(new.join("summary.json"), "{}").unwrap();
    for name in ["summary.json", "image.png"] {
        fs::rename(out.join(name), old.join(name)).unwrap();
    }
    let unfinished = names(&out);
    assert_unfinished(&check(&out));
    let read = |command: &str, folders: &[&Path]| {
        let mut reader = raycost();
        reader.arg(command).args(folders).output().unwrap()
    };
    assert_unfinished(&read("view", &[&out]));
    assert_unfinished(&read("diff", &[&other, &out]));
    // A run that ends before it commits.
    let child = endless(&out, &["--cost=counters"]);
    signal(&child, "TERM");
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(143));
    assert_eq!(names(&out), unfinished);
    assert_success(&render(&out, 80).output().unwrap());
    assert_eq!(names(&out), before);
    assert_success(&check(&out));
}

#[test]
fn a_run_that_may_open_few_files_leaves_nothing_behind() {
    let temporary = tempfile::tempdir().unwrap();
    let out = temporary.path().join("out");
    fs::create_dir(&out).unwrap();
    let mut n_failed = 0;
    for n_files in 4..20 {
        let run = render(&out, 40);
        let mut limited = Command::new("bash");
        let limit = format!("ulimit -n {n_files}; exec \"$@\"");
        limited.args(["-c", &limit, "bash"]).arg(run.get_program());
        let output = limited.args(run.get_args()).output().unwrap();
        n_failed += u32::from(!output.status.success());
        let names = [names(temporary.path()), names(&out)].concat();
        let is_left = |name: &String| name.starts_with(".raycost-");
        assert!(!names.iter().any(is_left), "{n_files}: {names:?}");
    }
    assert!(n_failed > 0);
}

#[test]
fn a_signal_ends_a_run_and_removes_its_files() {
    for (name, code) in [("INT", 130), ("TERM", 143), ("HUP", 129)] {
        for flags in [&["--cost=time", "--repeats=1"][..], &["--cost=counters"]] {
            let temporary = tempfile::tempdir().unwrap();
            let out = temporary.path().join("out");
            rendered(&out);
            let before = names(&out);
            let child = endless(&out, flags);
            signal(&child, name);
            let output = child.wait_with_output().unwrap();
            assert_eq!(output.status.code(), Some(code), "{name}");
            assert_eq!(message(&output), "");
            assert_eq!(names(&out), before);
            assert_eq!(names(temporary.path()), ["out"]);
            assert_success(&check(&out));
        }
    }
}

/// As by `nohup`, or in the background of a script.
#[test]
fn a_signal_that_was_ignored_at_the_start_stays_ignored() {
    for (ignored, ending, code) in [
        ("HUP", "TERM", 143),
        ("INT", "TERM", 143),
        ("TERM", "INT", 130),
    ] {
        let temporary = tempfile::tempdir().unwrap();
        let out = temporary.path().join("out");
        let signals = format!("--ignore-signal={ignored}");
        let mut child = endless_with_signals(&[&signals], &out, &["--cost=counters"]);
        signal(&child, ignored);
        // Longer than a run takes to end.
        for _ in 0..20 {
            sleep(Duration::from_millis(50));
            assert_eq!(child.try_wait().unwrap(), None, "{ignored}");
        }
        signal(&child, ending);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{ignored}");
    }
}

#[test]
fn a_second_run_is_refused_and_the_first_goes_on() {
    let temporary = tempfile::tempdir().unwrap();
    let out = temporary.path().join("out");
    let first = endless(&out, &["--cost=counters"]);
    let second = render(&out, 80).output().unwrap();
    assert_eq!(second.status.code(), Some(1));
    assert!(message(&second).contains("another run"), "{second:?}");
    signal(&first, "TERM");
    assert_eq!(first.wait_with_output().unwrap().status.code(), Some(143));
    assert_success(&render(&out, 80).output().unwrap());
}

/// SIGXFSZ, the signal of a file that is too long, does not end a run silently.
#[test]
fn a_limit_on_a_files_length_is_a_message() {
    let temporary = tempfile::tempdir().unwrap();
    let out = temporary.path().join("out");
    rendered(&out);
    let large = render(&out, 900);
    let mut shell = Command::new("sh");
    shell.args(["-c", "ulimit -f 200; exec \"$@\"", "sh"]);
    shell.arg(large.get_program()).args(large.get_args());
    let output = shell.output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(message(&output).contains("ulimit -f"), "{output:?}");
    assert_success(&check(&out));
}

#[test]
fn files_of_others_are_refused_before_the_first_ray() {
    for name in ["objects.csv", "trace.json", "cost.png", "summary.json"] {
        for flags in [&["--no-cost"][..], &["--also=objects"]] {
            let temporary = tempfile::tempdir().unwrap();
            fs::write(temporary.path().join(name), "{}").unwrap();
            let output = render(temporary.path(), 80).args(flags).output().unwrap();
            assert_eq!(output.status.code(), Some(1), "{name}");
            assert!(message(&output).contains(name), "{output:?}");
            assert_eq!(names(temporary.path()), [name]);
            assert_eq!(fs::read(temporary.path().join(name)).unwrap(), b"{}");
        }
    }
}

#[test]
fn rendering_and_tracing_share_a_folder() {
    let temporary = tempfile::tempdir().unwrap();
    let out = temporary.path();
    rendered(out);
    let trace = || {
        let mut command = raycost();
        command.arg("trace").arg("--quiet").arg("--out").arg(out);
        command.arg(in_repository("configs/seed_extended.yaml"));
        assert_success(&command.args(["--pixel", "3,3"]).output().unwrap());
    };
    trace();
    assert_success(&check(out));
    trace();
    assert_success(&render(out, 90).output().unwrap());
    for name in ["rays.vtp", "rays_cloud.vtu", "rays.pvsm", "notes.txt"] {
        assert!(out.join(name).is_file(), "{name}");
    }
    assert_success(&check(out));
}

#[test]
fn a_folder_of_two_runs_and_a_damaged_one_are_refused() {
    let temporary = tempfile::tempdir().unwrap();
    let [a, b] = ["a", "b"].map(|name| temporary.path().join(name));
    for (out, spp) in [(&a, "--spp=1"), (&b, "--spp=2")] {
        assert_success(&render(out, 80).arg(spp).output().unwrap());
    }
    assert_success(&check(&a));
    // The same size, the same hits: only the run differs.
    fs::copy(b.join("frame.vti"), a.join("frame.vti")).unwrap();
    let view = raycost().arg("view").arg(&a).output().unwrap();
    assert_eq!(view.status.code(), Some(2));
    assert!(message(&view).contains("different renderings"), "{view:?}");
    let diff = raycost().arg("diff").args([&a, &b]).output().unwrap();
    assert_eq!(diff.status.code(), Some(2));
    assert_eq!(check(&a).status.code(), Some(2));

    let path = b.join("image.png");
    let mut bytes = fs::read(&path).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&path, &bytes).unwrap();
    fs::remove_file(b.join("cost.png")).unwrap();
    let checked = check(&b);
    assert_eq!(checked.status.code(), Some(2));
    let said = message(&checked);
    assert!(said.contains("image.png: its checksum"), "{said}");
    assert!(said.contains("cost.png: it is missing"), "{said}");
    assert!(!said.contains("hits.vtu"), "{said}");
}

#[test]
fn equal_runs_are_equal_bytes() {
    let temporary = tempfile::tempdir().unwrap();
    let [a, b] = ["a", "b"].map(|name| temporary.path().join(name));
    for (out, threads) in [(&a, "--threads=1"), (&b, "--threads=2")] {
        let flags = ["--cost=none", threads];
        assert_success(&render(out, 80).args(flags).output().unwrap());
    }
    for name in ["frame.vti", "hits.vtu"] {
        assert!(fs::read(a.join(name)).unwrap() == fs::read(b.join(name)).unwrap());
    }
}

#[test]
fn a_page_is_written_to_regular_files_only() {
    let temporary = tempfile::tempdir().unwrap();
    let out = temporary.path().join("out");
    rendered(&out);
    let fifo = temporary.path().join("fifo");
    assert!(
        Command::new("mkfifo")
            .arg(&fifo)
            .status()
            .unwrap()
            .success()
    );
    let mine = temporary.path().join("mine.html");
    fs::write(&mine, "mine").unwrap();
    for path in [Path::new("/dev/null"), &fifo, &mine, &out] {
        let mut view = raycost();
        let output = view.arg("view").arg(&out).arg("--out").arg(path).output();
        let output = output.unwrap();
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        assert!(
            message(&output).contains(&*path.to_string_lossy()),
            "{output:?}"
        );
    }
    assert_eq!(fs::read(&mine).unwrap(), b"mine");
    assert_eq!(names(temporary.path()), ["fifo", "mine.html", "out"]);
}
