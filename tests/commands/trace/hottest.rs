//! `--hottest` finds the most expensive pixels, and `raycost render` names one.

use std::process::Command;

use super::trace;
use crate::common::data_set::DataSet;
use crate::common::{assert_success, config, counts, film, in_repository, raycost, with_cost};
use raycost::config::CostMode;
use raycost::cost::Counter;

/// The slow twin: sorts all pixels by their counts; equal counts keep the order of the
/// picture.
fn highest(counts: &[u32], width: usize, n: usize) -> Vec<String> {
    let mut pixels: Vec<usize> = (0..counts.len()).collect();
    pixels.sort_by_key(|&i| (std::cmp::Reverse(counts[i]), i));
    let place = |i: &usize| format!("{},{}", i % width, i / width);
    pixels[..n].iter().map(place).collect()
}

#[test]
fn the_hottest_pixels_by_a_counter_are_the_same_each_time() {
    let mut config = with_cost(config("hall_of_mirrors"), CostMode::Counters);
    (config.image.width, config.image.height) = (64, 40);
    let film = film(&config, 2);
    let metrics = [
        ("node_visits", Counter::NodeVisits),
        // Many pixels have the same depth.
        ("depth", Counter::Depth),
    ];
    for (metric, counter) in metrics {
        let counts = counts(&film, counter);
        let expected = highest(&counts, 64, 5);
        for threads in ["--threads=1", "--threads=2"] {
            let out = tempfile::tempdir().unwrap();
            let by = format!("--by={metric}");
            let flags = ["--width=64", "--height=40", "--hottest=5", &by, threads];
            let printed = trace("hall_of_mirrors", out.path(), &flags);
            let (_, found) = printed
                .split_once(&format!("hottest by {metric}: "))
                .unwrap();
            let found = found.lines().next().unwrap().split(", ");
            let found: Vec<&str> = found
                .map(|pixel| pixel.split_once(' ').unwrap().0)
                .collect();
            assert_eq!(found, expected);
            assert!(
                printed.contains(&format!("pixel {} ", expected[0])),
                "{printed}"
            );
            let rays = DataSet::read(&out.path().join("rays.vtp"));
            let mut pixels: Vec<i32> = rays.array("pixel").i32s().collect();
            pixels.dedup();
            assert_eq!(pixels.len(), 5);
        }
    }
}

#[test]
fn the_metric_decides_what_is_measured() {
    let out = tempfile::tempdir().unwrap();
    let size = ["--width=32", "--height=24", "--hottest=2"];
    for flags in [&[][..], &["--cost=counters", "--by=time_ns"][..]] {
        let printed = trace("seed_extended", out.path(), &[&size, flags].concat());
        assert!(printed.contains("\nhottest by time_ns: "), "{printed}");
    }
    let printed = trace(
        "seed_extended",
        out.path(),
        &[&size[..], &["--no-cost"]].concat(),
    );
    assert!(printed.contains("\nhottest by node_visits: "), "{printed}");
}

#[test]
fn invalid_requests_are_refused() {
    let out = tempfile::tempdir().unwrap();
    let refusal = |arguments: &[&str]| {
        let scene = in_repository("configs/seed_sphere.yaml");
        let mut command = raycost();
        command.arg("trace").arg(scene).arg("--out").arg(out.path());
        let output = command.args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    for (arguments, message) in [
        (&["--hottest=0"][..], "0 is not in 1..=10000"),
        (&["--hottest=10001"][..], "10001 is not in 1..=10000"),
        (&["--hottest=-1"][..], "invalid value '-1'"),
        (&["--hottest=3", "--pixel=1,1"][..], "cannot be used with"),
        (&["--by=rays"][..], "--hottest <N>"),
        (&["--pixel=1,1", "--by=rays"][..], "cannot be used with"),
        (&[][..], "--pixel <X,Y>"),
        (
            &["--hottest=3", "--by=cost"][..],
            "possible values: time_ns, node_visits",
        ),
        (
            &["--hottest=3", "--by=refraction_rays"][..],
            "no pixel has any refraction rays",
        ),
    ] {
        let found = refusal(arguments);
        assert!(found.contains(message), "{arguments:?}: {found}");
    }
}

#[test]
fn render_names_the_most_expensive_pixel_and_how_to_trace_it() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("an out");
    for mode in ["--cost=time", "--cost=counters"] {
        let output = raycost()
            .arg("render")
            .arg(in_repository("configs/seed_extended.yaml"))
            .args(["--width=40", "--height=30", "--spp=2", mode, "--out"])
            .arg(&out)
            .output()
            .unwrap();
        assert_success(&output);
        let lines = String::from_utf8(output.stdout).unwrap();
        let (_, hottest) = lines.split_once("\nhottest pixel ").unwrap();
        assert!(hottest.contains("node visits"), "{lines}");
        // The last line is a shell command that traces that pixel.
        let command = lines.lines().last().unwrap().trim_start();
        let arguments = command.strip_prefix("raycost ").unwrap();
        let program = env!("CARGO_BIN_EXE_raycost");
        let typed = format!("'{program}' {arguments}");
        let traced = Command::new("sh").arg("-c").arg(typed).output().unwrap();
        assert_success(&traced);
        let printed = String::from_utf8(traced.stdout).unwrap();
        let pixel = hottest.split(' ').next().unwrap();
        assert!(printed.starts_with(&format!("pixel {pixel} ")), "{printed}");
        assert!(printed.contains("camera, sample 1"), "{printed}");
    }
    let output = raycost()
        .arg("render")
        .arg(in_repository("configs/seed_extended.yaml"))
        .args(["--width=40", "--height=30", "--no-cost", "--out"])
        .arg(&out)
        .output()
        .unwrap();
    let lines = String::from_utf8(output.stdout).unwrap();
    assert!(!lines.contains("hottest") && !lines.contains("raycost trace"));
}
