//! `raycost trace`.

mod json;
mod tree;

use std::path::Path;

use super::progress::StageBar;
use super::rectangle::PixelRectangle;
use super::scene::SceneArguments;
use super::thread_pool;
use super::{Failure, hottest, keyword, names_and_lengths, shell_word, shown};
use crate::job::{OpenScene, SceneSource};
use crate::session::{Input, Options};
use base::numbers::counted;
use base::stop;
use host::folder::{OutputFolder, Written};
use host::text::{self, Diagnostic};
use output::estimate::Memory;
use output::limits;
use output::writers::{RAYS_STATE, Traced, refuse_foreign_traced, write_traced};
use render::attribution::{ObservedPixel, PathObserver, TooManyRays};
use render::film::HotPixel;
use render::tiles::{Progress, TilePlan, render};
use scene::build::{Geometries, Sensor};
use scene::config::{Config, Image, Tiling, WrittenArrays};
use tracer::accel::Accel;
use tracer::cost::{Meter, Metric};
use tracer::trace::Tracer;
use tree::Trees;

/// Show all rays of some pixels and the cost of each
///
/// Prints the rays of the first pixels as trees, and writes the rays of all pixels with
/// a ParaView state that shows them in the scene.
#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("pixels").args(["pixel", "hottest"]).required(true))]
#[command(after_help = "\
For each ray, the tree shows what it hit, the distance, the cost, and its
contribution to the pixel's color. For a shadow ray, the contribution is in
parentheses: the light's share of the color of the ray above it. Times are
medians of five.

Examples:
  raycost trace configs/seed_extended.yaml --pixel 120,190
  raycost trace configs/hall_of_mirrors.yaml --pixel 390..409,240..249 --spp 1
  raycost trace configs/spot.yaml --hottest 3 --by node_visits")]
pub(super) struct TraceArguments {
    #[command(flatten)]
    scene: SceneArguments,

    /// Pixels to trace; 0,0 is at the top left. X and Y are numbers, or ranges such as
    /// 10..19, both ends included. Can be repeated
    #[arg(long, value_name = "X,Y")]
    pixel: Vec<PixelRectangle>,

    /// Trace the N most expensive pixels instead, 1 to 10,000; renders the picture to
    /// find them
    #[arg(long, value_name = "N")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=10_000))]
    hottest: Option<u32>,

    /// Metric of the most expensive pixels [default: time_ns, or node_visits if the
    /// scene does not measure times]
    #[arg(
        long,
        value_name = "METRIC",
        value_parser = keyword::<Metric>(),
        requires = "hottest",
        conflicts_with = "pixel"
    )]
    by: Option<Metric>,

    /// Frame of an animated scene [default: the first]
    #[arg(long, value_name = "N")]
    frame: Option<u32>,

    /// Number of threads [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    /// Print each pixel with all of its rays as a line of JSON
    #[arg(long)]
    json: bool,

    /// Print only errors
    #[arg(long, short)]
    quiet: bool,
}

/// Longest side of the cloud's picture in pixels: dense enough for `rays.pvsm`, and rendered in a
/// fraction of a second.
const CLOUD_SIDE: u32 = 320;

pub(super) fn run(arguments: &TraceArguments) -> Result<(), Failure> {
    arguments.scene.refuse_also()?;
    arguments.scene.refuse_other_output()?;
    let open = OpenScene::read(&arguments.scene)?;
    let needed = |config: &Config, geometries: &Geometries| match arguments.metric(config) {
        // The picture is rendered to find the pixels.
        Some(metric) => Memory::estimate(&hottest::searched(config, metric), geometries),
        None => Memory::estimate_scene(config, geometries),
    };
    let Input {
        document,
        config,
        geometries,
        ..
    } = open.load(arguments.frame, needed)?;
    let options = Options {
        threads: arguments.threads,
        ..Options::default()
    };
    let base = open.base_of(arguments.frame, &options)?;
    let image = config.image;
    for rectangle in &arguments.pixel {
        rectangle.check(&image)?;
    }
    let meter = Meter::new(config.cost);
    let scene =
        scene::build::scene(&config, geometries).map_err(|fault| document.point_at(fault))?;
    let folder = OutputFolder::create(&arguments.scene.out(), 0)?;
    refuse_foreign_traced(&folder)?;
    let pool = thread_pool(arguments.threads)?;
    let bar = StageBar::for_build(arguments.quiet);
    let report = |part| bar.advance_build(part);
    let kind = config.acceleration;
    let base = base.as_ref().map(|base| (base, image.n_camera_rays()));
    let accel = pool.install(|| Accel::build_frame(&scene, kind, base, &report));
    bar.clear();
    let accel = accel.map_err(|error| document.point_at(limits::too_large(error)))?;
    let tracer = Tracer::new(&scene, &accel);
    let pixels = pool.install(|| TracedPixels::choose(arguments, &config, tracer))?;

    // The cloud is a small picture of the scene, sharp without a lens.
    let mut small = Sensor::with_image(&scene, &config, small(&image));
    small.plane = small.plane.without_lens();
    // Its state needs arrays that `output.arrays` may leave out.
    small.extra_arrays.written = WrittenArrays::default();
    let (cloud, _) = pool.install(|| {
        let plan = TilePlan::new(tracer, &small, Tiling::default());
        render(tracer, &plan, &Meter::Off, &|_| {})
    });
    stop::check()?;
    let sensor = Sensor::new(&scene, &config);
    let observer = PathObserver::new(tracer, &sensor, meter.clock()).without_steps();
    let observed = pool.install(|| observe(&observer, &pixels, arguments.quiet))?;
    stop::check()?;
    let traced = Traced {
        name: &arguments.scene.name(),
        time: open.time(arguments.frame),
        scene: &scene,
        plane: &sensor.plane,
        pixels: &observed,
        is_timed: meter.clock().is_some(),
        cloud: &cloud,
    };
    let written = write_traced(&traced, config.compress, &folder)?;
    if arguments.json {
        for pixel in &observed {
            super::json::print(&json::pixel(pixel, &traced, &config))?;
        }
    } else if !arguments.quiet {
        let trees = Trees::new(&config, &traced).text();
        let closing = closing_lines(&observed, &written, &arguments.scene.out());
        text::print_styled(&(trees + &pixels.found() + &closing))?;
    }
    Ok(())
}

