//! `raycost render`.

mod hierarchies;
mod frames;
mod merge;
mod only_picture;
mod part;
mod picture;
mod ranks;
mod tiles;

use std::io;
use std::path::Path;
use std::time::{Duration, Instant};

use only_picture::PictureFile;
use part::PartDone;
use picture::{FinishedPicture, Until};
use ranks::Crew;

use crate::cli::open_scene::OpenScene;
use crate::cli::progress::Bars;
use crate::cli::scene::SceneArguments;
use crate::cli::{Failure, json, run_summary};
use crate::session::{Event, Options, Session};
use base::folder::refuse_root;
use base::stop;
use base::text::numbers::{parse_bytes, parse_duration};
use base::text::{self, Diagnostic};
use output::memory::{self, Memory};
use render::checkpoint::PicturePart;
use render::instruments::{HardwareCounters, NoProfiler, Profiler, Stages};
use render::ranks::{Ranks, n_launched};
use scene::animation::FrameRange;
use scene::config::{Config, Pinning, SimdSet, Traversal};
use scene::world::Geometries;
use vtk::hdf;

pub(super) use merge::{MergeArguments, run as run_merge};
pub(super) use ranks::fail_on_a_rank;

/// Render a scene and write its files
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Examples:
  raycost render configs/seed_sphere.yaml
  raycost render configs/seed_extended.yaml --width 1600 --height 1200 --spp 4 --out /tmp/big
  raycost render configs/seed_sphere.yaml -o sphere.png")]
pub(super) struct RenderArguments {
    #[command(flatten)]
    scene: SceneArguments,

    /// Write only the picture, to this file: `.png`, or `.exr` for its linear light. Measures no
    /// cost, unless `--cost` asks for it
    #[arg(long, short = 'o', value_name = "FILE", conflicts_with_all = [
        "out", "also", "compress", "part", "resume", "timeout", "format", "measure_overhead",
        "hardware_counters", "profile",
    ])]
    picture: Option<PictureFile>,

    /// Frames of an animated scene to render, such as 7 or 10..19, both ends included
    /// [default: all]
    #[arg(long, value_name = "FRAMES")]
    frames: Option<FrameRange>,

    /// Render only this part, such as 3/16: its tiles, for `raycost merge`. All parts take
    /// about the same work
    #[arg(long, value_name = "PART")]
    part: Option<PicturePart>,

    /// Keep finished tiles in the output folder while rendering, and continue an interrupted run
    /// from its tiles
    #[arg(long)]
    resume: bool,

    /// Begin no tile after this time, such as 90s, 30m or 1.5h, and write what there is,
    /// marked as partial: `--resume` goes on
    #[arg(long, value_name = "TIME", value_parser = parse_duration)]
    timeout: Option<Duration>,

    /// Take all tiles from the files of parts
    #[arg(skip)]
    merges: bool,

    /// Also write cloud and frame in this format; an animation has one file each for all frames.
    /// Needs a build with `--features hdf5`
    #[arg(long, value_name = "FORMAT")]
    format: Option<ExtraFormat>,

    /// Number of threads [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    /// Where the threads may run; `threads` in summary.json says where they could
    #[arg(long, value_name = "WHERE", default_value = "none")]
    pin: Pinning,

    /// Vector instructions to use [default: the fastest that the processor has]
    #[arg(long, value_name = "SET")]
    simd: Option<SimdSet>,

    /// How to trace the rays of a wave [default: stream]
    #[arg(long, value_name = "HOW")]
    traversal: Option<Traversal>,

    /// Also render in each cost mode in turn, and report the overhead of measuring
    #[arg(long)]
    measure_overhead: bool,

    /// Count cycles, instructions, cache and branch misses of each stage in hardware, and the
    /// energy of the machine's processors, if the machine allows it; see `stages` in summary.json
    #[arg(long)]
    hardware_counters: bool,

    /// Sample the running functions and write `profile.svg`, a flame graph; needs a
    /// build with `--features profile`
    #[arg(long)]
    profile: bool,

    /// Flush the files to the disk before they replace older ones, so that they survive
    /// a power cut
    #[arg(long)]
    sync: bool,

    /// Use at most this much memory, such as 4G or 500M [default: three quarters of what is
    /// available]. A picture that needs more is written in pieces, by way of a file of tiles
    #[arg(long, value_name = "SIZE", value_parser = parse_bytes)]
    memory: Option<u64>,

    /// Stop when standard input ends, as it does with the process at its other end
    #[arg(long, hide = true)]
    while_input_is_open: bool,

    /// Print the `summary.json` of the run as a line of JSON, after the output folder; of an
    /// animation, a line for each frame
    #[arg(long, conflicts_with_all = ["quiet", "picture", "part"])]
    json: bool,

    /// Print only errors
    #[arg(long, short)]
    quiet: bool,
}

