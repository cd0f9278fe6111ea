//! The VTK files contain the film bit for bit, as read by a plain reader of the format
//! and by VTK.

mod expected;
mod field_data;

use std::fs::File;
use std::path::Path;
use std::time::Instant;

use base::Keyword;
use expected::{expected_frame, expected_hits, expected_tiles};

use crate::common::data_set::{Array, DataSet, assert_same};
use crate::common::noise::noise;
use crate::common::{assert_success, config, film, in_repository, parse, raycost, with_cost};
use output::writers::{write_frame, write_hits, write_tiles};
use render::film::Film;
use render::schedule::{Schedule, TileGrid, TileRun};
use scene::config::{Config, CostMode, TileOrder};
use tracer::cost::Cost;
use vtk::Codec;

read_both_ways! {
    seed_extended: film(&config("seed_extended"), 2);
    // The last tile of each row and the last strip are cut.
    odd_size: film(&scene(33, 17, 1, SPHERE), 2);
    four_samples: film(&scene(33, 17, 4, SPHERE), 2);
    counters: film(&with_cost(scene(33, 17, 1, SPHERE), CostMode::Counters), 2);
    no_cost: film(&with_cost(scene(33, 17, 1, SPHERE), CostMode::None), 2);
    one_pixel: film(&scene(1, 1, 1, SPHERE), 1);
    no_hit: film_of_hits(0, &scene(33, 17, 1, "{ center: [0, 0, 9], radius: 1 }"));
    one_hit: film_of_hits(1, &scene(33, 17, 1, "{ center: [0, 0, 0], radius: 0.1 }"));
    all_hits: film_of_hits(33 * 17, &scene(33, 17, 1, "{ center: [0, 0, 0], radius: 9 }"));
    noise: noise(33, 17, CostMode::Time, 0);
}

/// The diff of two outputs: what it holds is tested without VTK, in `diff`.
#[test]
#[ignore = "needs PyPI's vtk: run tests/with-paraview"]
fn a_diff_by_vtk() {
    let folder = tempfile::tempdir().unwrap();
    for (side, quality) in [("a", "bvh"), ("b", "brute_force")] {
        let scene = std::fs::read_to_string(in_repository("configs/seed_extended.yaml")).unwrap();
        let file = folder.path().join(side).with_extension("yaml");
        std::fs::write(&file, format!("{scene}acceleration: {quality}\n")).unwrap();
        let mut render = raycost();
        render
            .arg("render")
            .arg(file)
            .arg("--out")
            .arg(folder.path().join(side));
        assert_success(&render.args(["--width=33", "--height=17"]).output().unwrap());
    }
    let mut diff = raycost();
    let diff = diff
        .args(["diff", "b", "a", "--out", "."])
        .current_dir(folder.path());
    assert_success(&diff.output().unwrap());
    let file = folder.path().join("diff.vti");
    assert_same(DataSet::read_with_vtk(&file), DataSet::read(&file));
}

/// The files of a scene with instances, in each of which something is of them alone.
#[test]
#[ignore = "needs PyPI's vtk: run tests/with-paraview"]
fn instances_by_vtk() {
    let folder = tempfile::tempdir().unwrap();
    let scene = in_repository("configs/herd.yaml");
    let mut render = raycost();
    render
        .arg("render")
        .arg(scene)
        .args(["--width=40", "--height=30", "--spp=1", "--also=surface,bvh"])
        .arg("--set=objects[1].instances.cloud.count=200")
        .arg("--out")
        .arg(folder.path());
    assert_success(&render.output().unwrap());
    let of_instances = [
        ("hits.vtu", "instance"),
        ("frame.vti", "instance"),
        ("surface.vtu", "instance"),
        ("bvh.vtu", "mesh"),
    ];
    for (name, array) in of_instances {
        let file = folder.path().join(name);
        let found = DataSet::read(&file);
        assert!(
            found.arrays.iter().any(|found| found.name == array),
            "{name}"
        );
        assert_same(DataSet::read_with_vtk(&file), found);
    }
}

mod all_files {
    use super::*;

    #[test]
    fn as_the_format_says() {
        check_all_files(DataSet::read);
    }

    #[test]
    #[ignore = "needs PyPI's vtk: run tests/with-paraview"]
    fn by_vtk() {
        check_all_files(DataSet::read_with_vtk);
    }
}

mod tiles {
    use super::*;

    #[test]
    fn as_the_format_says() {
        check_tiles(DataSet::read);
    }

    #[test]
    #[ignore = "needs PyPI's vtk: run tests/with-paraview"]
    fn by_vtk() {
        check_tiles(DataSet::read_with_vtk);
    }
}

const SPHERE: &str = "{ center: [0.5, 0.3, 0], radius: 1 }";

