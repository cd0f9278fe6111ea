//! Times to write the VTK files of a 4K image with each codec, compared with a plain `write()` of
//! the raw bytes, and to read them again: `cargo bench --bench vtk_write [-- FOLDER] [-- --json
//! FILE]`.
//!
//! The codecs take turns in one process, so that a drift of the machine affects all of them
//! equally. FOLDER is the output folder; the default is a folder in memory (/dev/shm if it exists,
//! else the system's temporary folder), so that no disk is measured. One thread
//! generates an array, another writes it; compression uses all threads.

use scene::build::{Geometries, Sensor};
use std::fs::File;
use std::hint::black_box;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Parser;
use math::statistics::Ratio;
use output::results::{FrameFile, HitsFile};
use output::writers::{write_frame, write_hits};
use render::film::Film;
use render::tiles::{TilePlan, render};
use scene::config::{Config, CostMode};
use scene::yaml::Source;
use serde_json::{Value, json};
use tools::study::SampleStatistics;
use tracer::accel::Accel;
use tracer::cost::Meter;
use tracer::trace::Tracer;
use vtk::Codec;

const N_ROUNDS: usize = 9;

/// Columns and rows of the image.
const SIZE: [u32; 2] = [3840, 2160];

const CODECS: [Codec; 3] = [Codec::None, Codec::Lz4, Codec::Zlib];

/// Time the VTK writer.
#[derive(Debug, Parser)]
struct Options {
    /// Output folder [default: a folder in memory]
    folder: Option<PathBuf>,
    /// Also write the medians and their intervals to this file as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// `cargo bench` passes it
    #[arg(long, hide = true)]
    bench: bool,
}

type Writer = fn(&Film, Codec, &mut BufWriter<File>) -> std::io::Result<()>;

fn main() {
    let options = Options::parse();
    let [width, height] = SIZE;
    let film = film(width, height);
    let folder = options.folder.unwrap_or_else(folder_in_memory);
    println!(
        "{N_ROUNDS} rounds in {}, {} hits, {} threads\n",
        folder.display(),
        film.n_hits(),
        rayon::current_num_threads()
    );
    println!("                      MB   write s   of plain   read s");
    let path = |name| folder.join(format!("raycost-bench-{name}"));
    let frame = path("frame.vti");
    let mut rows = compare("frame.vti", &film, write_frame, &frame, || {
        let frame = FrameFile::open(&frame).unwrap();
        for info in frame.arrays().to_vec() {
            black_box(frame.read(&info.name).unwrap());
        }
    });
    let hits = path("hits.vtu");
    rows.extend(compare("hits.vtu", &film, write_hits, &hits, || {
        let hits = HitsFile::open(&hits).unwrap();
        for info in hits.arrays().to_vec() {
            black_box(hits.read(&info.name).unwrap());
        }
    }));
    if let Some(path) = options.json {
        let size = json!({ "width": width, "height": height, "rows": rows });
        std::fs::write(path, format!("{size:#}\n")).unwrap();
    }
}

/// Times a file with each codec and a plain write of its raw bytes in turn. Returns a row for each
/// codec.
fn compare(name: &str, film: &Film, writer: Writer, path: &Path, read: impl Fn()) -> Vec<Value> {
    let write = |codec| {
        let mut out = BufWriter::with_capacity(1 << 20, File::create(path).unwrap());
        // In the pool, as a rendering does.
        rayon::scope(|_| writer(film, codec, &mut out)).unwrap();
        out.flush().unwrap();
    };
    write(Codec::None);
    let bytes = std::fs::read(path).unwrap();
    let mut plain = Vec::new();
    let mut times = CODECS.map(|_| [Vec::new(), Vec::new()]);
    let mut n_bytes = [0; CODECS.len()];
    for _ in 0..N_ROUNDS {
        std::fs::remove_file(path).ok();
        plain.push(seconds(|| {
            File::create(path).unwrap().write_all(&bytes).unwrap()
        }));
        for ((codec, times), n_bytes) in CODECS.iter().zip(&mut times).zip(&mut n_bytes) {
            std::fs::remove_file(path).unwrap();
            times[0].push(seconds(|| write(*codec)));
            times[1].push(seconds(&read));
            *n_bytes = path.metadata().unwrap().len();
        }
    }
    std::fs::remove_file(path).unwrap();

    let line = |what: &str, n_bytes: u64, write: &[f64]| {
        let (mb, write) = (n_bytes as f64 / 1e6, statistics(write).median);
        let ratio = write / statistics(&plain).median;
        print!("{name:<9}  {what:<5}  {mb:6.1}   {write:7.3}   {ratio:8.2}");
    };
    line("plain", bytes.len() as u64, &plain);
    println!();
    let row = |codec: &Codec, [writes, reads]: &[Vec<f64>; 2], n_bytes: u64| {
        let codec = format!("{codec:?}").to_lowercase();
        line(&codec, n_bytes, writes);
        println!("   {:6.3}", statistics(reads).median);
        json!({
            "file": name, "codec": codec, "bytes": n_bytes,
            "write_s": statistics(writes), "read_s": statistics(reads),
            "write_over_plain": Ratio::estimate(&plain, writes),
        })
    };
    let rows = CODECS.iter().zip(&times).zip(n_bytes);
    rows.map(|((codec, times), n_bytes)| row(codec, times, n_bytes))
        .collect()
}

fn statistics(seconds: &[f64]) -> SampleStatistics {
    SampleStatistics::from_values(seconds).expect("there are rounds")
}

fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

fn film(width: u32, height: u32) -> Film {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/seed_extended.yaml");
    let mut config: Config = Source::read(&path)
        .and_then(|source| source.parse())
        .unwrap();
    (config.image.width, config.image.height) = (width, height);
    let geometries = Geometries::read(&mut config, Path::new("configs"), u64::MAX).unwrap();
    let scene = scene::build::scene(&config, geometries).unwrap();
    let accel = Accel::new(&scene, config.acceleration);
    let tracer = Tracer::new(&scene, &accel);
    let plan = TilePlan::new(tracer, &Sensor::new(&scene, &config), config.tiles);
    render(tracer, &plan, &Meter::new(CostMode::Time), &|_| {}).0
}

/// Returns the system's folder in memory, or its temporary folder.
fn folder_in_memory() -> PathBuf {
    let memory = PathBuf::from("/dev/shm");
    if memory.is_dir() {
        memory
    } else {
        std::env::temp_dir()
    }
}