/// A format of cloud and frame besides VTK's XML files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum ExtraFormat {
    /// VTK's format in HDF5
    Vtkhdf,
}

pub(super) fn run(arguments: &RenderArguments) -> Result<(), Failure> {
    let mut arguments = arguments.clone();
    if let Some(file) = &arguments.picture {
        arguments.scene.want_only_picture(file.format);
    }
    let arguments = &arguments;
    // Processes with parts share no picture: each renders a separate one.
    let ranks = match arguments.part {
        Some(_) => None,
        None => Ranks::join()?,
    };
    match ranks {
        Some(ranks) if ranks.rank() > 0 => ranks::help(arguments, ranks),
        ranks => lead(arguments, ranks),
    }
}

/// Renders as the only process, or as rank 0 of several.
fn lead(arguments: &RenderArguments, ranks: Option<Ranks>) -> Result<(), Failure> {
    if arguments.while_input_is_open && !arguments.scene.is_standard_input() {
        std::thread::spawn(|| {
            let _ = io::copy(&mut io::stdin(), &mut io::sink());
            stop::request();
        });
    }
    arguments.check_part()?;
    arguments.check_kept()?;
    render_scene(arguments, ranks)
}

/// Renders a scene, a part of it, or the tiles of all parts.
fn render_scene(arguments: &RenderArguments, ranks: Option<Ranks>) -> Result<(), Failure> {
    let deadline = arguments.deadline();
    if let Some(limit) = arguments.memory {
        memory::set_limit(limit);
    }
    arguments.check_format()?;
    arguments.simd.map(SimdSet::detect).transpose()?;
    refuse_root(&arguments.scene.out())?;
    let stages = Stages::with_start(arguments.hardware());
    let crew = ranks
        .map(|ranks| Crew::meet(arguments, ranks))
        .transpose()?;
    let source = arguments.scene.source()?;
    let shared = crew.as_ref().map(|crew| crew.send(&source));
    let scene = OpenScene::of(&arguments.scene, source)?;
    if crew.is_some() {
        arguments.check_ranks(scene.frames.is_some())?;
    }
    let frame = match (&scene.frames, &arguments.picture) {
        (Some(_), Some(_)) => Some(arguments.only_frame()?),
        (Some(frames), None) => return frames::render(arguments, &scene, frames, deadline),
        (None, _) => arguments.frames.as_ref().map(|range| *range.0.start()),
    };
    let profiler = arguments.profile.then(start_profiler).transpose()?;
    let input = scene.load(frame, arguments.needed())?;
    if let Some(shared) = shared {
        shared.end();
    }
    let session = Session::new(input, stages)?;
    arguments.check_bands(&session)?;
    let out = arguments.scene.out();
    if let Some(part) = arguments.part {
        return still_part(arguments, &session, &out, (part, deadline));
    }
    let team = crew.map(|crew| crew.gather(arguments, &session));
    let team = team.transpose()?;
    if let Some(file) = &arguments.picture {
        return only_picture::render(arguments, &session, file, team);
    }
    let until = Until {
        deadline,
        profiler: profiler.as_ref(),
        team: team.as_ref(),
        is_only_rank: !arguments.merges && n_launched() == Some(1),
    };
    let picture = FinishedPicture::render(arguments, &session, &out, until)?;
    if let Some(team) = team {
        team.ranks.leave();
    }
    if arguments.json {
        json::print_summary(&out)?;
    } else if !arguments.quiet {
        text::print(&still_lines(arguments, &picture, profiler.as_ref()))?;
    }
    // The process ends: the system frees all memory at once.
    std::mem::forget(picture.rendering);
    picture.partial.map_or(Ok(()), |_| Err(Failure::Partial))
}

/// Returns the lines about a still that was rendered and written.
fn still_lines(
    arguments: &RenderArguments,
    picture: &FinishedPicture,
    profiler: Option<&Profiler>,
) -> String {
    let FinishedPicture {
        rendering,
        written,
        of_tiles,
        partial,
    } = picture;
    let view = rendering.view(profiler);
    let text = run_summary::lines(&arguments.scene, &view, rendering.stages(), written);
    let last = partial.map(|partial| tiles::partial_line(arguments, partial));
    format!("{text}{of_tiles}{}", last.unwrap_or_default())
}

