//! `raycost render`.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::charges;
use super::progress::{Bar, BuildBar};
use super::trust;
use super::{Failure, shell_word};
use crate::accel::Accel;
use crate::config::{Config, CostMode, Extra, MAX_SIDE, Structure, TileOrder, Tiling};
use crate::cost::Meter;
use crate::film::{Column, columns};
use crate::ledger::Ledger;
use crate::memory::{self, Memory};
use crate::output::{
    self, HardwareCounters, OutputFolder, Rendering, Stages, Threads, Written,
    format::{bytes, count, counted, duration},
};
use crate::render::{N_RENDERINGS, Overhead, Plan, repeat};
use crate::scene::{Geometries, Scene};
use crate::schedule::Schedule;
use crate::yaml::{self, Diagnostic, Fault, Source};

/// Render a scene and write its files
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  raycost render configs/seed_sphere.yaml
  raycost render configs/seed_extended.yaml --width 1600 --height 1200 --spp 4 --out /tmp/big")]
pub(super) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,

    /// Threads to render on [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    /// Also render in each mode of `--cost` by turns, and tell what measuring costs
    #[arg(long)]
    measure_overhead: bool,

    /// Have the processor count cycles, instructions, cache and branch misses of
    /// each stage, where the machine lets it; see `stages` in summary.json
    #[arg(long)]
    hardware_counters: bool,

    /// Print nothing but errors
    #[arg(long, short)]
    quiet: bool,
}

/// What names a scene and changes it.
#[derive(Debug, clap::Args)]
pub(super) struct SceneArguments {
    /// The scene's YAML file
    pub(super) scene: PathBuf,

    /// Folder to write to [default: out/<the scene file's name>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Columns of the picture, instead of the file's
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(1..=MAX_SIDE as i64))]
    width: Option<u32>,

    /// Rows of the picture, instead of the file's
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(1..=MAX_SIDE as i64))]
    height: Option<u32>,

    /// Samples per pixel, instead of the file's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65_536))]
    spp: Option<u32>,

    /// Seed of the sampling pattern, instead of the file's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,

    /// Longest path in bounces, instead of the file's
    #[arg(long, value_name = "BOUNCES")]
    max_depth: Option<u8>,

    /// How hits are found, instead of the file's
    #[arg(long, value_name = "STRUCTURE")]
    acceleration: Option<Structure>,

    /// Spheres of each `sphere_cloud`, instead of the file's; their radii change
    /// so that they fill the same share of space
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000_000))]
    count: Option<u32>,

    /// What is measured of each pixel, instead of the file's
    #[arg(long, value_name = "MODE")]
    cost: Option<CostMode>,

    /// Short for `--cost none`
    #[arg(long, conflicts_with = "cost")]
    no_cost: bool,

    /// Times to render the picture: a pixel's time becomes the median
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..))]
    repeats: Option<u8>,

    /// Pixels along a tile's side, instead of the file's
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(Tiling::MIN_SIZE as i64..=Tiling::MAX_SIZE as i64))]
    tile_size: Option<u32>,

    /// In which order threads take tiles, instead of the file's
    #[arg(long, value_name = "ORDER")]
    tile_order: Option<TileOrder>,

    /// Files to write beside those of every run, and those that the scene asks for
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    also: Vec<Extra>,
}

/// A scene file, what it says, and what the files hold that it names.
pub(super) struct Loaded {
    pub(super) source: Source,
    pub(super) config: Config,
    pub(super) geometries: Geometries,
}

impl SceneArguments {
    /// Reads the scene and makes sure that it fits into memory with its film.
    pub(super) fn load(&self) -> Result<Loaded, Diagnostic> {
        self.load_for(Memory::of)
    }

    /// Reads the scene and makes sure that what is done with it fits into memory.
    pub(super) fn load_for(
        &self,
        needed: impl Fn(&Config, &Geometries) -> Memory,
    ) -> Result<Loaded, Diagnostic> {
        let source = Source::read(&self.scene)?;
        let mut config: Config = source.parse()?;
        let image = &mut config.image;
        image.width = self.width.unwrap_or(image.width);
        image.height = self.height.unwrap_or(image.height);
        image.samples_per_pixel = self.spp.unwrap_or(image.samples_per_pixel);
        image.seed = self.seed.unwrap_or(image.seed);
        config.shading.max_depth = self.max_depth.unwrap_or(config.shading.max_depth);
        config.acceleration = self.acceleration.map_or(config.acceleration, Into::into);
        if let Some(count) = self.count {
            config
                .set_count(count)
                .map_err(|fault| source.point_at(fault))?;
        }
        config.cost = self.cost().unwrap_or(config.cost);
        config.n_repeats = self.n_repeats(&config, &source)?;
        let tiles = &mut config.tiles;
        tiles.size = self.tile_size.unwrap_or(tiles.size);
        tiles.order = self.tile_order.unwrap_or(tiles.order);
        let by_file = config.output.clone();
        self.also.iter().for_each(|&extra| config.output.add(extra));
        config
            .check_output()
            .map_err(|(extra, fault)| match by_file.has(extra) {
                true => source.point_at(fault),
                false => Diagnostic::without_place(fault),
            })?;
        let available = memory::available();
        let geometries = Geometries::read(&config, source.folder(), available)
            .map_err(|fault| source.point_at(fault))?;
        // What was read is part of the need, and no longer of what is free.
        needed(&config, &geometries)
            .check(available)
            .map_err(|fault| source.point_at(fault))?;
        Ok(Loaded {
            source,
            config,
            geometries,
        })
    }

