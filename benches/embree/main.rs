//! raycost's kernels against Embree's: `cargo bench --bench embree`.
//!
//! Same primitives, same rays bit for bit, same threads, in one process and in
//! turn. Embree 3 is loaded at run time (`tests/with-embree` installs it) and
//! races with whichever of its instruction sets is faster. raycost races with
//! its counters on. Millions of rays a second, and of primitives for builds;
//! medians.

mod agreement;
mod arena;
mod contest;
mod device;
mod ffi;
mod kernel;
mod race;
mod rays;
mod report;
#[path = "../kernel/scenes.rs"]
mod scenes;
mod trace;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use raycost::scene::Primitive;

use arena::Arena;
use device::Device;
use ffi::Functions;
use race::Course;
use scenes::View;

/// Race raycost's kernels against Embree's.
#[derive(Debug, Parser)]
struct Options {
    /// Folder with meshes to race on beside the generated scenes
    #[arg(long, value_name = "DIR")]
    meshes: Option<PathBuf>,
    /// Race on the scenes with this in their names alone
    #[arg(long, value_name = "NAME", default_value = "")]
    scene: String,
    /// How often each kernel runs
    #[arg(long, value_name = "N", default_value_t = 7)]
    rounds: usize,
    /// Rows and columns of the picture
    #[arg(long, value_name = "PIXELS", default_value_t = 512)]
    side: usize,
    /// Rays that a thread takes at one go
    #[arg(long, value_name = "RAYS", default_value_t = 1024)]
    batch: usize,
    /// Write the table's rows to this file as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Race not, but fail if the hits differ by more than rounding
    #[arg(long)]
    check: bool,
    /// Given by `cargo bench`
    #[arg(long, hide = true)]
    bench: bool,
}

impl Options {
    fn course(&self) -> Course {
        Course {
            n_threads: 1,
            batch: self.batch,
            n_rounds: self.rounds,
        }
    }
}

fn main() -> ExitCode {
    let options = Options::parse();
    match run(&options) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => {
            eprintln!("error: the hits differ by more than rounding");
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Whether all hits agree.
fn run(options: &Options) -> Result<bool, Box<dyn Error>> {
    let embree = Functions::load()
        .map_err(|error| format!("{error}\n  install Embree 3, as `tests/with-embree` does"))?;
    // Lives as long as the process: devices and scenes refer to it.
    let embree: &'static Functions = Box::leak(Box::new(embree));
    let version = Device::new(embree, arena::ISAS[0], 1)?.version();
    match options.check {
        true => println!("Embree {version}; rays that do not agree:"),
        false => println!("Embree {version}\n\n{}", report::HEAD),
    }
    let (mut rows, mut is_good) = (Vec::new(), true);
    for (name, load) in scenes(options.meshes.as_deref())? {
        if !name.contains(&options.scene) {
            continue;
        }
        let (primitives, view) = load();
        let arena = Arena::new(embree, &name, &primitives, &view, options.side);
        if options.check {
            println!("{name}: {} rays", arena.n_rays());
            is_good &= arena.check()?;
            continue;
        }
        arena.race(options.course(), &mut |row| {
            println!("{row}");
            rows.push(row);
        })?;
    }
    if let Some(path) = &options.json {
        std::fs::write(path, serde_json::to_string_pretty(&rows)?)?;
    }
    Ok(is_good)
}

/// What makes a scene.
type Load = Box<dyn Fn() -> (Vec<Primitive>, View)>;

/// The scenes by name: the generated ones, and the meshes of the folder.
fn scenes(meshes: Option<&Path>) -> std::io::Result<Vec<(String, Load)>> {
    let mut scenes: Vec<(String, Load)> = vec![
        (
            "spheres".into(),
            Box::new(|| (scenes::sphere_cloud(), scenes::CUBE)),
        ),
        (
            "soup".into(),
            Box::new(|| (scenes::triangle_soup(), scenes::CUBE)),
        ),
        (
            "architecture".into(),
            Box::new(|| (scenes::architecture(), scenes::NAVE)),
        ),
    ];
    let mut files = Vec::new();
    if let Some(folder) = meshes {
        for entry in std::fs::read_dir(folder)? {
            files.push(entry?.path());
        }
    }
    files.retain(|file| {
        file.extension()
            .is_some_and(|extension| extension == "obj" || extension == "ply")
    });
    files.sort();
    for file in files {
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        scenes.push((name.into_owned(), Box::new(move || scenes::mesh(&file))));
    }
    Ok(scenes)
}