/// Renders a part of a still, and prints the next step.
fn still_part(
    arguments: &RenderArguments,
    session: &Session,
    out: &Path,
    (part, deadline): (PicturePart, Option<Instant>),
) -> Result<(), Failure> {
    let done = part::render(arguments, session, out, (part, deadline))?;
    if !arguments.quiet {
        text::print(&format!("{}{}", done.line(part, out), part::next_line(out)))?;
    }
    match done {
        PartDone::Partial(_) => Err(Failure::Partial),
        PartDone::Rendered(..) | PartDone::Kept => Ok(()),
    }
}

impl RenderArguments {
    /// Starts the hardware counters, if requested.
    fn hardware(&self) -> HardwareCounters {
        if self.hardware_counters {
            HardwareCounters::start()
        } else {
            HardwareCounters::none()
        }
    }

    /// Returns the moment after which no further tile is started, if the rendering starts now.
    fn deadline(&self) -> Option<Instant> {
        // Without a deadline if the system's clock has no such time.
        self.timeout
            .and_then(|timeout| Instant::now().checked_add(timeout))
    }

    /// Checks that another run can continue the measurements.
    fn check_kept(&self) -> Result<(), Diagnostic> {
        let flag = match self.timeout {
            Some(_) => "timeout",
            None => "resume",
        };
        if self.measure_overhead && (self.resume || self.timeout.is_some()) {
            let message = format!("`--{flag}` and `--measure-overhead` exclude each other");
            let help = "the overhead takes many whole renderings: measure it in another run";
            return Err(Diagnostic::new(message).with_help(help));
        }
        Ok(())
    }

    /// Checks that this program can write the requested format.
    fn check_format(&self) -> Result<(), Failure> {
        if self.format.is_none() || hdf::IS_BUILT {
            return Ok(());
        }
        let message = "this raycost was built without HDF5, which `--format vtkhdf` needs";
        let help = "install libhdf5 with its headers (on Debian, `apt-get install libhdf5-dev`), \
                    then `cargo install --path . --features hdf5`";
        Err(Diagnostic::new(message).with_help(help).into())
    }

    /// Returns the memory estimate of a still picture, or of a part of one.
    fn needed(&self) -> fn(&Config, &Geometries) -> Memory {
        match self.part {
            Some(_) => Memory::of_part,
            None => Memory::of_still,
        }
    }

    /// Checks that a picture that is larger than memory can have these settings.
    fn check_bands(&self, session: &Session) -> Result<(), Diagnostic> {
        let flags = [
            (self.picture.is_some(), "picture"),
            (self.format.is_some(), "format"),
            (self.measure_overhead, "measure-overhead"),
        ];
        let Some((_, flag)) = flags.into_iter().find(|(is_given, _)| *is_given) else {
            return Ok(());
        };
        if session.bands().is_none() {
            return Ok(());
        }
        let message = format!("`--{flag}` needs a picture that fits into memory");
        let help = "choose a smaller `width` or `height`, or leave the flag out";
        Err(Diagnostic::new(message).with_help(help))
    }

    /// Returns the options of a session.
    fn options<'a>(&self, on_event: &'a (dyn Fn(Event) + Sync)) -> Options<'a> {
        Options {
            threads: self.threads,
            pin: self.pin,
            simd: self.simd,
            traversal: self.traversal.unwrap_or_default(),
            measure_overhead: self.measure_overhead,
            estimates_work: Bars::are_shown(self.quiet),
            on_event: Some(on_event),
            ..Options::default()
        }
    }
}

fn start_profiler() -> Result<Profiler, Failure> {
    Profiler::start().map_err(|none| match none {
        NoProfiler::NotBuilt => Diagnostic::new("this raycost was built without a profiler")
            .with_help("build one: `cargo run --release --features profile -- render …`")
            .into(),
        NoProfiler::Unknown => Diagnostic::new("only Linux and macOS take profiles")
            .with_help("leave out `--profile`")
            .into(),
        NoProfiler::Refused(why) => Failure::Machine(
            Diagnostic::new(format!("cannot start the profiler: {why}"))
                .with_help("leave out `--profile`"),
        ),
    })
}