    /// For a command that has its own files: makes sure that no others are
    /// asked for.
    pub(super) fn refuse_also(&self) -> Result<(), Diagnostic> {
        match self.also.is_empty() {
            true => Ok(()),
            false => Err(Diagnostic::new("these files are none of this command's")
                .with_help("give `--also` to `raycost render`")),
        }
    }

    /// What the command line says of the cost, if anything.
    fn cost(&self) -> Option<CostMode> {
        match self.no_cost {
            true => Some(CostMode::None),
            false => self.cost,
        }
    }

    /// How often to render.
    fn n_repeats(&self, config: &Config, source: &Source) -> Result<u8, Diagnostic> {
        match self.repeats {
            Some(_) if !config.cost.has_time() => {
                let message = "`--repeats` needs times, and none are taken";
                match self.cost() {
                    Some(_) => Err(Diagnostic::new(message)
                        .with_help("ask for `--cost time`, or leave out `--repeats`")),
                    None => Err(source.point_at(
                        Fault::new(
                            yaml::Path::default().key("cost"),
                            message,
                            "expected `time`",
                        )
                        .with_help("add `--cost time`, or leave out `--repeats`"),
                    )),
                }
            }
            n_repeats => Ok(n_repeats.unwrap_or(1)),
        }
    }

    /// The folder to write to.
    pub(super) fn out(&self) -> PathBuf {
        match &self.out {
            Some(out) => out.clone(),
            None => Path::new("out").join(self.name()),
        }
    }

    /// The scene's name.
    fn name(&self) -> String {
        let stem = self.scene.file_stem().unwrap_or_default();
        stem.to_string_lossy().into_owned()
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut stages = Stages::start(match arguments.hardware_counters {
        true => HardwareCounters::start(),
        false => HardwareCounters::none(),
    });
    let Loaded {
        source,
        config,
        geometries,
    } = arguments.scene.load()?;
    let scene = Scene::new(&config, geometries).map_err(|fault| source.point_at(fault))?;
    let folder = OutputFolder::create(&arguments.scene.out(), least_bytes(&config))?;
    remove_unfinished_when_stopped(&folder)?;
    let pool = thread_pool(arguments.threads)?;
    stages.end("read");

    let bar = BuildBar::new(arguments.quiet);
    let report = |part| bar.advance(part);
    let accel = pool.install(|| Accel::build(&scene.primitives, config.acceleration, report));
    bar.clear();
    let accel = accel.map_err(|error| source.point_at(memory::too_large(error)))?;
    stages.end("build");
    let meter = Meter::new(config.cost);
    if meter.clock().is_some() {
        stages.end("calibrate");
    }

    let plan = pool.install(|| Plan::new(&scene, &accel, &config.image, config.tiles));
    if plan.order == TileOrder::Cost {
        stages.end("order");
    }

    let n_pixels = config.image.n_pixels() as u64;
    // Before there is a film: two would take more memory than one.
    let overhead = arguments.measure_overhead.then(|| {
        let bar = Bar::new(N_RENDERINGS as u64 * n_pixels, arguments.quiet);
        let report = |progress| bar.advance(progress);
        let overhead = pool.install(|| Overhead::measure(&scene, &accel, &plan, report));
        bar.clear();
        stages.end("overhead");
        overhead
    });

    let n_repeats = config.n_repeats;
    let bar = Bar::new(u64::from(n_repeats) * n_pixels, arguments.quiet);
    let report = |progress| bar.advance(progress);
    let (film, schedule, repeats) =
        pool.install(|| repeat(n_repeats, &scene, &accel, &plan, &meter, report));
    bar.clear();
    stages.end("render");

    let ledger = Ledger::is_wanted(&config.output).then(|| {
        let bar = Bar::new(config.image.n_pixels() as u64, arguments.quiet);
        let report = |progress| bar.advance(progress);
        let world = (&scene, &accel, &config.image);
        let keep = || Ledger::keep(world, (&film, &meter), &config.output, report);
        let ledger = pool.install(keep);
        bar.clear();
        stages.end("observe");
        ledger
    });

    let rendering = Rendering {
        scene_file: source.name(),
        name: &arguments.scene.name(),
        config: &config,
        scene: &scene,
        bvh: accel.statistics(),
        meter: &meter,
        film: &film,
        schedule: &schedule,
        repeats: &repeats,
        overhead,
        ledger: ledger.as_ref(),
        threads: Threads {
            used: pool.current_num_threads(),
            available: std::thread::available_parallelism().map_or(1, usize::from),
        },
    };
    let (written, stages) = pool.install(|| output::write(&rendering, &folder, stages))?;
    if !arguments.quiet {
        let text = closing_lines(arguments, &rendering, &stages, &written);
        io::stdout().write_all(text.as_bytes())?;
    }
    Ok(())
}

/// The bytes that the files take at least, whatever the camera sees.
fn least_bytes(config: &Config) -> u64 {
    // frame.vti holds all arrays but the positions.
    let per_pixel: usize = columns(config.cost, config.n_repeats)
        .map(Column::stride)
        .sum();
    (config.image.n_pixels() * per_pixel) as u64
}

/// Lets Ctrl-C, or a request to end, leave no half-written file behind.
pub(super) fn remove_unfinished_when_stopped(folder: &OutputFolder) -> Result<(), Failure> {
    let folder = folder.clone();
    let stop = move || {
        folder.remove_unfinished();
        // 128 and the number of SIGINT, as shells have it.
        std::process::exit(130);
    };
    ctrlc::set_handler(stop).map_err(|error| {
        let message = format!("cannot listen for Ctrl-C: {error}");
        Failure::Machine(Diagnostic::new(message))
    })
}

pub(super) fn thread_pool(n_threads: Option<u16>) -> Result<rayon::ThreadPool, Failure> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(n_threads.map_or(0, usize::from))
        .build()
        .map_err(|error| {
            let message = format!("cannot start the threads: {error}");
            Failure::Machine(Diagnostic::new(message).with_help("ask for fewer with `--threads N`"))
        })
}

