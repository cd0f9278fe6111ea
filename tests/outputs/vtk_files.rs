//! The VTK files hold the film, bit for bit: as the format says, and as VTK
//! reads them.

use std::fs::File;
use std::path::Path;
use std::time::Instant;

use glam::Vec3;

use crate::common::data_set::{Array, DataSet, assert_same, integers};
use crate::common::noise::noise;
use crate::common::{
    assert_success, config, counts, film, in_repository, parse, raycost, rays, with_cost,
};
use raycost::config::{Config, CostMode, Repeats, TileOrder};
use raycost::cost::{Cost, Counter};
use raycost::film::{Film, RenderedTile, STRIP_ROWS, Strip};
use raycost::output::{write_frame, write_hits, write_tiles};
use raycost::schedule::{Schedule, TileGrid, TileRun};
use raycost::vtk::Codec;

/// Two tests of each film.
macro_rules! films {
    ($($name:ident: $film:expr;)*) => {$(
        mod $name {
            use super::*;

            #[test]
            fn as_the_format_says() {
                check(&$film, DataSet::read);
            }

            #[test]
            #[ignore = "needs PyPI's vtk: run tests/with-paraview"]
            fn by_vtk() {
                check(&$film, DataSet::read_with_vtk);
            }
        }
    )*};
}

