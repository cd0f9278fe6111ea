//! raycost's kernels against Embree's: `cargo bench --bench embree`.
//!
//! Both get the same primitives, the same rays to the bit and the same number of threads, and take
//! turns in one process. Embree 3 or 4 is loaded at run time (`tests/with-embree` installs 3; PyPI's
//! `embreex` has 4 in its folder embreex.libs, for `--embree`) and uses whichever of its instruction
//! sets is faster; raycost is also compared with its robust mode.
//! raycost counts. `--tinybvh DIR` races single rays with tinybvh instead, which is compiled from
//! its header. The results are medians of millions of rays per second, and of primitives per
//! second for builds.

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
mod selection;
mod tinybvh;
mod trace;

use std::error::Error;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;

use arena::Arena;
use device::Device;
use ffi::Functions;
use race::Course;
use scenes::View;
use selection::Selection;
use tinybvh::TinyBvh;

use host::Allocator;
use world::scene::Primitive;

/// As in the program.
#[global_allocator]
static ALLOCATOR: Allocator = Allocator;

/// Compare the speed of raycost's kernels with Embree's.
#[derive(Debug, Parser)]
struct Options {
    /// Folder with meshes to use besides the generated scenes
    #[arg(long, value_name = "DIR")]
    meshes: Option<PathBuf>,
    #[command(flatten)]
    selection: Selection,
    /// Number of runs of each kernel
    #[arg(long, value_name = "N", default_value_t = 7)]
    rounds: usize,
    /// Rows and columns of the image
    #[arg(long, value_name = "PIXELS", default_value_t = 512)]
    side: usize,
    /// Rays per batch
    #[arg(long, value_name = "RAYS", default_value_t = 1024)]
    batch: usize,
    /// Write the table's rows to this file as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Embree's library, of version 3 or 4
    #[arg(long, value_name = "FILE", default_value = "libembree3.so.3")]
    embree: OsString,
    /// Race single rays with `BVH8_CPU` of the tiny_bvh.h in this folder, in place of Embree
    #[arg(long, value_name = "DIR", conflicts_with = "check")]
    tinybvh: Option<PathBuf>,
    /// Measure nothing, but fail if the hits differ by more than rounding
    #[arg(long)]
    check: bool,
    /// `cargo bench` passes it
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

    /// Writes results, if they are wanted.
    fn write(&self, results: &serde_json::Value) -> std::io::Result<()> {
        match &self.json {
            Some(path) => std::fs::write(path, format!("{results:#}")),
            None => Ok(()),
        }
    }
}

fn main() -> ExitCode {
    host::configure_heap();
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

/// Runs the races. Returns true if all hits agree, or are not compared.
fn run(options: &Options) -> Result<bool, Box<dyn Error>> {
    if let Some(folder) = &options.tinybvh {
        return race_tinybvh(options, folder).map(|()| true);
    }
    let embree = Functions::load(&options.embree)
        .map_err(|error| format!("{error}\n  install Embree 3, as `tests/with-embree` does"))?;
    // Lives as long as the process: devices and scenes refer to it.
    let embree: &'static Functions = Box::leak(Box::new(embree));
    let version = Device::new(embree, options.selection.isas()[0], 1)?.version();
    if options.check {
        println!("Embree {version}; rays that do not agree:");
    } else {
        println!("Embree {version}\n\n{}", report::HEAD);
    }
    let (mut rows, mut is_good) = (Vec::new(), true);
    for_each_scene(options, &mut |arena| {
        if options.check {
            println!("{}: {} rays", arena.name, arena.n_rays());
            is_good &= arena.check(embree)?;
            return Ok(());
        }
        arena.race(embree, options.course(), &mut |row| {
            println!("{row}");
            rows.push(row);
        })
    })?;
    options.write(&serde_json::json!({ "embree": version, "rows": rows }))?;
    Ok(is_good)
}

/// Races single rays with tinybvh, whose header is in this folder.
fn race_tinybvh(options: &Options, folder: &Path) -> Result<(), Box<dyn Error>> {
    let tinybvh = TinyBvh::load(folder)?;
    let version = tinybvh.version();
    println!("tinybvh {version}\n\n{}", report::HEAD);
    let (mut rows, mut differences) = (Vec::new(), Vec::new());
    for_each_scene(options, &mut |arena| {
        arena.race_tinybvh(&tinybvh, options.course(), &mut |row, agreement| {
            println!("{row}");
            if agreement.n_different() > 0 {
                differences.push(format!("{row} {agreement}"));
            }
            rows.push(row);
        });
        Ok(())
    })?;
    println!("\nRays that do not agree: {differences:#?}");
    Ok(options.write(&serde_json::json!({ "tinybvh": version, "rows": rows }))?)
}

/// Calls `race` with each selected scene.
fn for_each_scene(
    options: &Options,
    race: &mut dyn FnMut(&Arena) -> Result<(), String>,
) -> Result<(), Box<dyn Error>> {
    for (name, load) in scenes(options.meshes.as_deref())? {
        if options.selection.has_scene(&name) {
            let (primitives, view) = load();
            let selection = &options.selection;
            race(&Arena::new(
                selection,
                &name,
                &primitives,
                &view,
                options.side,
            )?)?;
        }
    }
    Ok(())
}

/// Loads or generates a scene.
type Load = Box<dyn Fn() -> (Vec<Primitive>, View)>;

/// Returns the scenes by name: the generated ones, and the meshes of the folder.
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