/// What was done and what to type next.
fn closing_lines(
    arguments: &Arguments,
    rendering: &Rendering,
    stages: &Stages,
    written: &[Written],
) -> String {
    let image = &rendering.config.image;
    let out = arguments.scene.out();
    let files: Vec<String> = written
        .iter()
        .map(|written| format!("{} ({})", written.file, bytes(written.bytes)))
        .collect();
    let times: Vec<String> = stages
        .ended
        .iter()
        .map(|stage| format!("{} {}", stage.name, duration(stages.wall(stage.name))))
        .collect();
    let costs = match rendering.ledger {
        Some(ledger) if rendering.config.output.has(Extra::Objects) => {
            charges::tables(rendering, ledger)
        }
        _ => String::new(),
    };
    let state = match rendering.film.cost.has_counters() {
        true => "heatmap.pvsm",
        false => "geometry.pvsm",
    };
    let trust = trust::lines(rendering);
    let tiles = match rendering.config.output.has(Extra::Schedule) {
        true => tiles(rendering.schedule),
        false => String::new(),
    };
    format!(
        "image   {} x {} pixels, {} per pixel, {}, {}\n\
         time    {}\n\
         speed   {}\n\
         {tiles}\
         {trust}\
         {}\
         wrote   {}: {}\n\
         next    paraview --state={}\n",
        image.width,
        image.height,
        counted(image.samples_per_pixel.into(), "sample"),
        primitives(rendering.scene),
        counted(rendering.threads.used as u64, "thread"),
        times.join(", "),
        speed(rendering),
        costs,
        out.display(),
        files.join(", "),
        shell_word(&out.join(state)),
    )
}

/// "1,234 primitives", and how many were left out.
pub(super) fn primitives(scene: &Scene) -> String {
    let kept = counted(scene.primitives.len() as u64, "primitive");
    match scene.n_degenerate {
        0 => kept,
        n => format!("{kept} ({} without area left out)", counted(n, "triangle")),
    }
}

/// How evenly the threads were at work.
fn tiles(schedule: &Schedule) -> String {
    let grid = &schedule.grid;
    let load = schedule.load();
    format!(
        "tiles   {} of {size} x {size}, {} order, load imbalance {:.1} %, {:.1} % idle\n",
        count(grid.n_tiles().into()),
        schedule.order.name(),
        100.0 * load.load_imbalance,
        100.0 * load.idle_share,
        size = grid.tile_size,
    )
}

/// Rays a second, or samples where nothing was counted.
fn speed(rendering: &Rendering) -> String {
    let seconds = rendering.median_wall().as_secs_f64();
    let millions = |n: u64| n as f64 / seconds / 1e6;
    match rendering.film.cost.has_counters() {
        true => {
            let n_rays = rendering.film.totals.n_rays();
            format!("{:.1} Mrays/s, {} rays", millions(n_rays), count(n_rays))
        }
        false => {
            let image = &rendering.config.image;
            let n_samples = image.n_pixels() as u64 * u64::from(image.samples_per_pixel);
            format!(
                "{:.1} million samples/s; rays were not counted",
                millions(n_samples)
            )
        }
    }
}
