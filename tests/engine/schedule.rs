//! The tiling only changes which thread rendered what, and when; the schedule
//! records that correctly.

use std::collections::BTreeMap;
use std::fs;

use base::Keyword;
use serde_json::Value;

use crate::common::data_set::DataSet;
use crate::common::{
    assert_success, config, counts, film, in_repository, lasting, raycost, rays, rendered,
    tiles_and_threads,
};
use math::simd::Simd;
use render::film::Film;
use render::schedule::Schedule;
use scene::config::{Config, CostMode, TileOrder, Tiling};
use tracer::cost::{Cost, Counter};

fn tiled(name: &str, order: TileOrder, size: u32) -> Config {
    let mut config = config(name);
    (config.image.width, config.image.height) = (101, 67);
    config.tiles = Tiling { size, order };
    config
}

#[test]
fn neither_order_nor_size_changes_a_byte() {
    for &mode in CostMode::KEYWORDS {
        let films = |order, size, n_threads| {
            let mut config = tiled("seed_extended", order, size);
            config.image.samples_per_pixel = 2;
            config.cost = mode;
            lasting(film(&config, n_threads))
        };
        let plain = films(TileOrder::Scanline, 16, 1);
        for size in [2, 5, 16, 64, 256] {
            for (order, n_threads) in TileOrder::KEYWORDS
                .iter()
                .flat_map(|&o| [(o, 1), (o, 2), (o, 5)])
            {
                let film = films(order, size, n_threads);
                assert!(film == plain, "{mode:?}, {size}, {order:?}, {n_threads}");
            }
        }
    }
}

#[test]
fn the_schedule_agrees_with_the_film() {
    for (order, size) in TileOrder::KEYWORDS
        .iter()
        .flat_map(|&o| [(o, 3), (o, 16), (o, 256)])
    {
        let config = tiled("sphere_cloud", order, size);
        let (film, schedule) = rendered(&config, 3, Simd::best());
        check(&film, &schedule, 3);
    }
}

/// Checks that the schedule has each tile once, with the counters and the thread
/// of its pixels, and no two at the same time on one thread.
fn check(film: &Film, schedule: &Schedule, n_threads: u32) {
    let runs = &schedule.runs;
    assert_eq!(
        (schedule.n_threads, runs.len() as u32),
        (n_threads, schedule.grid.n_tiles())
    );
    let mut positions: Vec<u32> = runs.iter().map(|run| run.position).collect();
    positions.sort_unstable();
    assert!(positions.into_iter().eq(0..runs.len() as u32));
    assert_eq!(runs.iter().map(|run| run.start_ns).min(), Some(0));
    assert!(runs.iter().all(|run| run.film_ns <= run.duration_ns()));
    for thread in 0..n_threads {
        let mut spans: Vec<_> = runs
            .iter()
            .filter(|run| run.thread == thread)
            .map(|run| (run.position, run.start_ns, run.end_ns))
            .collect();
        spans.sort_unstable();
        assert!(
            spans.windows(2).all(|pair| pair[0].2 <= pair[1].1),
            "{spans:?}"
        );
    }
    let mut sums = vec![[0; 3]; runs.len()];
    let [nodes, tests, rays] = [
        counts(film, Counter::NodeVisits),
        counts(film, Counter::PrimitiveTests),
        rays(film),
    ];
    let [tiles, threads] = tiles_and_threads(film);
    let who = tiles.into_iter().zip(threads);
    for (((nodes, tests), rays), (tile, thread)) in nodes.into_iter().zip(tests).zip(rays).zip(who)
    {
        let counts = [nodes, tests, rays].map(u64::from);
        let sum: &mut [u64; 3] = &mut sums[tile as usize];
        *sum = std::array::from_fn(|i| sum[i] + counts[i]);
        assert_eq!(thread, runs[tile as usize].thread);
    }
    let counted = |cost: &Cost| [cost.node_visits, cost.primitive_tests, cost.n_rays()];
    assert!(
        sums.iter().eq(runs
            .iter()
            .map(|run| counted(&run.counted))
            .collect::<Vec<_>>()
            .iter())
    );
    assert_eq!(film.totals, schedule.counted());
}