/// The pixels to trace.
enum TracedPixels<'a> {
    /// Pixels of `--pixel`.
    Named(&'a [PixelRectangle]),
    /// Pixels of `--hottest`.
    Hottest(Metric, Vec<HotPixel>),
}

impl<'a> TracedPixels<'a> {
    /// Returns the pixels of the arguments; for `--hottest` renders the picture on the current
    /// rayon pool.
    fn choose(
        arguments: &'a TraceArguments,
        config: &Config,
        tracer: Tracer,
    ) -> Result<Self, Failure> {
        let Some((n, metric)) = arguments.hottest.zip(arguments.metric(config)) else {
            return Ok(Self::Named(&arguments.pixel));
        };
        let config = hottest::searched(config, metric);
        let film = hottest::search(&config, tracer, arguments.quiet);
        let found = hottest::pixels(&film, metric, n as usize)?;
        Ok(Self::Hottest(metric, found))
    }

    /// Returns the number of pixels.
    fn n(&self) -> u64 {
        match self {
            Self::Named(rectangles) => rectangles.iter().map(PixelRectangle::n_pixels).sum(),
            Self::Hottest(_, pixels) => pixels.len() as u64,
        }
    }

    /// Returns the column and row of each pixel.
    fn places(&self) -> Box<dyn Iterator<Item = (u32, u32)> + '_> {
        match self {
            Self::Named(rectangles) => Box::new(PixelRectangle::pixels(rectangles)),
            Self::Hottest(_, pixels) => Box::new(pixels.iter().map(|pixel| pixel.place)),
        }
    }

    /// Returns a line with the pixels that `--hottest` found; empty for `--pixel`.
    fn found(&self) -> String {
        match self {
            Self::Named(_) => String::new(),
            Self::Hottest(metric, pixels) => hottest::found(pixels, *metric),
        }
    }
}

impl TraceArguments {
    /// Returns the metric of `--hottest`; `None` without it.
    fn metric(&self, config: &Config) -> Option<Metric> {
        self.hottest?;
        let by_default = Metric::measured_by(config.cost).unwrap_or(Metric::NODE_VISITS);
        Some(self.by.unwrap_or(by_default))
    }
}

/// Returns a small image with the same aspect ratio and one sample per pixel.
fn small(image: &Image) -> Image {
    let longest = image.width.max(image.height);
    image.shrunk(|side| {
        if longest <= CLOUD_SIDE {
            side
        } else {
            (u64::from(side) * u64::from(CLOUD_SIDE)).div_ceil(u64::from(longest)) as u32
        }
    })
}

/// Traces the rays of all pixels, if they fit into half of the free memory; the other half is for
/// writing them.
fn observe(
    observer: &PathObserver,
    pixels: &TracedPixels,
    quiet: bool,
) -> Result<Vec<ObservedPixel>, Failure> {
    let n_pixels = pixels.n();
    let bar = StageBar::for_pixels("", n_pixels, quiet);
    let report = |n_pixels| bar.advance(Progress::from_pixels(n_pixels, 0));
    let observed = observer.observe_many(pixels.places(), limits::available() / 2, report);
    bar.clear();
    observed.map_err(|error| too_many(error, n_pixels))
}

fn too_many(error: TooManyRays, n_pixels: u64) -> Failure {
    let help = format!(
        "trace fewer than {}, or fewer samples with `--spp N`",
        counted(n_pixels, "pixel")
    );
    Failure::Machine(Diagnostic::new(error.to_string()).with_help(help))
}

/// Returns the written files and the next command.
fn closing_lines(pixels: &[ObservedPixel], written: &[Written], out: &Path) -> String {
    let n_rays: usize = pixels.iter().map(|pixel| pixel.tree.rays.len()).sum();
    format!(
        "traced  {} of {}\n\
         wrote   {}: {}\n\
         next    paraview --state={}\n",
        counted(n_rays as u64, "ray"),
        counted(pixels.len() as u64, "pixel"),
        shown(out),
        names_and_lengths(written).join(", "),
        shell_word(&out.join(RAYS_STATE)),
    )
}
