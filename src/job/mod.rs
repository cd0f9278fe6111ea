//! The pictures that a program renders, and their files: `raycost render` as a value.
//!
//! A [`Job`] names a scene, the frames and the tiles of it, and the files to write; [`run()`] renders
//! it. One process renders all tiles, a part of them, or those that an earlier run left; the ranks
//! of MPI run the same job, and rank 0 deals them the tiles.
//!
//! ```no_run
//! use std::time::Duration;
//! use raycost::job::{Job, Output, SceneFile, Tiles, run};
//! # fn main() -> Result<(), raycost::session::RenderError> {
//! let scene = SceneFile::new("configs/hopper.yaml").set("image.width=640");
//! // All frames; under `mpirun`, each by all ranks.
//! let whole = Job::new(&scene, "out/hopper");
//! println!("{} frames rendered", run(&whole, &mut ())?.n_rendered);
//! // For at most an hour; the next run continues where this one ended.
//! let resumed = Job {
//!     tiles: Tiles::Missing,
//!     timeout: Some(Duration::from_secs(3600)),
//!     ..whole.clone()
//! };
//! println!("ended early: {}", run(&resumed, &mut ())?.is_partial);
//! // The third of sixteen parts, and later the pictures of all parts.
//! let part = Job {
//!     tiles: Tiles::Part("3/16".parse().unwrap()),
//!     ..whole.clone()
//! };
//! run(&part, &mut ())?;
//! let merged = Job {
//!     tiles: Tiles::Merged,
//!     ..whole.clone()
//! };
//! // The picture of one frame, and no other file.
//! let picture = Job {
//!     frames: Some(7..=7),
//!     output: Output::Picture("frame.png".into()),
//!     ..whole.clone()
//! };
//! run(&picture, &mut ())?;
//! # Ok(()) }
//! ```

mod open_scene;
mod picture;
mod tiles;
mod part;
mod merged;
mod frames;
mod hierarchies;
mod first_frame;
mod crew;

use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::session::{Event, Options, RenderError, Session};
use crew::Crew;
use frames::FrameRun;
use host::folder::{Replace, refuse_foreign_file, refuse_root};
use host::text::Diagnostic;
use output::estimate::Memory;
use output::summary::Partial;
use render::instruments::{HardwareCounters, NoProfiler, Profiler, Stages};
use render::ranks::{Order, Ranks};
use scene::config::SimdSet;
use tiles::PictureRun;

pub use crate::session::Kept;
pub(crate) use crew::fail_on_a_rank;
pub use frames::SeriesFiles;
pub(crate) use merged::read_parts;
pub(crate) use open_scene::OpenScene;
pub use open_scene::{SceneFile, SceneSource};
pub use part::PartDone;
pub use picture::FinishedPicture;
pub use render::checkpoint::PicturePart;
pub use tiles::OtherTiles;
pub(crate) use tiles::UNFINISHED;
pub use tools::series::Video;

/// Pictures to render, and where their files go.
#[derive(Clone)]
pub struct Job<'a> {
    /// The scene.
    pub scene: &'a dyn SceneSource,
    /// The frames of an animated scene; `None` for all of them.
    pub frames: Option<RangeInclusive<u32>>,
    /// The tiles of each picture.
    pub tiles: Tiles,
    /// Time after which no tile is started; [`Tiles::Missing`] continues.
    pub timeout: Option<Duration>,
    /// How to render. Events go to the observer instead.
    pub options: Options<'static>,
    /// The files to write.
    pub output: Output,
    /// True to flush the files to the disk before they replace older ones.
    pub sync: bool,
    /// True to count cycles, instructions and misses of each stage in hardware.
    pub hardware_counters: bool,
    /// True to sample the running functions, for `profile.svg`; needs the cargo feature `profile`.
    pub profile: bool,
}

/// The tiles that a job renders of each picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Tiles {
    /// All. With a time limit, or for a picture larger than memory, tiles that an interrupted run has
    /// left are refused.
    #[default]
    All,
    /// All that an interrupted run has not finished: finished tiles are kept in the output folder.
    Missing,
    /// One of several parts of about the same work, in a file for [`Self::Merged`]. The processes of
    /// a cluster's job array each render one.
    Part(PicturePart),
    /// None: all come from the files of the parts, in the output folder.
    Merged,
}

/// The files that a job writes.
#[derive(Debug, Clone)]
pub enum Output {
    /// All that the scene requests, into this folder; of an animation, into a folder for each frame.
    Folder(PathBuf),
    /// Only the picture of a still or of one frame: to a file `.png`, or to `.exr` if the scene
    /// requests that output.
    Picture(PathBuf),
}

