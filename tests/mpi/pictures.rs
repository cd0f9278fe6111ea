//! Any number of ranks renders the same picture.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::data_set::DataSet;
use crate::common::same_output::{assert_same_output, summary};
use crate::common::{assert_success, raycost};
use crate::job::Job;

const SMALL: [&str; 2] = ["--width=70", "--height=50"];

#[test]
fn processes_of_one_launch_may_render_a_part_each() {
    let job = Job::new("seed_extended", &["--cost=counters", SMALL[0], SMALL[1]]);
    job.render_alone("alone");
    let mut command = job.launch();
    let script = "exec \"$0\" \"$@\" --part=$((OMPI_COMM_WORLD_RANK + 1))/2";
    command.args(["-n", "2", "sh", "-c", script, env!("CARGO_BIN_EXE_raycost")]);
    command
        .args(&job.arguments)
        .args(["--threads=1", "--out=out"]);
    assert_success(&command.output().unwrap());
    let mut merge = raycost();
    merge.current_dir(job.path("")).args(["merge", "out"]);
    assert_success(&merge.output().unwrap());
    assert_same_output(&job.path("alone"), &job.path("out"));
}

#[test]
fn ranks_render_the_same_picture_as_one_process() {
    let cases: [(&str, &[&str]); 7] = [
        ("seed_extended", &["--cost=none"]),
        (
            "still_life",
            &["--cost=counters", "--also=objects,schedule,radiance"],
        ),
        ("glass", &["--cost=time", "--repeats=3", "--tile-size=7"]),
        (
            "cornell_box",
            &["--cost=single_ray_time", "--spp=4", "--also=exr,bounces"],
        ),
        (
            "marbles",
            &[
                "--cost=counters",
                "--spp=16",
                "--set=image.sampler=sobol",
                "--set=image.adaptive={noise: 0.05, min_samples: 4}",
            ],
        ),
        (
            "cornell_box",
            &[
                "--cost=counters",
                "--spp=16",
                "--set=image.adaptive={by: efficiency, min_samples: 4}",
            ],
        ),
        ("spot", &["--cost=counters", "--tile-size=64"]),
    ];
    for (scene, flags) in cases {
        let job = Job::new(scene, &[&SMALL, flags].concat());
        job.render_alone("alone");
        for n in [1, 2, 3, 5] {
            let out = format!("ranks-{n}");
            job.render(n, &out, &["--quiet"]);
            assert_same_output(&job.path("alone"), &job.path(&out));
            let mut check = raycost();
            assert_success(&check.arg("check").arg(job.path(&out)).output().unwrap());
        }
    }
}

#[test]
fn repeats_of_ranks_move_groups() {
    for (repeats, has_squares) in [("--repeats=1", true), ("--repeats=3", false)] {
        let job = Job::new("seed_extended", &["--spp=1", SMALL[0], SMALL[1], repeats]);
        job.render(2, "out", &["--quiet"]);
        let notes = summary(&job.path("out"))["time_notes"].to_string();
        assert_eq!(notes.contains("squares"), has_squares, "{notes}");
    }
}

/// The numbers of an array of `tiles.vti`.
fn of_tiles(out: &Path, name: &str) -> Vec<i32> {
    let tiles = DataSet::read(&out.join("tiles.vti"));
    let array = tiles
        .arrays
        .iter()
        .find(|array| array.name == name)
        .unwrap();
    let bytes = array.bytes.as_chunks().0;
    bytes
        .iter()
        .map(|&bytes| i32::from_le_bytes(bytes))
        .collect()
}

