//! The frames of an animated scene, one after the other, and the files that play them.

use std::ops::RangeInclusive;
use std::path::Path;
use std::time::Instant;

use super::crew::Crew;
use super::hierarchies::{FrameHierarchies, FrameInput};
use super::tiles;
use super::tiles::PictureRun;
use super::{Finished, Job, Observer, OpenScene, Report, Tiles};
use crate::session::{Frames, Kept, RenderError};
use base::stop;
use host::folder::create_within;
use output::estimate::Memory;
use output::results::complete_frame;
use render::checkpoint::PARTS;
use render::instruments::Stages;
use render::ranks::Order;
use tools::series::{FrameSeries, Video, frame_folder, strays};

/// The files that play the complete frames of an animation.
#[derive(Debug)]
pub struct SeriesFiles {
    /// Their names in the output folder.
    pub written: Vec<String>,
    /// Number of frames that are not complete.
    pub n_missing: u32,
    /// The video, once all frames are complete.
    pub video: Option<Video>,
    /// A sentence about folders of other frames.
    pub strays: Option<String>,
    /// The name of a ParaView state.
    pub state: Option<String>,
}

/// A run that renders frames.
pub(super) struct FrameRun<'a> {
    pub(super) job: &'a Job<'a>,
    pub(super) scene: &'a OpenScene<'a>,
    pub(super) frames: &'a Frames,
    /// The folder of the series.
    pub(super) out: &'a Path,
    /// The other ranks, if there are several.
    pub(super) crew: Option<&'a Crew>,
    /// The moment after which no further tile is started.
    pub(super) deadline: Option<Instant>,
}

impl FrameRun<'_> {
    /// Renders the incomplete frames, and writes the files that play all complete ones.
    pub(super) fn render(&self, observer: &mut dyn Observer) -> Result<Report, RenderError> {
        let wanted = self.wanted()?;
        // All frames are checked before the first ray.
        for number in wanted.clone() {
            self.scene.at(number)?;
            stop::check()?;
        }
        FrameSeries::refuse_foreign(self.out)?;
        let mut hierarchies = FrameHierarchies::new(self.scene)?;
        let mut report = Report {
            is_animated: true,
            ..Report::default()
        };
        for number in wanted {
            let folder = frame_folder(number);
            if self.job.tiles == Tiles::Merged && !self.out.join(&folder).join(PARTS).exists() {
                continue;
            }
            let folder = create_within(self.out, &folder)?;
            let frame = self.input(number, &hierarchies)?;
            if complete_frame(&folder, &frame.section).is_some() {
                let left = tiles::remove_left(&folder);
                report.n_kept += 1;
                let kept = Finished::Kept(folder, left);
                observer.finished(kept)?;
                continue;
            }
            let n_complete = report.n_kept + report.n_rendered;
            self.frame(&folder, frame, &mut hierarchies, &mut report, observer)
                .map_err(|error| error.or_kept(|| Some(Kept::Frames(n_complete))))?;
            if report.is_partial {
                break;
            }
        }
        if self.job.part().is_none() {
            report.series = Some(self.write_series(&hierarchies)?);
        }
        Ok(report)
    }

    /// Returns the numbers of the frames to render.
    fn wanted(&self) -> Result<RangeInclusive<u32>, RenderError> {
        let Some(range) = &self.job.frames else {
            return Ok(0..=self.frames.n_frames() - 1);
        };
        self.scene.check_frame(*range.start())?;
        self.scene.check_frame(*range.end())?;
        Ok(range.clone())
    }

    /// Returns a frame whose files have not been read.
    fn input(
        &self,
        number: u32,
        hierarchies: &FrameHierarchies,
    ) -> Result<FrameInput, RenderError> {
        let Job {
            hardware_counters,
            profile,
            ..
        } = self.job;
        let flags = format!("{:?}", (hardware_counters, profile));
        let flags = flags + &hierarchies.flags();
        FrameInput::new(self.scene, self.frames, number, &flags)
    }

    /// Renders a frame, or a part of it, into its folder.
    fn frame(
        &self,
        folder: &Path,
        frame: FrameInput,
        hierarchies: &mut FrameHierarchies,
        report: &mut Report,
        observer: &mut dyn Observer,
    ) -> Result<(), RenderError> {
        let job = self.job;
        if let Some(crew) = self.crew {
            crew.begin(Order::Frame(frame.section.number));
        }
        let stages = Stages::start(job.counters());
        let profiler = job.profiler()?;
        let needed = match job.tiles {
            Tiles::Part(_) => Memory::estimate_part,
            _ => Memory::estimate,
        };
        let frame = hierarchies.open(frame, needed, stages, &job.options)?;
        let session = &frame.session;
        let team = self
            .crew
            .map(|crew| crew.gather(job, session))
            .transpose()?;
        let picture = PictureRun {
            job,
            session,
            deadline: self.deadline,
            profiler: profiler.as_ref(),
            team: team.as_ref(),
        };
        let mut finished = picture.finish(folder, &*observer)?;
        if let Finished::Picture(picture) = &mut finished {
            picture.keeps_hierarchy = frame.keeps_hierarchy;
        }
        hierarchies.take_from(&frame)?;
        report.count(&finished);
        observer.finished(finished)
    }

    /// Writes the files that play all complete frames.
    fn write_series(&self, hierarchies: &FrameHierarchies) -> Result<SeriesFiles, RenderError> {
        let n_frames = self.frames.n_frames();
        let mut series = FrameSeries::new(self.job.scene.name(), n_frames);
        let lock = FrameSeries::lock(self.out)?;
        for number in 0..n_frames {
            let folder = self.out.join(frame_folder(number));
            if !folder.exists() {
                continue;
            }
            let frame = self.input(number, hierarchies)?;
            if let Some(summary) = complete_frame(&folder, &frame.section) {
                series.add(&summary);
            }
            stop::check()?;
        }
        let written = series.write(self.out, self.job.options.vtkhdf)?;
        drop(lock);
        let n_missing = n_frames - series.n_frames();
        let video = match n_missing {
            0 => Some(series.write_video(self.out, self.frames.fps())?),
            _ => None,
        };
        stop::check()?;
        Ok(SeriesFiles {
            written,
            n_missing,
            video,
            strays: strays(self.out, n_frames),
            state: series.state(),
        })
    }
}