films! {
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

const CODECS: [Codec; 3] = [Codec::None, Codec::Lz4, Codec::Zlib];

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
    for codec in CODECS {
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
        thread: number % 2,
        position: 5 - number,
        start_ns: u64::from(number) << 33,
        end_ns: (u64::from(number) << 33) + 7,
        film_ns: 3,
        warm_up_ns: 2,
        counted: Cost {
            node_visits: u64::from(number) << 34,
            rays: [1, 2, 3, 4],
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
        for codec in CODECS {
            write_tiles(&schedule, cost, codec, &mut File::create(&path).unwrap()).unwrap();
            assert_same(read(&path), expected_tiles(cost));
        }
    }
}

/// The expected `tiles.vti`: the lower row of tiles first.
fn expected_tiles(cost: CostMode) -> DataSet {
    let upward = [3, 4, 5, 0, 1, 2];
    let f64s = |name: &str, value: fn(u32) -> f64| {
        let bytes = upward.iter().flat_map(|&tile| value(tile).to_ne_bytes());
        tile_array(name, "Float64", bytes.collect())
    };
    let u64s = |name: &str, value: fn(u64) -> u64| {
        let bytes = upward
            .iter()
            .flat_map(|&tile| value(tile.into()).to_ne_bytes());
        tile_array(name, "UInt64", bytes.collect())
    };
    let mut arrays = vec![
        f64s("start_ns", |tile| f64::from(tile) * 2_f64.powi(33)),
        f64s("end_ns", |tile| f64::from(tile) * 2_f64.powi(33) + 7.0),
        f64s("duration_ns", |_| 7.0),
        f64s("film_ns", |_| 3.0),
        f64s("warm_up_ns", |_| 2.0),
        integers("thread", [1, 0, 1, 0, 1, 0].into_iter()),
        integers("position", [2, 1, 0, 5, 4, 3].into_iter()),
        integers("tile", [3, 4, 5, 0, 1, 2].into_iter()),
    ];
    if cost.has_counters() {
        arrays.extend([
            u64s("node_visits", |tile| tile << 34),
            u64s("primitive_tests", |_| 0),
            u64s("rays", |_| 10),
            u64s("shadow_rays", |_| 2),
            u64s("reflection_rays", |_| 3),
            u64s("refraction_rays", |_| 4),
            u64s("depth", |tile| tile),
        ]);
    }
    DataSet {
        kind: "ImageData".to_owned(),
        n_points: 4 * 3,
        n_cells: None,
        extent: Some([0, 3, 0, 2, 0, 0]),
        // Row 0 of the picture is up to y = 16.5 in frame.vti.
        origin: Some([-0.5, 16.5 - 32.0, 0.0]),
        spacing: Some([16.0; 3]),
        normals: None,
        arrays,
    }
}

fn tile_array(name: &str, scalar: &str, bytes: Vec<u8>) -> Array {
    Array {
        name: name.to_owned(),
        scalar: scalar.to_owned(),
        n_components: 1,
        bytes,
    }
}

/// The expected `frame.vti`: the bottom row first, unlike the film.
fn expected_frame(film: &Film) -> DataSet {
    let [right, top] = [film.grid.width, film.grid.height].map(|n| n as i32 - 1);
    let upward = (0..film.grid.height).rev();
    let pixels: Vec<Pixel> = upward
        .flat_map(|y| (0..film.grid.width).map(move |x| Pixel { x, y }))
        .collect();
    DataSet {
        kind: "ImageData".to_owned(),
        n_points: pixels.len(),
        n_cells: None,
        extent: Some([0, right, 0, top, 0, 0]),
        origin: Some([0.0; 3]),
        spacing: Some([1.0; 3]),
        normals: None,
        arrays: point_data(film, &pixels),
    }
}

/// The expected `hits.vtu`: the pixels with a hit, row by row from the top.
fn expected_hits(film: &Film) -> DataSet {
    let mut hits = Vec::new();
    for y in 0..film.grid.height {
        for x in 0..film.grid.width {
            let pixel = Pixel { x, y };
            if pixel.of(film, |strip| &strip.object) >= 0 {
                hits.push(pixel);
            }
        }
    }
    let n = hits.len() as i32;
    let numbers = hits
        .iter()
        .map(|pixel| (pixel.y * film.grid.width + pixel.x) as i32);
    let mut arrays = point_data(film, &hits);
    arrays.push(integers("pixel", numbers));
    arrays.push(Field::Vec3(|strip| &strip.position).array("Points", film, &hits));
    arrays.push(integers("connectivity", 0..n));
    arrays.push(integers("offsets", 1..=n));
    arrays.push(Array {
        name: "types".to_owned(),
        scalar: "UInt8".to_owned(),
        n_components: 1,
        bytes: vec![1; hits.len()], // VTK_VERTEX
    });
    DataSet {
        kind: "UnstructuredGrid".to_owned(),
        n_points: hits.len(),
        n_cells: Some(hits.len()),
        extent: None,
        origin: None,
        spacing: None,
        normals: Some("Normals".to_owned()),
        arrays,
    }
}

/// The arrays that both files have, in their order, for these pixels.
fn point_data(film: &Film, pixels: &[Pixel]) -> Vec<Array> {
    let counter = |counter| Field::Counts(counts(film, counter));
    let fields = [
        ("RGB", Field::Rgb(|strip| &strip.rgb)),
        ("Normals", Field::Vec3(|strip| &strip.normal)),
        ("distance", Field::F32(|strip| &strip.distance)),
        ("footprint", Field::F32(|strip| &strip.footprint)),
        ("object", Field::I32(|strip| &strip.object)),
        ("material", Field::I32(|strip| &strip.material)),
        ("time_ns", Field::F32(|strip| &strip.time_ns)),
        ("time_mad_ns", Field::F32(|strip| &strip.time_mad_ns)),
        ("n_rejected", Field::U8(|strip| &strip.n_rejected)),
        ("node_visits", counter(Counter::NodeVisits)),
        ("primitive_tests", counter(Counter::PrimitiveTests)),
        ("rays", Field::Counts(rays(film))),
        ("shadow_rays", counter(Counter::ShadowRays)),
        ("reflection_rays", counter(Counter::ReflectionRays)),
        ("refraction_rays", counter(Counter::RefractionRays)),
        ("depth", counter(Counter::Depth)),
        ("tile", Field::Tile(|number, _| number)),
        ("thread", Field::Tile(|_, tile| tile.thread)),
    ];
    let array = |(name, field): &(&str, Field)| field.array(name, film, pixels);
    let (geometry, cost) = fields.split_at(6);
    let (time, counters) = cost.split_at(3);
    let (time, counters) = match (film.cost, film.repeats) {
        (CostMode::None, _) => (&[][..], &[][..]),
        (CostMode::Counters, _) => (&[][..], counters),
        (CostMode::Time, Repeats::ONCE) => (&time[..1], counters),
        (CostMode::Time, _) => (time, counters),
    };
    let fields = geometry.iter().chain(time).chain(counters);
    fields.map(array).collect()
}

/// The accessor of an array of the film, by its type.
enum Field {
    Rgb(fn(&Strip) -> &Vec<[u8; 3]>),
    Vec3(fn(&Strip) -> &Vec<Vec3>),
    U8(fn(&Strip) -> &Vec<u8>),
    F32(fn(&Strip) -> &Vec<f32>),
    I32(fn(&Strip) -> &Vec<i32>),
    /// Of all pixels.
    Counts(Vec<u32>),
    /// By the tile and its number.
    Tile(fn(u32, &RenderedTile) -> u32),
}

impl Field {
    fn array(&self, name: &str, film: &Film, pixels: &[Pixel]) -> Array {
        let (scalar, n_components) = match self {
            Self::Rgb(_) => ("UInt8", 3),
            Self::Vec3(_) => ("Float32", 3),
            Self::U8(_) => ("UInt8", 1),
            Self::F32(_) => ("Float32", 1),
            Self::I32(_) => ("Int32", 1),
            Self::Counts(_) => ("UInt32", 1),
            Self::Tile(_) => ("Int32", 1),
        };
        let mut bytes = Vec::new();
        for pixel in pixels {
            match self {
                Self::Rgb(field) => bytes.extend(pixel.of(film, *field)),
                Self::Vec3(field) => {
                    let vector = pixel.of(film, *field).to_array();
                    bytes.extend(vector.iter().flat_map(|number| number.to_ne_bytes()));
                }
                Self::U8(field) => bytes.push(pixel.of(film, *field)),
                Self::F32(field) => bytes.extend(pixel.of(film, *field).to_ne_bytes()),
                Self::I32(field) => bytes.extend(pixel.of(film, *field).to_ne_bytes()),
                Self::Counts(counts) => {
                    let count = counts[(pixel.y * film.grid.width + pixel.x) as usize];
                    bytes.extend(count.to_ne_bytes());
                }
                Self::Tile(field) => {
                    let TileGrid {
                        tile_size,
                        n_columns,
                        ..
                    } = film.grid;
                    let number = pixel.y / tile_size * n_columns + pixel.x / tile_size;
                    let number = field(number, &film.tiles[number as usize]);
                    bytes.extend(number.to_ne_bytes());
                }
            }
        }
        Array {
            name: name.to_owned(),
            scalar: scalar.to_owned(),
            n_components,
            bytes,
        }
    }
}

/// A pixel by its column and its row, row 0 on top.
struct Pixel {
    x: u32,
    y: u32,
}

impl Pixel {
    fn of<T: Copy>(&self, film: &Film, field: fn(&Strip) -> &Vec<T>) -> T {
        let strip = &film.strips[(self.y / STRIP_ROWS) as usize];
        field(strip)[(self.y % STRIP_ROWS * film.grid.width + self.x) as usize]
    }
}
