//! `raycost render`.

use std::io;

use super::progress::{BuildBar, with_bar};
use super::scene::{Loaded, SceneArguments};
use super::{Failure, run_summary};
use crate::accel::Accel;
use crate::attribution::CostAttribution;
use crate::config::{Config, TileOrder};
use crate::cost::Meter;
use crate::film::columns;
use crate::folder::OutputFolder;
use crate::instruments::{HardwareCounters, NoProfiler, Profiler, Stages};
use crate::memory;
use crate::output::{self, Rendering};
use crate::render::{N_RENDERINGS, Overhead, Plan, least_repeats, repeat};
use crate::scene::Scene;
use crate::stop;
use crate::summary::Threads;
use crate::text::{self, Diagnostic};

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

    /// Sample in which functions the processor is, and write `profile.svg`, a
    /// flame graph; needs a build with `--features profile`
    #[arg(long)]
    profile: bool,

    /// Force the files onto the disk before they take their places: they survive
    /// a power cut right after
    #[arg(long)]
    sync: bool,

    /// End as soon as standard input does: with the process that holds its other end
    #[arg(long, hide = true)]
    while_input_is_open: bool,

    /// Print nothing but errors
    #[arg(long, short)]
    quiet: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.while_input_is_open {
        std::thread::spawn(|| {
            let _ = io::copy(&mut io::stdin(), &mut io::sink());
            stop::request();
        });
    }
    let profiler = arguments.profile.then(start_profiler).transpose()?;
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
    let folder = folder.synced(arguments.sync);
    output::refuse_foreign(&folder)?;
    let pool = thread_pool(arguments.threads)?;
    stages.end("read");
    stop::check()?;

    let bar = BuildBar::new(arguments.quiet);
    let report = |part| bar.advance(part);
    let accel = pool.install(|| Accel::build(&scene.primitives, config.acceleration, report));
    bar.clear();
    let accel = accel.map_err(|error| source.point_at(memory::too_large(error)))?;
    stages.end("build");
    stop::check()?;
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
        let n_pixels = N_RENDERINGS as u64 * n_pixels;
        let overhead = with_bar(n_pixels, arguments.quiet, |report| {
            pool.install(|| Overhead::measure(&scene, &accel, &plan, report))
        });
        stages.end("overhead");
        overhead
    });

    let n_rendered = u64::from(least_repeats(&config)) * n_pixels;
    let (film, schedule, repeats) = with_bar(n_rendered, arguments.quiet, |report| {
        pool.install(|| repeat(config.repeats, &scene, &accel, &plan, &meter, report))
    });
    stages.end("render");
    stop::check()?;

    let attribution = CostAttribution::is_requested(&config.output).then(|| {
        let world = (&scene, &accel, &config.image);
        let attribution = with_bar(n_pixels, arguments.quiet, |report| {
            pool.install(|| {
                CostAttribution::measure(world, (&film, &meter), &config.output, report)
            })
        });
        stages.end("observe");
        attribution
    });

    stop::check()?;
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
        attribution: attribution.as_ref(),
        profiler: profiler.as_ref(),
        threads: Threads {
            used: pool.current_num_threads(),
            available: std::thread::available_parallelism().map_or(1, usize::from),
        },
    };
    let (written, stages) = pool.install(|| output::write(&rendering, &folder, stages))?;
    if !arguments.quiet {
        let text = run_summary::lines(&arguments.scene, &rendering, &stages, &written);
        text::print(&text)?;
    }
    Ok(())
}

fn start_profiler() -> Result<Profiler, Failure> {
    Profiler::start().map_err(|none| match none {
        NoProfiler::NotBuilt => Diagnostic::new("this raycost was built without a profiler")
            .with_help("build one: `cargo run --release --features profile -- render …`")
            .into(),
        NoProfiler::Unknown => Diagnostic::new("profiles are taken on Linux and macOS alone")
            .with_help("leave out `--profile`")
            .into(),
        NoProfiler::Refused(why) => Failure::Machine(
            Diagnostic::new(format!("cannot start the profiler: {why}"))
                .with_help("leave out `--profile`"),
        ),
    })
}

/// The bytes that the files take at least, whatever the camera sees and however
/// well it compresses.
fn least_bytes(config: &Config) -> u64 {
    // frame.vti holds all arrays but the positions.
    let per_pixel: usize = columns(config.cost, config.repeats)
        .map(|column| column.stride())
        .sum();
    (config.image.n_pixels() * per_pixel) as u64 / config.compress.max_ratio()
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
