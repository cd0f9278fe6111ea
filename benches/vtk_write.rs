//! How long the VTK files of a 4K picture take with each codec, beside a plain
//! `write()` of the raw bytes, and how long raycost takes to read them again:
//! `cargo bench --bench vtk_write [-- FOLDER]`.
//!
//! All take turns in one process, so that a drifting machine meets all alike.
//! FOLDER is where the files go; a folder in memory (/dev/shm, if there is one,
//! else the system's temporary folder) measures the writer and not a disk. One
//! thread does all but compress.

use std::fs::File;
use std::hint::black_box;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use raycost::accel::Accel;
use raycost::config::{Codec, Config, CostMode};
use raycost::cost::Meter;
use raycost::film::Film;
use raycost::output::{write_frame, write_hits};
use raycost::render::{Plan, render};
use raycost::results::{Frame, Hits};
use raycost::scene::{Geometries, Scene};
use raycost::yaml::Source;

const N_ROUNDS: usize = 9;

const CODECS: [Codec; 3] = [Codec::None, Codec::Lz4, Codec::Zlib];

type Writer = fn(&Film, Codec, &mut BufWriter<File>) -> std::io::Result<()>;

fn main() {
    let film = film(3840, 2160);
    let folder = folder();
    println!(
        "{N_ROUNDS} rounds in {}, {} hits, {} threads\n",
        folder.display(),
        film.n_hits(),
        rayon::current_num_threads()
    );
    println!("                      MB   write s   of plain   read s");
    let path = |name| folder.join(format!("raycost-bench-{name}"));
    let frame = path("frame.vti");
    compare("frame.vti", &film, write_frame, &frame, || {
        let mut frame = Frame::open(&frame).unwrap();
        for info in frame.arrays().to_vec() {
            black_box(frame.read(&info.name).unwrap());
        }
    });
    let hits = path("hits.vtu");
    compare("hits.vtu", &film, write_hits, &hits, || {
        let mut hits = Hits::open(&hits).unwrap();
        for info in hits.arrays().to_vec() {
            black_box(hits.read(&info.name).unwrap());
        }
    });
}

/// Times a file with each codec, and a plain write of its raw bytes, in turn.
fn compare(name: &str, film: &Film, writer: Writer, path: &Path, read: impl Fn()) {
    let write = |codec| {
        let mut out = BufWriter::with_capacity(1 << 20, File::create(path).unwrap());
        writer(film, codec, &mut out).unwrap();
        out.flush().unwrap();
    };
    write(Codec::None);
    let bytes = std::fs::read(path).unwrap();
    let mut plain = Vec::new();
    let mut times = CODECS.map(|_| (Vec::new(), Vec::new()));
    let mut n_bytes = [0; CODECS.len()];
    for _ in 0..N_ROUNDS {
        std::fs::remove_file(path).ok();
        plain.push(seconds(|| {
            File::create(path).unwrap().write_all(&bytes).unwrap()
        }));
        for ((codec, times), n_bytes) in CODECS.iter().zip(&mut times).zip(&mut n_bytes) {
            std::fs::remove_file(path).unwrap();
            times.0.push(seconds(|| write(*codec)));
            times.1.push(seconds(&read));
            *n_bytes = path.metadata().unwrap().len();
        }
    }
    std::fs::remove_file(path).unwrap();

    let plain = median(plain);
    let line = |what: &str, n_bytes: u64, write: f64| {
        let (mb, ratio) = (n_bytes as f64 / 1e6, write / plain);
        print!("{name:<9}  {what:<5}  {mb:6.1}   {write:7.3}   {ratio:8.2}");
    };
    line("plain", bytes.len() as u64, plain);
    println!();
    for ((codec, (writes, reads)), n_bytes) in CODECS.iter().zip(times).zip(n_bytes) {
        line(
            &format!("{codec:?}").to_lowercase(),
            n_bytes,
            median(writes),
        );
        println!("   {:6.3}", median(reads));
    }
}

fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
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
