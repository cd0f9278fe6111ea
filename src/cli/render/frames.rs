//! `raycost render` of an animated scene.

use std::ops::RangeInclusive;
use std::path::Path;
use std::time::{Duration, Instant};

use super::hierarchies::{self, FrameHierarchies, FrameInput};
use super::part::{self, PartDone};
use super::picture::FinishedPicture;
use super::picture_run::PictureRun;
use super::ranks::Crew;
use super::tiles;
use super::{RenderArguments, start_profiler};
use crate::cli::hints::FrameHints;
use crate::cli::open_scene::OpenScene;
use crate::cli::{Failure, json, shell_word, shown};
use crate::session::Frames;
use base::numbers::{counted, duration};
use base::stop;
use host::folder::create_within;
use host::text::{self, Diagnostic};
use output::estimate::Memory;
use output::look::Look;
use output::results::complete_frame;
use output::summary::Partial;
use render::checkpoint::{PARTS, PicturePart};
use render::instruments::Stages;
use render::ranks::Order;
use tools::series::{FrameSeries, Video, frame_folder, strays};

/// Renders the incomplete frames, and writes the files that play all complete ones.
pub(super) fn render(
    arguments: &RenderArguments,
    scene: &OpenScene,
    frames: &Frames,
    crew: Option<&Crew>,
    deadline: Option<Instant>,
) -> Result<(), Failure> {
    let start = Instant::now();
    let out = arguments.scene.out();
    let wanted = wanted(arguments, scene, frames)?;
    // All frames are checked before the first ray.
    for number in wanted.clone() {
        scene.at(number)?;
        stop::check()?;
    }
    FrameSeries::refuse_foreign(&out)?;
    let mut job = FrameJob {
        arguments,
        scene,
        frames,
        out: &out,
        crew,
        deadline,
        hierarchies: FrameHierarchies::new(scene)?,
        hints: FrameHints::default(),
    };
    let (mut n_rendered, mut n_kept, mut is_partial) = (0, 0, false);
    for number in wanted {
        if arguments.merges && !out.join(frame_folder(number)).join(PARTS).exists() {
            continue;
        }
        let folder = create_within(&out, &frame_folder(number))?;
        let frame = job.frame(number)?;
        let done = match complete_frame(&folder, &frame.section) {
            Some(_) => {
                let left = tiles::remove_left(&folder);
                if arguments.prints_lines() {
                    text::print(&left)?;
                }
                FrameDone::Kept
            }
            None => job.render(&folder, frame).map_err(|failure| {
                failure.or_kept(|| frames_kept(arguments, n_kept + n_rendered))
            })?,
        };
        if arguments.json {
            json::print_summary(&folder)?;
        }
        match done {
            FrameDone::Kept => n_kept += 1,
            FrameDone::Rendered => n_rendered += 1,
            FrameDone::Partial => {
                is_partial = true;
                break;
            }
        }
    }
    let lines = match arguments.part {
        None => job.finish()?,
        Some(_) => part::next_line(&out),
    };
    if arguments.prints_lines() {
        let kept = match n_kept {
            0 => String::new(),
            n => format!(", {n} complete from an earlier run"),
        };
        let rendered = counted(n_rendered, "frame");
        let took = duration(start.elapsed());
        text::print(&format!(
            "frames  {rendered} rendered in {took}{kept}\n{lines}"
        ))?;
    }
    if is_partial {
        Err(Failure::Partial)
    } else {
        Ok(())
    }
}

/// Returns what a stopped run keeps, and how to continue.
fn frames_kept(arguments: &RenderArguments, n_complete: u64) -> Option<Diagnostic> {
    if arguments.run.quiet {
        return None;
    }
    let n_frames = counted(n_complete, "complete frame");
    let message = format!("stopped: kept {n_frames}");
    let help = "run the same command again: it leaves complete frames as they are";
    Some(Diagnostic::new(message).with_help(help))
}

/// Returns the numbers of the frames that the command line requests.
fn wanted(
    arguments: &RenderArguments,
    scene: &OpenScene,
    frames: &Frames,
) -> Result<RangeInclusive<u32>, Failure> {
    let Some(range) = &arguments.frames else {
        return Ok(0..=frames.n_frames() - 1);
    };
    scene.check_frame(*range.0.start())?;
    scene.check_frame(*range.0.end())?;
    Ok(range.0.clone())
}

/// The outcome of a frame.
enum FrameDone {
    Rendered,
    /// The time was over.
    Partial,
    /// It was already complete.
    Kept,
}

/// The rendered part of a frame.
enum FrameRender {
    Whole {
        /// The times of its stages.
        times: String,
        /// Lines about tiles of other runs.
        of_tiles: String,
        partial: Option<Partial>,
        look: Option<Look>,
    },
    Part(PicturePart, PartDone),
}

impl FrameRender {
    fn of_frame(&self) -> FrameDone {
        match self {
            Self::Part(_, PartDone::Kept) => FrameDone::Kept,
            Self::Whole {
                partial: Some(_), ..
            }
            | Self::Part(_, PartDone::Partial(_)) => FrameDone::Partial,
            Self::Whole { partial: None, .. } | Self::Part(_, PartDone::Rendered(..)) => {
                FrameDone::Rendered
            }
        }
    }
}