/// Receives the events of a job.
pub trait Observer: Sync {
    /// Takes the start of the job, before its scene is read; called on no rank but rank 0.
    ///
    /// # Errors
    /// An error ends the job.
    fn begin(&mut self) -> Result<(), RenderError> {
        Ok(())
    }

    /// Takes an event of a picture; called from any thread.
    fn event(&self, _event: Event) {}

    /// Takes a picture, after its files were written.
    ///
    /// # Errors
    /// An error ends the job.
    fn finished(&mut self, _finished: Finished) -> Result<(), RenderError> {
        Ok(())
    }
}

/// Observes nothing.
impl Observer for () {}

/// A picture that a job has finished.
#[derive(Debug)]
pub enum Finished<'a> {
    /// A picture whose files were written.
    Picture(FinishedPicture<'a>),
    /// The only file of a picture.
    OnlyPicture(FinishedPicture<'a>),
    /// A part of a picture.
    Part(PicturePart, PartDone, PathBuf),
    /// A frame in this folder that was complete, and what another run left beside it.
    Kept(PathBuf, OtherTiles),
}

/// The outcome of a job.
#[derive(Debug, Default)]
pub struct Report {
    /// Number of pictures, or of parts of them, that were rendered.
    pub n_rendered: u64,
    /// Number that were complete from an earlier run.
    pub n_kept: u64,
    /// True if the time was over before all tiles were rendered.
    pub is_partial: bool,
    /// True for an animated scene, unless only a picture was to be written.
    pub is_animated: bool,
    /// The files that play an animation.
    pub series: Option<SeriesFiles>,
}

impl<'a> Job<'a> {
    /// Creates the job of a whole scene, whose files go into this folder.
    pub fn new(scene: &'a dyn SceneSource, folder: impl Into<PathBuf>) -> Self {
        Self {
            scene,
            frames: None,
            tiles: Tiles::default(),
            timeout: None,
            options: Options::default(),
            output: Output::Folder(folder.into()),
            sync: false,
            hardware_counters: false,
            profile: false,
        }
    }

    /// Returns the part to render, if not a whole picture.
    fn part(&self) -> Option<PicturePart> {
        match self.tiles {
            Tiles::Part(part) => Some(part),
            _ => None,
        }
    }

    /// Returns the options of a picture whose events go to an observer.
    fn options<'b>(&self, on_event: &'b (dyn Fn(Event) + Sync)) -> Options<'b> {
        Options {
            on_event: Some(on_event),
            ..self.options.clone()
        }
    }

    /// Starts the hardware counters, if requested.
    fn counters(&self) -> HardwareCounters {
        if self.hardware_counters {
            HardwareCounters::start()
        } else {
            HardwareCounters::none()
        }
    }

    /// Starts the profiler, if requested.
    fn profiler(&self) -> Result<Option<Profiler>, RenderError> {
        self.profile.then(start_profiler).transpose()
    }
}

/// Renders the pictures of a job and writes their files. As one of several ranks of MPI, renders the
/// tiles that rank 0 deals, and writes no file if it is another rank.
///
/// # Errors
/// A mistake in the scene; a file that cannot be written; a request to stop.
pub fn run(job: &Job, observer: &mut dyn Observer) -> Result<Report, RenderError> {
    // Processes with parts share no picture: each renders a separate one.
    let ranks = match job.tiles {
        Tiles::All | Tiles::Missing => Ranks::join()?,
        Tiles::Part(_) | Tiles::Merged => None,
    };
    let ranks = match ranks {
        Some(ranks) if ranks.rank() > 0 => return crew::work(job, ranks),
        ranks => ranks,
    };
    // Without a deadline if the system's clock has no such time.
    let deadline = job
        .timeout
        .and_then(|time| Instant::now().checked_add(time));
    observer.begin()?;
    job.options.simd.map(SimdSet::detect).transpose()?;
    match &job.output {
        Output::Folder(folder) => refuse_root(folder)?,
        Output::Picture(file) => refuse_foreign_file(file, Replace::Marked)?,
    }
    let stages = Stages::with_start(job.counters());
    // Meet the other ranks, and read the scene for all of them.
    let crew = ranks.map(|ranks| Crew::meet(job, ranks)).transpose()?;
    let source = job.scene.read()?;
    if let Some(crew) = &crew {
        crew.send_scene(&source);
    }
    let scene = OpenScene::parse(job.scene, source)?;
    // Render the pictures.
    let report = match (&scene.frames, &job.output) {
        (Some(frames), Output::Folder(folder)) => {
            let run = FrameRun {
                job,
                scene: &scene,
                frames,
                out: folder,
                crew: crew.as_ref(),
                deadline,
            };
            run.render(observer)
        }
        _ => still(job, &scene, stages, crew.as_ref(), deadline, observer),
    }?;
    if let Some(crew) = crew {
        crew.leave();
    }
    Ok(report)
}

