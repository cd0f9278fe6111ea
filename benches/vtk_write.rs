//! How long the VTK files of a 4K picture take, beside a plain `write()` of
//! the same bytes: `cargo bench --bench vtk_write [-- FOLDER]`.
//!
//! Both take turns in one process, so that a drifting machine meets both
//! alike. FOLDER is where the files go; a folder in memory (/dev/shm, if there
//! is one, else the system's temporary folder) measures the writer and not a
//! disk.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use raycost::accel::Accel;
use raycost::config::{Config, CostMode};
use raycost::cost::Meter;
use raycost::film::Film;
use raycost::output::{write_frame, write_hits};
use raycost::render::{Plan, render};
use raycost::scene::{Geometries, Scene};
use raycost::yaml::Source;

const N_ROUNDS: usize = 9;

type Writer = fn(&Film, &mut BufWriter<File>) -> std::io::Result<()>;

fn main() {
    let film = film(3840, 2160);
    let folder = folder();
    println!(
        "{N_ROUNDS} rounds in {}, {} hits",
        folder.display(),
        film.n_hits()
    );
    let writers: [(&str, Writer); 2] = [("hits.vtu", write_hits), ("frame.vti", write_frame)];
    for (name, write) in writers {
        compare(
            name,
            &folder.join(format!("raycost-bench-{name}")),
            |path| {
                let mut out = BufWriter::with_capacity(1 << 20, File::create(path).unwrap());
                write(&film, &mut out).unwrap();
                out.flush().unwrap();
            },
        );
    }
}

/// Times `write` and a plain write of what it wrote, in turn.
fn compare(name: &str, path: &Path, write: impl Fn(&Path)) {
    write(path);
    let bytes = std::fs::read(path).unwrap();
    let (mut ours, mut plain) = (Vec::new(), Vec::new());
    for _ in 0..N_ROUNDS {
        ours.push(seconds(path, || write(path)));
        plain.push(seconds(path, || {
            File::create(path).unwrap().write_all(&bytes).unwrap()
        }));
    }
    let (ours, plain) = (median(ours), median(plain));
    println!(
        "{name:<10} {:6.1} MB   writer {ours:.3} s   plain write {plain:.3} s   ratio {:.2}",
        bytes.len() as f64 / 1e6,
        ours / plain
    );
}

/// The time of `work`, which makes the file, with no such file before or after.
fn seconds(path: &Path, work: impl Fn()) -> f64 {
    std::fs::remove_file(path).ok();
    let start = Instant::now();
    work();
    let seconds = start.elapsed().as_secs_f64();
    std::fs::remove_file(path).unwrap();
    seconds
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn film(width: u32, height: u32) -> Film {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/seed_extended.yaml");
    let mut config: Config = Source::read(&path)
        .and_then(|source| source.parse())
        .unwrap();
    (config.image.width, config.image.height) = (width, height);
    let geometries = Geometries::read(&config, "configs".as_ref(), u64::MAX).unwrap();
    let scene = Scene::new(&config, geometries).unwrap();
    let accel = Accel::new(&scene.primitives, config.acceleration);
    let plan = Plan::new(&scene, &accel, &config.image, config.tiles);
    render(&scene, &accel, &plan, &Meter::new(CostMode::Time), |_| {}).0
}

/// The folder that the command line names, or one in memory.
fn folder() -> PathBuf {
    let named = std::env::args()
        .skip(1)
        .find(|argument| !argument.starts_with('-'));
    let memory = PathBuf::from("/dev/shm");
    match named {
        Some(folder) => folder.into(),
        None if memory.is_dir() => memory,
        None => std::env::temp_dir(),
    }
}
