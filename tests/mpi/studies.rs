//! Studies over the number of ranks.

use std::fs;
use std::process::Command;

use serde_json::Value;

use crate::common::{assert_success, in_repository, raycost};
use crate::job::ENVIRONMENT;

/// The medians of a metric by number of ranks.
fn medians(statistics: &Value, metric: &str) -> Vec<(u64, f64)> {
    let rows = statistics["rows"].as_array().unwrap().iter();
    let rows = rows.filter(|row| row["metric"] == metric);
    let pair = |row: &Value| (row["point"]["ranks"].as_u64(), row["median"].as_f64());
    rows.map(pair)
        .map(|(ranks, median)| (ranks.unwrap(), median.unwrap()))
        .collect()
}

#[test]
fn a_study_over_ranks_has_their_efficiency_and_its_parts() {
    let folder = tempfile::tempdir().unwrap();
    let scene = in_repository("configs/seed_extended.yaml");
    let study = format!(
        "title: Ranks\nscenes: [{}]\nvary: {{ ranks: [1, 2] }}\nlauncher: mpirun -n {{ranks}}\n\
         flags: [--threads=1, --cost=counters, --width=300, --height=200]\nrepeats: 3\n\
         plots: [{{ x: ranks, y: [load_balance, communication_efficiency] }}]\n",
        scene.display()
    );
    fs::write(folder.path().join("study.yaml"), study).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_raycost"));
    command.args(["study", "study.yaml", "--out", "out"]);
    command.envs(ENVIRONMENT);
    assert_success(&command.current_dir(folder.path()).output().unwrap());
    let text = fs::read(folder.path().join("out/statistics.json")).unwrap();
    let statistics: Value = serde_json::from_slice(&text).unwrap();
    assert_eq!(medians(&statistics, "n_ranks"), [(1, 1.0), (2, 2.0)]);
    assert_eq!(medians(&statistics, "n_threads"), [(1, 1.0), (2, 2.0)]);
    let [speedup, efficiency] =
        ["speedup", "scaling_efficiency"].map(|metric| medians(&statistics, metric));
    assert_eq!([speedup[0].1, efficiency[0].1], [1.0, 1.0]);
    assert!((efficiency[1].1 - speedup[1].1 / 2.0).abs() < 1e-9);
    let log = fs::read_to_string(folder.path().join("out/runs.jsonl")).unwrap();
    let runs = log
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let measured: Vec<Value> = runs.filter(|run| run["point"]["ranks"].is_u64()).collect();
    // The speedup is the median of the ratios of three rounds, after a warm-up.
    let wall_ms = |ranks: u64, round: u64| {
        let is_of = |run: &&Value| run["point"]["ranks"] == ranks && run["round"] == round;
        let run = measured.iter().find(is_of).unwrap();
        run["metrics"]["render_wall_ms"].as_f64().unwrap()
    };
    let mut ratios = [1, 2, 3].map(|round| wall_ms(1, round) / wall_ms(2, round));
    ratios.sort_by(f64::total_cmp);
    assert!((speedup[1].1 - ratios[1]).abs() < 1e-6);
    // In each run the efficiency is the product of its parts.
    let metrics: Vec<Value> = measured.iter().map(|run| run["metrics"].clone()).collect();
    assert!(metrics.len() >= 6);
    for metrics in metrics {
        let of = |name: &str| metrics[name].as_f64().unwrap();
        if of("n_ranks") == 1.0 {
            assert_eq!([of("load_balance"), of("sent_bytes")], [1.0, 0.0]);
        }
        let product = of("load_balance") * of("communication_efficiency");
        assert!((of("parallel_efficiency") - product).abs() < 1e-9);
        let is_share = |name: &&str| of(name) > 0.0 && of(name) <= 1.0 + 1e-9;
        assert!(
            ["load_balance", "parallel_efficiency", "render_share"]
                .iter()
                .all(is_share)
        );
    }
}

#[test]
fn a_launcher_that_is_no_program_is_shown_at_its_line() {
    let folder = tempfile::tempdir().unwrap();
    // In a folder of PATH, too.
    fs::write(folder.path().join("launch"), "#!/bin/sh\nexec \"$@\"\n").unwrap();
    for (launcher, message, label, help) in [
        (
            "nompirun",
            "there is no program `nompirun`",
            "is not in PATH",
            "install MPI, or give its path",
        ),
        (
            "launch",
            "there is no program `launch`",
            "is not in PATH",
            "install MPI, or give its path",
        ),
        (
            "./launch",
            "`./launch` cannot be executed",
            "is not a program",
            "make it executable: `chmod +x`",
        ),
        (
            "./none",
            "there is no program `./none`",
            "is not a file",
            "install MPI, or give its path",
        ),
        (
            "./",
            "there is no program `./`",
            "is not a file",
            "install MPI, or give its path",
        ),
    ] {
        let scene = in_repository("configs/seed_sphere.yaml");
        let line = format!("launcher: {launcher} {{ranks}}");
        let study = format!(
            "title: x\nscenes: [{}]\nvary: {{ ranks: [1] }}\n{line}\n",
            scene.display()
        );
        fs::write(folder.path().join("study.yaml"), study).unwrap();
        let mut command = raycost();
        command.args(["study", "study.yaml", "--out", "out", "--allow-commands"]);
        let command = command
            .current_dir(folder.path())
            .env("PATH", folder.path());
        let refused = command.output().unwrap();
        let carets = "^".repeat(line.len() - "launcher: ".len());
        let expected = format!(
            "error: {message}\n --> study.yaml:4:11\n  |\n4 | {line}\n  |           {carets} \
             {label}\n  |\n  = help: {help}\n"
        );
        assert_eq!(String::from_utf8_lossy(&refused.stderr), expected);
        assert_eq!(refused.status.code(), Some(2));
        assert!(!folder.path().join("out").exists());
    }
}