#[test]
fn every_tile_has_its_rank() {
    let flags = ["--cost=counters", "--also=schedule", "--spp=64"];
    let job = Job::new("hall_of_mirrors", &[&SMALL[..], &flags].concat());
    let output = job.render(3, "out", &[]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("\nranks   3, load imbalance "), "{text}");
    let out = job.path("out");
    let (ranks, threads) = (of_tiles(&out, "rank"), of_tiles(&out, "thread"));
    // With one thread each, the thread among those of all ranks is the rank.
    assert_eq!(ranks, threads);
    let used: BTreeSet<i32> = ranks.iter().copied().collect();
    assert!(
        used.is_subset(&BTreeSet::from([0, 1, 2])) && used.len() > 1,
        "{used:?}"
    );
    let summary = summary(&out);
    assert_eq!(summary["threads"]["used"], 3);
    assert_eq!(summary["schedule"]["order"], "cost");
    let of_rank = summary["ranks"]["of_rank"].as_array().unwrap();
    for (number, rank) in of_rank.iter().enumerate() {
        let n_tiles = ranks.iter().filter(|&&rank| rank == number as i32).count();
        assert_eq!(rank["n_tiles"], n_tiles);
        assert_eq!(rank["threads"], 1);
        assert!(rank["affinity"][0].is_string());
        assert!(rank["busy_ms"].as_f64().unwrap() > 0.0 || n_tiles == 0);
    }
    // Each tile is an event of the process of its rank.
    let trace: Value = serde_json::from_slice(&fs::read(out.join("trace.json")).unwrap()).unwrap();
    let events = trace["traceEvents"].as_array().unwrap();
    let of_tiles = events
        .iter()
        .filter(|event| event["args"]["position"].is_u64());
    assert_eq!(of_tiles.clone().count(), ranks.len());
    let processes: BTreeSet<i64> = of_tiles
        .map(|event| event["pid"].as_i64().unwrap())
        .collect();
    assert_eq!(
        processes,
        used.iter().map(|&rank| i64::from(rank) + 1).collect()
    );
}

#[test]
fn pinned_ranks_of_one_machine_have_cpus_of_their_own() {
    let job = Job::new("blocks", &[&SMALL[..], &["--pin=cores"]].concat());
    job.render(2, "out", &["--quiet"]);
    let summary = summary(&job.path("out"));
    let [first, second] = [0, 1].map(|rank| &summary["ranks"]["of_rank"][rank]["affinity"][0]);
    assert!(first.is_string() && second.is_string());
    let n_cpus = std::thread::available_parallelism().unwrap().get();
    assert_eq!(first == second, n_cpus == 1, "{first} and {second}");
}

#[test]
fn one_process_has_no_ranks() {
    let job = Job::new("seed_sphere", &["--cost=counters", "--also=schedule"]);
    job.render_alone("out");
    assert!(summary(&job.path("out")).get("ranks").is_none());
    let tiles = DataSet::read(&job.path("out/tiles.vti"));
    assert!(tiles.arrays.iter().all(|array| array.name != "rank"));
}

/// Stops a process for most of the time.
const SLOW: &str = "self=$$
(while kill -STOP $self 2>/dev/null; do sleep 0.02; kill -CONT $self; sleep 0.002; done) &";

#[test]
fn a_slow_rank_renders_fewer_tiles() {
    let flags = [
        "--cost=counters",
        "--also=schedule",
        "--spp=48",
        "--width=160",
        "--height=120",
    ];
    let job = Job::new("hall_of_mirrors", &flags);
    job.render_alone("alone");
    let output = job.ranks(2, "out", &["--quiet"], SLOW).output().unwrap();
    assert_success(&output);
    assert_same_output(&job.path("alone"), &job.path("out"));
    let ranks = of_tiles(&job.path("out"), "rank");
    let n_slow = ranks.iter().filter(|&&rank| rank == 1).count();
    assert!(n_slow < ranks.len() / 3, "{n_slow} of {}", ranks.len());
}

#[test]
fn a_scene_from_standard_input_is_that_of_all_ranks() {
    let job = Job::new("seed_sphere", &["--cost=counters"]);
    job.render_alone("alone");
    let mut from_input = Job::new("seed_sphere", &["--cost=counters"]);
    from_input.arguments[1] = "-".to_owned();
    let mut command = from_input.ranks(3, "out", &["--quiet"], "");
    command.stdin(fs::File::open(job.path("configs/seed_sphere.yaml")).unwrap());
    assert_success(&command.output().unwrap());
    assert_same_output(&job.path("alone"), &from_input.path("out"));
}