/// Renders a whole frame.
fn whole(run: PictureRun) -> Result<FrameRender, Failure> {
    let picture = FinishedPicture::render(run)?;
    let stages = picture.rendering.stages().ended.iter();
    let times = stages.map(|stage| {
        let wall = Duration::from_secs_f64(stage.wall_ms / 1e3);
        format!("{} {}", stage.name, duration(wall))
    });
    let mut times = times.collect::<Vec<_>>().join(", ");
    if let Some(partial) = picture.partial {
        times += &format!("; {partial}");
    }
    Ok(FrameRender::Whole {
        times,
        of_tiles: picture.of_tiles,
        partial: picture.partial,
        look: picture.rendering.look(),
    })
}

/// A run that renders frames.
struct FrameJob<'a> {
    arguments: &'a RenderArguments,
    scene: &'a OpenScene<'a>,
    frames: &'a Frames,
    /// The folder of the series.
    out: &'a Path,
    /// The other ranks, if there are several.
    crew: Option<&'a Crew>,
    /// The moment after which no further tile is started.
    deadline: Option<Instant>,
    /// The acceleration structures.
    hierarchies: FrameHierarchies<'a>,
    hints: FrameHints,
}

impl FrameJob<'_> {
    /// Returns a frame.
    fn frame(&self, number: u32) -> Result<FrameInput, Failure> {
        let RenderArguments {
            measure_overhead,
            hardware_counters,
            profile,
            ..
        } = self.arguments;
        let flags = format!("{:?}", (measure_overhead, hardware_counters, profile));
        let flags = flags + &self.hierarchies.flags();
        FrameInput::new(self.scene, self.frames, number, &flags)
    }

    /// Renders a frame, or a part of it, into its folder.
    fn render(&mut self, folder: &Path, frame: FrameInput) -> Result<FrameDone, Failure> {
        let arguments = self.arguments;
        let (number, n_frames) = (frame.section.number, frame.section.n_frames);
        if let Some(crew) = self.crew {
            crew.begin(Order::Frame(number));
        }
        let stages = Stages::start(arguments.hardware());
        let profiler = arguments.profile.then(start_profiler).transpose()?;
        let needed = match arguments.part {
            Some(_) => Memory::of_part,
            None => Memory::estimate,
        };
        let silent = |_| {};
        let options = arguments.options(&silent);
        let frame = self.hierarchies.open(frame, needed, stages, &options)?;
        let session = &frame.session;
        let team = self.crew.map(|crew| crew.gather(arguments, session));
        let team = team.transpose()?;
        let run = PictureRun {
            arguments,
            session,
            out: folder,
            deadline: self.deadline,
            profiler: profiler.as_ref(),
            team: team.as_ref(),
        };
        let done = match arguments.part {
            Some(part) => FrameRender::Part(part, part::render(run, part)?),
            None => whole(run)?,
        };
        self.hierarchies.take_from(&frame)?;
        if arguments.prints_lines() {
            text::print(&match &done {
                FrameRender::Part(part, done) => done.line(*part, folder),
                FrameRender::Whole {
                    times,
                    of_tiles,
                    look,
                    ..
                } => {
                    let hierarchy = hierarchies::line(session.hierarchy(), frame.keeps_hierarchy);
                    let hints = self.hints.lines(number, session.config(), *look);
                    let hints = text::wrapped(&hints);
                    format!("frame   {number} of {n_frames}: {times}{hierarchy}\n{of_tiles}{hints}")
                }
            })?;
        }
        Ok(done.of_frame())
    }

    /// Writes the files that play all complete frames. Returns the lines about them.
    fn finish(&self) -> Result<String, Failure> {
        let n_frames = self.frames.n_frames();
        let mut series = FrameSeries::new(self.arguments.scene.name(), n_frames);
        let lock = FrameSeries::lock(self.out)?;
        for number in 0..n_frames {
            let folder = self.out.join(frame_folder(number));
            if !folder.exists() {
                continue;
            }
            let frame = self.frame(number)?;
            if let Some(summary) = complete_frame(&folder, &frame.section) {
                series.add(&summary);
            }
            stop::check()?;
        }
        let written = series.write(self.out, self.arguments.run.format.is_some())?;
        drop(lock);
        let out = shown(self.out);
        let mut lines = format!("wrote   {out}: {}\n", written.join(", "));
        if series.n_frames() < n_frames {
            let missing = counted((n_frames - series.n_frames()).into(), "frame");
            lines += &format!("missing {missing}: the series plays the others; no video yet\n");
        } else {
            lines += &self.video(&series)?;
        }
        if let Some(strays) = strays(self.out, n_frames) {
            lines += &format!("note    {strays}\n");
        }
        if let Some(state) = series.state() {
            let state = shell_word(&self.out.join(state));
            lines += &format!("next    paraview --state={state}\n");
        }
        Ok(lines)
    }

    /// Makes the video. Returns the line about it.
    fn video(&self, series: &FrameSeries) -> Result<String, Failure> {
        let video = series.write_video(self.out, self.frames.fps())?;
        stop::check()?;
        Ok(match video {
            Video::Written(name) => format!("video   {}\n", shown(&self.out.join(name))),
            Video::NoFfmpeg(command) => {
                format!("video   ffmpeg is not installed; where it is: {command}\n")
            }
            Video::Failed(why, command) => {
                format!(
                    "video   ffmpeg failed: {}\n        {command}\n",
                    text::one_line(&why)
                )
            }
        })
    }
}
