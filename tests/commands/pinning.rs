//! `--pin cores` gives each thread a CPU, and changes nothing else.
#![cfg(target_os = "linux")]

use std::collections::HashSet;

use serde_json::Value;

use crate::common::{assert_success, in_repository, raycost};

#[test]
fn each_thread_has_a_cpu_and_the_picture_is_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let mut pictures = Vec::new();
    for pin in ["none", "cores"] {
        let out = folder.path().join(pin);
        let mut command = raycost();
        command
            .arg("render")
            .arg(in_repository("configs/blocks.yaml"));
        command.args(["--width=40", "--height=30", "--cost=counters", "--json"]);
        command.args(["--pin", pin]).arg("--out").arg(&out);
        let run = command.output().unwrap();
        assert_success(&run);
        let summary: Value = serde_json::from_slice(&run.stdout).unwrap();
        let threads = &summary["threads"];
        assert_eq!(threads["pin"], pin);
        let affinity = threads["affinity"].as_array().unwrap();
        assert_eq!(affinity.len() as u64, threads["used"].as_u64().unwrap());
        let places = affinity.iter().map(|cpus| cpus.as_str().unwrap());
        let places: HashSet<&str> = places.collect();
        if pin == "cores" {
            assert!(
                places.iter().all(|cpu| cpu.parse::<u32>().is_ok()),
                "{places:?}"
            );
            assert_eq!(places.len(), affinity.len());
        } else {
            assert_eq!(places.len(), 1);
        }
        pictures.push(image::open(out.join("image.png")).unwrap());
    }
    assert!(pictures[0] == pictures[1]);
}

/// Two processes of a launch, each started by itself.
#[test]
fn processes_of_one_machine_take_cpus_in_turn() {
    let folder = tempfile::tempdir().unwrap();
    let cpu = |local_rank: &str| {
        let mut command = raycost();
        command.env("OMPI_COMM_WORLD_LOCAL_RANK", local_rank);
        command
            .arg("render")
            .arg(in_repository("configs/blocks.yaml"));
        command.args([
            "--width=8",
            "--height=8",
            "--threads=1",
            "--pin=cores",
            "--json",
        ]);
        command.arg("--out").arg(folder.path().join(local_rank));
        let run = command.output().unwrap();
        assert_success(&run);
        let summary: Value = serde_json::from_slice(&run.stdout).unwrap();
        summary["threads"]["affinity"][0].clone()
    };
    let n_cpus = host::affinity::allowed_cpus().unwrap().len();
    assert_eq!(cpu("0"), cpu(&n_cpus.to_string()));
    assert_eq!(cpu("0") == cpu("1"), n_cpus == 1);
}

#[test]
fn more_threads_than_cpus_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = raycost();
    command
        .arg("render")
        .arg(in_repository("configs/blocks.yaml"));
    command
        .args(["--pin=cores", "--threads=1024", "--out"])
        .arg(folder.path());
    let run = command.output().unwrap();
    let message = String::from_utf8(run.stderr).unwrap();
    assert_eq!(run.status.code(), Some(2), "{message}");
    assert!(message.contains("there are 1024, but only"), "{message}");
    assert!(message.contains("use `--threads "), "{message}");
}
