//! What happens when ranks differ, fail or are killed.

use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::Duration;

use crate::common::assert_success;
use crate::common::same_output::{assert_same_output, summary};
use crate::job::{Job, is_written};

/// Checks that a job ends with one message, which contains `expected`, and this exit code.
pub fn assert_refused(output: &Output, code: i32, expected: &str) {
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{message}");
    assert!(message.contains(expected), "{message}");
    assert_eq!(message.matches("error:").count(), 1, "{message}");
    assert!(output.stdout.is_empty());
}

#[test]
fn a_mistake_is_one_message() {
    let job = Job::new("seed_sphere", &["--cost=counters"]);
    for (flag, expected) in [
        ("--widht=3", "unexpected argument"),
        ("--set=image.widht=3", "unknown key `widht`"),
    ] {
        let output = job.ranks(3, "out", &[flag], "").output().unwrap();
        assert_refused(&output, 2, expected);
    }
    let missing = Job::new("nothing", &[]);
    let output = missing.ranks(3, "out", &[], "").output().unwrap();
    assert_refused(&output, 2, "cannot read the scene `configs/nothing.yaml`");
    assert!(!is_written(&job.path("out")));
}

#[test]
fn ranks_that_differ_are_named() {
    let job = Job::new("seed_sphere", &["--cost=counters"]);
    for (script, expected) in [
        (
            "set -- \"$@\" --spp=2",
            "it has the flags `--spp=2 --cost=counters`, and rank 0 `--cost=counters`",
        ),
        (
            "shift 2; set -- render configs/glass.yaml \"$@\"",
            "it renders `configs/glass.yaml`, and rank 0 `configs/seed_sphere.yaml`",
        ),
        ("set -- \"$@\" --widht=2", "unexpected argument"),
    ] {
        let output = job.ranks(2, "out", &[], script).output().unwrap();
        assert_refused(&output, 2, expected);
        assert_refused(&output, 2, "rank 1 ");
    }
    // What does not change the picture may differ.
    let more = "set -- \"$@\" --quiet --resume";
    assert_success(&job.ranks(2, "out", &[], more).output().unwrap());
}

#[test]
fn a_rank_without_its_threads_is_named() {
    let job = Job::new("seed_sphere", &["--cost=counters"]);
    let limit = "ulimit -v 2000000
        set -- render configs/seed_sphere.yaml --cost=counters --out out --threads=1000";
    let output = job.ranks(3, "out", &[], limit).output().unwrap();
    assert_refused(&output, 1, "cannot start the threads: ");
    assert_refused(&output, 1, "error: rank ");
    assert!(!is_written(&job.path("out")));
}

/// A job that takes some seconds.
fn slow_job() -> Job {
    let flags = [
        "--width=160",
        "--height=120",
        "--spp=640",
        "--cost=counters",
        "--also=schedule",
    ];
    Job::new("hall_of_mirrors", &flags)
}

/// Starts a job that keeps its tiles, and waits until it has kept some.
fn start(job: &Job, command: &mut Command) -> Child {
    let mut child = command
        .stderr(Stdio::null())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    while job.n_kept("out") < 8 && child.try_wait().unwrap().is_none() {
        sleep(Duration::from_millis(10));
    }
    child
}

fn kill(signal: &str, process: &str) {
    assert!(
        Command::new("kill")
            .args([signal, process])
            .status()
            .unwrap()
            .success()
    );
}

#[test]
fn a_job_whose_rank_was_killed_goes_on() {
    let job = slow_job();
    job.render_alone("alone");
    let mut command = job.ranks(
        3,
        "out",
        &["--resume"],
        "echo $$ > \"worker-$$\"; echo $$ > worker",
    );
    let mut child = start(&job, &mut command);
    let worker = std::fs::read_to_string(job.path("worker")).unwrap();
    kill("-KILL", worker.trim());
    assert!(!child.wait().unwrap().success());
    assert!(!is_written(&job.path("out")));
    let n_kept = job.n_kept("out");
    assert!(n_kept >= 8, "{n_kept}");
    // By another number of ranks.
    let output = job.render(2, "out", &["--resume"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains(&format!("resumed {n_kept} tiles")), "{text}");
    assert_same_output(&job.path("alone"), &job.path("out"));
    assert_eq!(summary(&job.path("out"))["other_runs"]["n_tiles"], n_kept);
}

#[test]
fn a_signal_ends_the_job_and_keeps_its_tiles() {
    let job = slow_job();
    let mut command = job.ranks(2, "out", &["--resume"], "");
    let mut child = start(&job, &mut command);
    kill("-TERM", &child.id().to_string());
    assert!(!child.wait().unwrap().success());
    assert!(!is_written(&job.path("out")) && job.n_kept("out") >= 8);
}

#[test]
fn a_timeout_ends_all_ranks() {
    let job = slow_job();
    let output = job
        .ranks(2, "out", &["--timeout=700ms"], "")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(4));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("\npartial "), "{text}");
    assert!(summary(&job.path("out"))["partial"]["n_missing_tiles"].as_u64() > Some(0));
}
