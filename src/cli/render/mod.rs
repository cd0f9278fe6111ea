//! `raycost render`.

mod hierarchies;
mod frames;
mod combinations;
mod merge;
mod only_picture;
mod part;
mod picture;
mod picture_run;
mod ranks;
mod run_arguments;
mod tiles;

use std::io;
use std::time::{Duration, Instant};

use only_picture::PictureFile;
use part::PartDone;
use picture::FinishedPicture;
use picture_run::PictureRun;
use ranks::Crew;
use run_arguments::RunArguments;

use crate::cli::open_scene::OpenScene;
use crate::cli::progress::Bars;
use crate::cli::scene::SceneArguments;
use crate::cli::{Failure, json, keyword, run_summary};
use crate::session::{Event, Options, Session, without_thread};
use base::numbers::parse_duration;
use base::stop;
use host::folder::refuse_root;
use host::start_detached;
use host::text::{self, Diagnostic};
use output::estimate::Memory;
use render::checkpoint::PicturePart;
use render::instruments::{HardwareCounters, NoProfiler, Profiler, Stages};
use render::ranks::{Order, Ranks};
use scene::animation::FrameRange;
use scene::build::Geometries;
use scene::config::{Config, Pinning, SimdSet, Traversal};

pub(super) use merge::{MergeArguments, run as run_merge};
pub(super) use ranks::fail_on_a_rank;
pub(super) use tiles::{OF_ANOTHER_RUN, UNFINISHED, go_on};

/// Render a scene and write its files
#[derive(Debug, Clone, Default, clap::Args)]
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

    /// Where the threads may run; `threads` in summary.json says where they could
    #[arg(long, value_name = "WHERE", default_value = "none", value_parser = keyword::<Pinning>())]
    pin: Pinning,

    /// Vector instructions to use [default: the fastest that the processor has]
    #[arg(long, value_name = "SET", value_parser = keyword::<SimdSet>())]
    simd: Option<SimdSet>,

    /// How to trace the rays of a wave [default: stream]
    #[arg(long, value_name = "HOW", value_parser = keyword::<Traversal>())]
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

    /// Stop when standard input ends, as it does with the process at its other end
    #[arg(long, hide = true)]
    while_input_is_open: bool,

    /// Print the `summary.json` of the run as a line of JSON, after the output folder; of an
    /// animation, a line for each frame
    #[arg(long, conflicts_with_all = ["picture", "part"])]
    json: bool,

    #[command(flatten)]
    run: RunArguments,
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
        let watch = start_detached(|| {
            let _ = io::copy(&mut io::stdin(), &mut io::sink());
            stop::request();
        });
        watch.map_err(|error| Failure::Machine(without_thread(&error)))?;
    }
    render_scene(arguments, ranks)
}

/// Renders a scene, a part of it, or the tiles of all parts; then dismisses the other ranks.
fn render_scene(arguments: &RenderArguments, ranks: Option<Ranks>) -> Result<(), Failure> {
    let deadline = arguments.deadline();
    arguments.check_flags()?;
    arguments.run.prepare()?;
    arguments.simd.map(SimdSet::detect).transpose()?;
    refuse_root(&arguments.scene.out())?;
    let stages = Stages::with_start(arguments.hardware());
    let crew = ranks.map(|ranks| Crew::meet(arguments, ranks));
    let crew = crew.transpose()?;
    if arguments.picture.is_none() {
        arguments.scene.refuse_other_output()?;
    }
    let source = arguments.scene.source()?;
    if let Some(crew) = &crew {
        crew.send_scene(&source);
    }
    let scene = OpenScene::parse(&arguments.scene, source)?;
    let done = match &scene.frames {
        Some(frames) if arguments.picture.is_none() => {
            frames::render(arguments, &scene, frames, crew.as_ref(), deadline)
        }
        _ => still(arguments, &scene, stages, crew.as_ref(), deadline),
    };
    if let (Some(crew), Ok(()) | Err(Failure::Partial)) = (crew, &done) {
        crew.leave();
    }
    done
}

/// Renders a still, or one frame as a still.
fn still(
    arguments: &RenderArguments,
    scene: &OpenScene,
    stages: Stages,
    crew: Option<&Crew>,
    deadline: Option<Instant>,
) -> Result<(), Failure> {
    let frame = arguments.only_frame(scene)?;
    let profiler = arguments.profile.then(start_profiler).transpose()?;
    if let Some(crew) = crew {
        crew.begin(Order::Still(frame));
    }
    let session = Session::new(scene.load(frame, arguments.needed())?, stages)?;
    arguments.check_bands(&session)?;
    let team = crew.map(|crew| crew.gather(arguments, &session));
    let team = team.transpose()?;
    if let Some(file) = &arguments.picture {
        return only_picture::render(arguments, &session, file, team.as_ref());
    }
    let out = arguments.scene.out();
    let run = PictureRun {
        arguments,
        session: &session,
        out: &out,
        deadline,
        profiler: profiler.as_ref(),
        team: team.as_ref(),
    };
    if let Some(part) = arguments.part {
        return still_part(run, part);
    }
    let picture = FinishedPicture::render(run)?;
    if arguments.json {
        json::print_summary(&out)?;
    } else if !arguments.run.quiet {
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
    let text = run_summary::lines(
        &arguments.scene,
        &view,
        rendering.look(),
        rendering.stages(),
        written,
    );
    let last = partial.map(|partial| tiles::partial_line(arguments, partial));
    format!("{text}{of_tiles}{}", last.unwrap_or_default())
}

/// Renders a part of a still, and prints the next step.
fn still_part(run: PictureRun, part: PicturePart) -> Result<(), Failure> {
    let done = part::render(run, part)?;
    if !run.arguments.run.quiet {
        let (line, next) = (done.line(part, run.out), part::next_line(run.out));
        text::print(&format!("{line}{next}"))?;
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

    /// Returns true if standard output has lines about the run.
    fn prints_lines(&self) -> bool {
        !self.run.quiet && !self.json
    }

    /// Returns the moment after which no further tile is started, if the rendering starts now.
    fn deadline(&self) -> Option<Instant> {
        // Without a deadline if the system's clock has no such time.
        self.timeout
            .and_then(|timeout| Instant::now().checked_add(timeout))
    }

    /// Returns the memory estimate of a still picture, or of a part of one.
    fn needed(&self) -> fn(&Config, &Geometries) -> Memory {
        match self.part {
            Some(_) => Memory::of_part,
            None => Memory::of_still,
        }
    }

    /// Returns the options of a session.
    fn options<'a>(&self, on_event: &'a (dyn Fn(Event) + Sync)) -> Options<'a> {
        Options {
            threads: self.run.threads,
            pin: self.pin,
            simd: self.simd,
            traversal: self.traversal.unwrap_or_default(),
            measure_overhead: self.measure_overhead,
            estimates_work: Bars::are_shown(self.run.quiet),
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