/// A sphere before a gradient.
fn scene(width: u32, height: u32, samples: u32, sphere: &str) -> Config {
    parse(&format!(
        "
image: {{ width: {width}, height: {height}, samples_per_pixel: {samples} }}
camera:
  look_at: {{ eye: [0, 0, 5], target: [0, 0, 0], fov_y_deg: 40 }}
background:
  gradient: {{ bottom: [0.9, 0.8, 0.1], top: [0.1, 0.2, 1] }}
materials:
  red: {{ color: [1, 0.2, 0.1], reflection: 0.3 }}
lights:
  - point: {{ position: [3, 5, 9] }}
objects:
  - sphere: {sphere}
    material: red
"
    ))
}

fn film_of_hits(n_hits: usize, config: &Config) -> Film {
    let film = film(config, 2);
    assert_eq!(film.n_hits(), n_hits);
    film
}

/// Writes the film's two files with each codec and compares what `read` finds in
/// them.
fn check(film: &Film, read: fn(&Path) -> DataSet) {
    let folder = tempfile::tempdir().unwrap();
    let [frame, hits] = ["frame.vti", "hits.vtu"].map(|file| folder.path().join(file));
    for &codec in Codec::KEYWORDS {
        write_frame(film, codec, &mut File::create(&frame).unwrap()).unwrap();
        write_hits(film, codec, &mut File::create(&hits).unwrap()).unwrap();
        assert_same(read(&frame), expected_frame(film));
        assert_same(read(&hits), expected_hits(film));
    }
}

/// Writes all VTK files of a scene with each codec, and compares what `read`
/// finds in them with what the raw ones hold. Only `tiles.vti` has times.
fn check_all_files(read: fn(&Path) -> DataSet) {
    let folder = tempfile::tempdir().unwrap();
    let scene = in_repository("configs/spot.yaml");
    let run = |command: &[&str], codec: &str| {
        let mut raycost = raycost();
        raycost.args(command).arg(&scene).arg("--out");
        raycost.arg(folder.path().join(codec));
        raycost.args(["--quiet", "--width=120", "--height=90", "--cost=counters"]);
        raycost.args(["--threads=1", "--compress", codec]);
        assert_success(&raycost.output().unwrap());
    };
    for codec in ["none", "lz4", "zlib"] {
        run(&["render", "--also=schedule,surface,bvh"], codec);
        run(&["trace", "--pixel=50..60,40..45"], codec);
    }
    for file in [
        "frame.vti",
        "hits.vtu",
        "tiles.vti",
        "surface.vtu",
        "bvh.vtu",
        "rays.vtp",
        "rays_cloud.vtu",
    ] {
        let path = |codec| folder.path().join(codec).join(file);
        let n_bytes = |codec| path(codec).metadata().unwrap().len();
        let expected = DataSet::read(&path("none"));
        for codec in ["lz4", "zlib"] {
            let mut found = read(&path(codec));
            if file == "tiles.vti" {
                let is_time = |array: &Array| array.name.ends_with("_ns");
                let arrays = found.arrays.iter_mut().zip(&expected.arrays);
                let times = arrays.filter(|(array, _)| is_time(array));
                times.for_each(|(found, expected)| found.bytes = expected.bytes.clone());
            }
            // The ID is that of the settings, too.
            let ids = found.texts.iter_mut().zip(&expected.texts);
            let ids = ids.filter(|((name, _), _)| name == "raycost_run");
            ids.for_each(|(found, expected)| found.clone_from(expected));
            assert_same(found, expected.clone());
            let is_small = file == "tiles.vti" || n_bytes(codec) < n_bytes("none");
            assert!(is_small, "{file}: {codec}");
        }
    }
}

/// Writes a schedule of 3 x 2 tiles, the last of each row and column cut, and
/// compares what `read` finds.
fn check_tiles(read: fn(&Path) -> DataSet) {
    let run = |number: u32| TileRun {
        is_missing: false,
        rank: number % 3,
        thread: number % 2,
        position: 5 - number,
        start_ns: u64::from(number) << 33,
        end_ns: (u64::from(number) << 33) + 7,
        film_ns: 3,
        warm_up_ns: 2,
        waiting_ns: 1,
        counted: Cost {
            node_visits: u64::from(number) << 34,
            rays: [1, 2, 3, 4, 5],
            depth: number.into(),
            ..Cost::default()
        },
    };
    let schedule = Schedule {
        grid: TileGrid::new(33, 17, 16),
        order: TileOrder::Scanline,
        n_threads: 2,
        begin: Instant::now(),
        runs: (0..6).map(run).collect(),
    };
    let folder = tempfile::tempdir().unwrap();
    for cost in [CostMode::None, CostMode::Time] {
        let path = folder.path().join("tiles.vti");
        for &codec in Codec::KEYWORDS {
            write_tiles(&schedule, cost, codec, &mut File::create(&path).unwrap()).unwrap();
            assert_same(read(&path), expected_tiles(cost));
        }
    }
}
