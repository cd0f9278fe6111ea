//! `raycost render`: flags → a [`Job`] → lines about it.

mod combinations;
mod merge;
mod picture_file;
mod run_arguments;
mod terminal;

use std::io;
use std::sync::Arc;
use std::time::Duration;

use picture_file::PictureFile;
use run_arguments::RunArguments;
use terminal::Terminal;

use crate::cli::device::{DeviceChoice, parse_device};
use crate::cli::progress::Bars;
use crate::cli::scene::SceneArguments;
use crate::cli::{Failure, keyword};
use crate::job::{self, Job, Kept, Output, PicturePart, Tiles};
use crate::session::{Options, RenderError, without_thread};
use base::numbers::{counted, parse_duration};
use base::stop;
use host::start_detached;
use host::text::{Diagnostic, shown};
use render::ranks::RankFailure;
use scene::animation::FrameRange;
use scene::config::{Pinning, SimdSet, Traversal};

pub(super) use merge::{MergeArguments, run as run_merge};
pub(super) use terminal::{OF_ANOTHER_RUN, go_on};

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
        "out", "also", "compress", "part", "resume", "timeout", "format",
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

    /// Where the threads may run; `threads` in summary.json says where they could
    #[arg(long, value_name = "WHERE", default_value = "none", value_parser = keyword::<Pinning>())]
    pin: Pinning,

    /// Vector instructions to use [default: the fastest that the processor has]
    #[arg(long, value_name = "SET", value_parser = keyword::<SimdSet>())]
    simd: Option<SimdSet>,

    /// How to trace the rays of a wave [default: stream]
    #[arg(long, value_name = "HOW", value_parser = keyword::<Traversal>())]
    traversal: Option<Traversal>,

    /// Render on another device than the `processor`, of `opencl` or `cuda`: `opencl:TEXT` is the first
    /// one whose name or driver contains the text. Same picture, same counters
    #[arg(long, value_name = "DEVICE", value_parser = parse_device)]
    device: Option<DeviceChoice>,

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
    let tiles = match arguments.part {
        Some(part) => Tiles::Part(part),
        None if arguments.resume => Tiles::Missing,
        None => Tiles::All,
    };
    let mut arguments = arguments.clone();
    if let Some(file) = &arguments.picture {
        arguments.scene.want_only_picture(file.format);
    }
    render(&arguments, tiles)
}

/// Renders these tiles, and prints lines about them.
fn render(arguments: &RenderArguments, tiles: Tiles) -> Result<(), Failure> {
    // Each rank limits its memory and opens its device.
    arguments.run.limit_memory();
    let job = arguments.job(tiles).map_err(|error| {
        let failure = Failure::from(error);
        if matches!(tiles, Tiles::All | Tiles::Missing) {
            fail_on_a_rank(&failure);
        }
        failure
    })?;
    let mut terminal = Terminal::new(arguments);
    let report = job::run(&job, &mut terminal).map_err(|error| match error {
        RenderError::Stopped(stopped, Some(kept)) => {
            let is_shown = !arguments.run.quiet;
            Failure::Stopped(stopped, is_shown.then(|| arguments.kept(kept)))
        }
        error => error.into(),
    })?;
    terminal.finish(&report)?;
    if report.is_partial {
        Err(Failure::Partial)
    } else {
        Ok(())
    }
}

/// Reports a failure before the rendering to rank 0, which prints it, if this is another rank.
pub(super) fn fail_on_a_rank(failure: &Failure) {
    job::fail_on_a_rank(&RankFailure {
        exit_code: failure.exit_code(),
        message: failure.text().unwrap_or_default(),
    });
}

impl RenderArguments {
    /// Returns the job of these arguments; opens the device.
    fn job(&self, tiles: Tiles) -> Result<Job<'_>, RenderError> {
        let device = self.device.as_ref().map(DeviceChoice::open).transpose()?;
        let output = match &self.picture {
            Some(file) => Output::Picture(file.path.clone()),
            None => Output::Folder(self.scene.out()),
        };
        Ok(Job {
            frames: self.frames.clone().map(|frames| frames.0),
            tiles,
            timeout: self.timeout,
            options: Options {
                threads: self.run.threads,
                pin: self.pin,
                simd: self.simd,
                traversal: self.traversal.unwrap_or_default(),
                device: device.flatten().map(Arc::new),
                estimates_work: Bars::are_shown(self.run.quiet),
                vtkhdf: self.run.format.is_some(),
                ..Options::default()
            },
            output,
            sync: self.run.sync,
            hardware_counters: self.hardware_counters,
            profile: self.profile,
            ..Job::new(&self.scene, "")
        })
    }

    /// Checks the flags, and applies those of the whole process.
    ///
    /// # Errors
    /// Flags that do not fit each other, or an output that this program cannot write.
    fn prepare(&self) -> Result<(), RenderError> {
        if self.while_input_is_open && !self.scene.is_standard_input() {
            let watch = start_detached(|| {
                let _ = io::copy(&mut io::stdin(), &mut io::sink());
                stop::request();
            });
            watch.map_err(|error| RenderError::Machine(without_thread(&error)))?;
        }
        self.check_flags()?;
        self.run.check_format()?;
        if self.picture.is_none() {
            self.scene.refuse_other_output()?;
        }
        Ok(())
    }

    /// Returns the message about what a stopped run keeps, and how to continue.
    fn kept(&self, kept: Kept) -> Diagnostic {
        let again = "run the same command again: it";
        let (what, help) = match kept {
            Kept::Nothing => (
                "nothing is kept of this picture".to_owned(),
                "with `--resume`, an interrupted run goes on where it was".to_owned(),
            ),
            Kept::Tiles(n_tiles, file) => (
                format!(
                    "kept {} in `{}`",
                    counted(n_tiles, "finished tile"),
                    shown(&file)
                ),
                go_on(&self.scene.scene),
            ),
            Kept::PartTiles(n_tiles, part) => (
                format!("kept {} of part {part}", counted(n_tiles, "finished tile")),
                format!("{again} goes on with the others"),
            ),
            Kept::Frames(n_frames) => (
                format!("kept {}", counted(n_frames, "complete frame")),
                format!("{again} leaves complete frames as they are"),
            ),
        };
        Diagnostic::new(format!("stopped: {what}")).with_help(help)
    }
}
