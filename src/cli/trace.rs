//! `raycost trace`.

use std::io::Write;
use std::path::Path;

use super::progress::{Bar, BuildBar};
use super::rectangle::Rectangle;
use super::render::{remove_unfinished_when_stopped, thread_pool};
use super::scene::{Loaded, SceneArguments};
use super::tree::Trees;
use super::{Failure, shell_word};
use crate::accel::Accel;
use crate::config::{Config, CostMode, Image, Tiling};
use crate::cost::Meter;
use crate::memory::{self, Memory};
use crate::observe::{ObservedPixel, Observer, TooManyRays};
use crate::output::format::{bytes, counted};
use crate::output::{OutputFolder, Traced, Written, write_traced};
use crate::render::{Plan, Progress, render};
use crate::scene::Scene;
use crate::yaml::Diagnostic;

/// Show all rays of some pixels and what each costs
///
/// Prints the rays of the first pixels as trees, and writes those of all, with
/// a ParaView state that shows them in the scene.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Of each ray the tree tells what it met, how far away, what that cost, and what
it brings to the pixel's colour. What a shadow ray brings, in brackets, is its
light's part of the ray above it. Times are medians of five.

Examples:
  raycost trace configs/seed_extended.yaml --pixel 120,190
  raycost trace configs/hall_of_mirrors.yaml --pixel 390..409,240..249 --spp 1")]
pub(super) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,

    /// Pixels to trace; 0,0 is on the top left. X and Y are numbers, or ranges
    /// such as 10..19, both ends included. May be given more than once
    #[arg(long, value_name = "X,Y", required = true)]
    pixel: Vec<Rectangle>,

    /// Threads to trace on [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    /// Print nothing but errors
    #[arg(long, short)]
    quiet: bool,
}

/// Longest side of the cloud's picture: its dots lie close, and it takes no
/// longer than the blink of an eye.
const CLOUD_SIDE: u32 = 320;

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    arguments.scene.refuse_also()?;
    let Loaded {
        source,
        config,
        geometries,
    } = arguments.scene.load_for(Memory::of_scene)?;
    let image = config.image;
    for rectangle in &arguments.pixel {
        rectangle.check(&image)?;
    }
    let meter = Meter::new(config.cost);
    // The scene's own picture becomes the cloud; rays go through the plane of
    // the picture that was asked for.
    let plane = config.camera.image_plane(image.width, image.height);
    let config = Config {
        image: small(&image),
        cost: CostMode::None,
        ..config
    };
    let scene = Scene::new(&config, geometries).map_err(|fault| source.point_at(fault))?;
    let folder = OutputFolder::create(&arguments.scene.out(), 0)?;
    remove_unfinished_when_stopped(&folder)?;
    let pool = thread_pool(arguments.threads)?;
    let bar = BuildBar::new(arguments.quiet);
    let report = |part| bar.advance(part);
    let accel = pool.install(|| Accel::build(&scene.primitives, config.acceleration, report));
    bar.clear();
    let accel = accel.map_err(|error| source.point_at(memory::too_large(error)))?;
    let (cloud, _) = pool.install(|| {
        let plan = Plan::new(&scene, &accel, &config.image, Tiling::default());
        render(&scene, &accel, &plan, &Meter::Off, |_| {})
    });

    let observer = Observer::new(&scene, &accel, &image, meter.clock());
    let observer = observer.through(plane).without_steps();
    let pixels = pool.install(|| observe(&observer, arguments))?;
    let traced = Traced {
        scene: &scene,
        plane: &plane,
        pixels: &pixels,
        is_timed: meter.clock().is_some(),
        cloud: &cloud,
    };
    let written = write_traced(&traced, config.compress, &folder)?;
    if !arguments.quiet {
        let mut out = anstream::stdout().lock();
        Trees::new(&config, &traced).print(&mut out)?;
        let text = closing_lines(&pixels, &written, &arguments.scene.out());
        out.write_all(text.as_bytes())?;
    }
    Ok(())
}

/// An image of the same shape, small.
fn small(image: &Image) -> Image {
    let longest = image.width.max(image.height);
    let shrunk = |side: u32| match longest <= CLOUD_SIDE {
        true => side,
        false => (side * CLOUD_SIDE).div_ceil(longest),
    };
    Image {
        width: shrunk(image.width),
        height: shrunk(image.height),
        samples_per_pixel: 1,
        seed: 0,
    }
}

/// The rays of all pixels, if half of the memory that is left holds them: the
/// rest is for what is made of them.
fn observe(observer: &Observer, arguments: &Arguments) -> Result<Vec<ObservedPixel>, Failure> {
    let rectangles = &arguments.pixel;
    let n_pixels = rectangles.iter().map(Rectangle::n_pixels).sum();
    let bar = Bar::new(n_pixels, arguments.quiet);
    let report = |n_pixels| {
        bar.advance(Progress {
            n_pixels,
            n_rays: 0,
        })
    };
    let pixels = Rectangle::pixels(rectangles);
    let observed = observer.observe_many(pixels, memory::available() / 2, report);
    bar.clear();
    observed.map_err(|error| too_many(error, n_pixels))
}

fn too_many(error: TooManyRays, n_pixels: u64) -> Failure {
    let help = format!(
        "ask for fewer than {}, or for fewer samples with `--spp N`",
        counted(n_pixels, "pixel")
    );
    Failure::Machine(Diagnostic::new(error.to_string()).with_help(help))
}

/// What was written and what to type next.
fn closing_lines(pixels: &[ObservedPixel], written: &[Written], out: &Path) -> String {
    let n_rays: usize = pixels.iter().map(|pixel| pixel.tree.rays.len()).sum();
    let files: Vec<String> = written
        .iter()
        .map(|written| format!("{} ({})", written.file, bytes(written.bytes)))
        .collect();
    format!(
        "traced  {} of {}\n\
         wrote   {}: {}\n\
         next    paraview --state={}\n",
        counted(n_rays as u64, "ray"),
        counted(pixels.len() as u64, "pixel"),
        out.display(),
        files.join(", "),
        shell_word(&out.join("rays.pvsm")),
    )
}