#[test]
fn one_thread_takes_the_tiles_in_their_order() {
    let tiles_in_order = |order| {
        let (_, schedule) = rendered(&tiled("seed_extended", order, 16), 1, Simd::best());
        let mut runs: Vec<_> = (0..).zip(&schedule.runs).collect::<Vec<(usize, _)>>();
        // Two may start at the same time, as far as a coarse clock knows.
        runs.sort_by_key(|(_, run)| run.position);
        assert!(runs.is_sorted_by_key(|(_, run)| run.start_ns));
        runs.into_iter()
            .map(|(tile, run)| (tile, run.counted))
            .collect::<Vec<_>>()
    };
    let scanline = tiles_in_order(TileOrder::Scanline);
    assert!(scanline.iter().map(|(tile, _)| *tile).eq(0..scanline.len()));
    // Five rows of seven tiles.
    let hilbert = tiles_in_order(TileOrder::Hilbert);
    let place = |tile: usize| [tile % 7, tile / 7];
    let is_near = |a: [usize; 2], b: [usize; 2]| (0..2).all(|i| a[i].abs_diff(b[i]) <= 1);
    assert!(
        hilbert
            .windows(2)
            .all(|pair| is_near(place(pair[0].0), place(pair[1].0)))
    );
    // On the whole, expensive tiles come first.
    let cost = tiles_in_order(TileOrder::Cost);
    let (first, last) = cost.split_at(cost.len() / 2);
    let tests = |tiles: &[(usize, Cost)]| -> u64 {
        tiles
            .iter()
            .map(|(_, counted)| counted.primitive_tests)
            .sum()
    };
    assert!(tests(first) > 2 * tests(last));
}

#[test]
fn tiles_cover_their_pixels_in_paraview() {
    let temporary = tempfile::tempdir().unwrap();
    let out = temporary.path();
    let output = raycost()
        .arg("render")
        .arg(in_repository("configs/seed_extended.yaml"))
        .args([
            "--also=schedule",
            "--width=45",
            "--height=31",
            "--tile-size=8",
        ])
        .args(["--tile-order=cost", "--threads=2", "--out"])
        .arg(out)
        .output()
        .unwrap();
    assert_success(&output);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains("\ntiles   24 of 8 x 8, cost order, load imbalance "),
        "{text}"
    );
    let [tiles, frame] = ["tiles.vti", "frame.vti"].map(|file| DataSet::read(&out.join(file)));
    let ([x, y, _], [spacing, ..]) = (tiles.origin.unwrap(), tiles.spacing.unwrap());
    assert_eq!(tiles.extent, Some([0, 6, 0, 4, 0, 0]));
    let of_tile = |name, cell: usize| tiles.array(name).i32s().nth(cell);
    for pixel in 0..45 * 31 {
        let cell = |at: usize, origin: f64| ((at as f64 - origin) / spacing) as usize;
        let cell = cell(pixel / 45, y) * 6 + cell(pixel % 45, x);
        for array in ["tile", "thread"] {
            assert_eq!(
                frame.array(array).i32s().nth(pixel),
                of_tile(array, cell),
                "{array}, {pixel}"
            );
        }
    }
    check_trace(&serde_json::from_slice(&fs::read(out.join("trace.json")).unwrap()).unwrap());
    let summary: Value =
        serde_json::from_slice(&fs::read(out.join("summary.json")).unwrap()).unwrap();
    let schedule = &summary["schedule"];
    assert_eq!(
        (&schedule["tile_size"], &schedule["order"]),
        (&8.into(), &"cost".into())
    );
    assert_eq!(schedule["n_tiles"], 24);
    assert!(schedule["load_imbalance"].as_f64().unwrap() >= 0.0);
    assert!((0.0..1.0).contains(&schedule["idle_share"].as_f64().unwrap()));
}

/// Checks that the timelines are named, that the events of each do not overlap,
/// and that tiles are rendered during the stage `render`.
fn check_trace(trace: &Value) {
    let mut names = BTreeMap::new();
    let mut lines: BTreeMap<u64, Vec<[i64; 2]>> = BTreeMap::new();
    let mut stages = BTreeMap::new();
    for event in trace["traceEvents"].as_array().unwrap() {
        let line = event["tid"].as_u64().unwrap();
        let name = event["name"].as_str().unwrap();
        if event["ph"] == "M" {
            names.insert((line, name), event["args"]["name"].as_str().unwrap());
            continue;
        }
        assert_eq!(event["ph"], "X");
        let ns = |key: &str| (1e3 * event[key].as_f64().unwrap()).round() as i64;
        let span = [ns("ts"), ns("ts") + ns("dur")];
        match line {
            0 => _ = stages.insert(name, span),
            _ => assert!(event["args"]["node_visits"].as_u64().unwrap() > 0),
        }
        lines.entry(line).or_default().push(span);
    }
    let thread_names = [(0, "stages"), (1, "thread 0"), (2, "thread 1")];
    for (line, name) in thread_names {
        assert_eq!(names[&(line, "thread_name")], name);
    }
    assert_eq!(names[&(0, "process_name")], "raycost seed_extended");
    let [begin, end] = stages["render"];
    assert!(
        ["read", "build", "calibrate", "order"]
            .iter()
            .all(|name| stages[name][1] <= begin)
    );
    let n_tiles: usize = lines.range(1..).map(|(_, spans)| spans.len()).sum();
    assert_eq!(n_tiles, 24);
    for (line, mut spans) in lines {
        spans.sort_unstable();
        assert!(
            spans.windows(2).all(|pair| pair[0][1] <= pair[1][0]),
            "{line}: {spans:?}"
        );
        let while_rendering = |[from, to]: &[i64; 2]| begin <= *from && *to <= end;
        assert!(line == 0 || spans.iter().all(while_rendering));
    }
}