/// Renders a still, or one frame as a still.
fn still(
    job: &Job,
    scene: &OpenScene,
    stages: Stages,
    crew: Option<&Crew>,
    deadline: Option<Instant>,
    observer: &mut dyn Observer,
) -> Result<Report, RenderError> {
    let frame = job.only_frame(scene)?;
    let profiler = job.profiler()?;
    if let Some(crew) = crew {
        crew.begin(Order::Still(frame));
    }
    let needed = match job.tiles {
        Tiles::Part(_) => Memory::estimate_part,
        _ => Memory::estimate_still,
    };
    let session = Session::new(scene.load(frame, needed)?, stages)?;
    job.check_bands(&session)?;
    let team = crew.map(|crew| crew.gather(job, &session)).transpose()?;
    let picture = PictureRun {
        job,
        session: &session,
        deadline,
        profiler: profiler.as_ref(),
        team: team.as_ref(),
    };
    let finished = match &job.output {
        Output::Folder(folder) => picture.finish(folder, &*observer)?,
        Output::Picture(file) => picture.finish_alone(file, &*observer)?,
    };
    let mut report = Report::default();
    report.count(&finished);
    observer.finished(finished)?;
    Ok(report)
}

impl Report {
    /// Counts a finished picture.
    fn count(&mut self, finished: &Finished) {
        let is_kept = matches!(
            finished,
            Finished::Kept(..) | Finished::Part(_, PartDone::Kept, _)
        );
        self.is_partial |= finished.partial().is_some();
        self.n_kept += u64::from(is_kept);
        self.n_rendered += u64::from(!is_kept && !self.is_partial);
    }
}

impl Finished<'_> {
    /// Returns what is missing of the picture because the time was over.
    pub fn partial(&self) -> Option<Partial> {
        match self {
            Self::Picture(picture) | Self::OnlyPicture(picture) => picture.partial,
            Self::Part(_, PartDone::Partial(partial), _) => Some(*partial),
            Self::Part(..) | Self::Kept(..) => None,
        }
    }
}

impl Job<'_> {
    /// Returns the number of the only frame to render, if one is requested or the scene has frames.
    ///
    /// # Errors
    /// Not exactly one frame of an animation is requested.
    fn only_frame(&self, scene: &OpenScene) -> Result<Option<u32>, Diagnostic> {
        match &self.frames {
            range if scene.frames.is_none() => Ok(range.as_ref().map(|range| *range.start())),
            Some(range) if range.start() == range.end() => Ok(Some(*range.start())),
            _ => Err(
                Diagnostic::new("`--picture` writes one picture, and the scene has frames")
                    .with_help("choose one of them, such as `--frames 7`"),
            ),
        }
    }

    /// Checks that a picture that is larger than memory has no option that needs all of it.
    ///
    /// # Errors
    /// The first such option, as the flag of the command line.
    fn check_bands(&self, session: &Session) -> Result<(), Diagnostic> {
        let flags = [
            ("picture", matches!(self.output, Output::Picture(_))),
            ("format", self.options.vtkhdf),
        ];
        let given = flags.into_iter().find(|(_, is_given)| *is_given);
        match (given, session.bands()) {
            (Some((flag, _)), Some(_)) => {
                let message = format!("`--{flag}` needs a picture that fits into memory");
                let help = "choose a smaller `width` or `height`, or leave the flag out";
                Err(Diagnostic::new(message).with_help(help))
            }
            _ => Ok(()),
        }
    }
}

fn start_profiler() -> Result<Profiler, RenderError> {
    Profiler::start().map_err(|none| match none {
        NoProfiler::NotBuilt => Diagnostic::new("this raycost was built without a profiler")
            .with_help("build one: `cargo run --release --features profile -- render …`")
            .into(),
        NoProfiler::Unknown => Diagnostic::new("only Linux and macOS take profiles")
            .with_help("leave out `--profile`")
            .into(),
        NoProfiler::Refused(why) => RenderError::Machine(
            Diagnostic::new(format!("cannot start the profiler: {why}"))
                .with_help("leave out `--profile`"),
        ),
    })
}
