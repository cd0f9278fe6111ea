//! `lanes.csv` and the array `idle_lanes` from the command line.

use std::fs;
use std::path::Path;

use crate::common::data_set::DataSet;
use crate::common::{assert_success, in_repository, raycost};
use serde_json::Value;

/// Renders a scene with glass into a folder. Returns the text for the terminal.
fn render(out: &Path, flags: &[&str]) -> String {
    let mut command = raycost();
    command
        .arg("render")
        .arg(in_repository("configs/glass.yaml"));
    command.args(["--width=40", "--height=30", "--spp=1", "--cost=counters"]);
    command.args(flags).arg("--out").arg(out);
    let output = command.output().unwrap();
    assert_success(&output);
    String::from_utf8(output.stdout).unwrap()
}

fn table(out: &Path) -> String {
    fs::read_to_string(out.join("lanes.csv")).unwrap()
}

#[test]
fn the_table_the_terminal_and_the_summary_have_the_same_shares() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("one");
    let text = render(&out, &["--also=lanes", "--threads=1"]);
    let table = table(&out);
    assert_eq!(table.lines().count(), 1 + 4 * 6 * 4);
    let row = |name: &str| -> Vec<f64> {
        let row = table.lines().find_map(|line| line.strip_prefix(name));
        let numbers = row.unwrap().split(',').map(|n| n.parse().unwrap());
        numbers.collect()
    };
    let [rays, warps, steps, lane_steps, share] = row("all,tiles,32,")[..] else {
        panic!("{table}");
    };
    assert!((share - (1.0 - steps / lane_steps)).abs() < 1e-6);
    let summary = fs::read_to_string(out.join("summary.json")).unwrap();
    let totals = serde_json::from_str::<Value>(&summary).unwrap()["cost"]["totals"].clone();
    let total = |name: &str| totals[name].as_f64().unwrap();
    assert_eq!(rays, total("rays"));
    assert_eq!(steps, total("node_visits") + total("primitive_tests"));
    assert!((total("idle_lanes") - share).abs() < 1e-6);
    assert!(warps >= rays / 32.0);
    for kind in ["camera", "shadow", "bounce"] {
        let shares = ["rows", "tiles", "morton", "waves", "octant", "material"].map(|order| {
            let share = row(&format!("{kind},{order},32,"))[4];
            format!("{:>7.1} %", 100.0 * share)
        });
        let line = format!("        {kind:<11}{}\n", shares.concat());
        assert!(text.contains(&line), "{line}{text}");
    }
}

#[test]
fn other_threads_and_parts_change_no_byte() {
    let folder = tempfile::tempdir().unwrap();
    let [one, many, parts] = ["one", "many", "parts"].map(|name| folder.path().join(name));
    render(&one, &["--also=lanes", "--threads=1"]);
    render(&many, &["--also=lanes", "--threads=3"]);
    for part in ["1/2", "2/2"] {
        render(&parts, &["--also=lanes", "--part", part]);
    }
    let merge = raycost().arg("merge").arg(&parts).output().unwrap();
    assert_success(&merge);
    let shares = |out: &Path| {
        let frame = DataSet::read(&out.join("frame.vti"));
        let shares: Vec<u32> = frame.array("idle_lanes").f32s().map(f32::to_bits).collect();
        shares
    };
    for out in [&many, &parts] {
        assert_eq!(table(out), table(&one));
        assert_eq!(shares(out), shares(&one));
    }
}

#[test]
fn warps_of_the_array_are_chosen_in_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let [rows, tiles] = ["rows", "tiles"].map(|order| {
        let out = folder.path().join(order);
        let output = format!(
            "output={{ also: [lanes: {{ warp: 8, order: {order} }}], arrays: [RGB, rays, idle_lanes] }}"
        );
        let text = render(&out, &["--set", &output]);
        assert!(text.contains("idle of 8 "), "{text}");
        // One of two costs, which the state shows.
        let state = fs::read_to_string(out.join("heatmap.pvsm")).unwrap();
        assert!(state.contains("idle_lanes"));
        out
    });
    // A row of a tile is as wide as this warp: the camera rays are in the same warps.
    let camera = |out: &Path, order: &str| {
        let name = format!("camera,{order},8,");
        let table = table(out);
        let row = table.lines().find_map(|line| line.strip_prefix(&name));
        row.unwrap().to_owned()
    };
    assert_eq!(camera(&rows, "rows"), camera(&tiles, "tiles"));
    assert_eq!(table(&rows), table(&tiles));
}
